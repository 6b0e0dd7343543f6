// What the tests of render share.
#pragma once

#include "cli/tool.h"
#include "image/read.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace ibl {

using Words = std::vector<std::string>;

/// The picture that `ibltool render WORDS -o OUT` makes, with alpha if it has some.
inline Image render(const Scratch& scratch, Words words, const std::string& out = "o.exr") {
    return pictureOf(scratch, "render", std::move(words), out);
}

} // namespace ibl
