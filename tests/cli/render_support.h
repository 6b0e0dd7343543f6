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
    words.insert(words.begin(), "render");
    words.insert(words.end(), {"-o", out});
    const ToolResult result = runTool(words, scratch.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    ReadOptions options;
    options.keep_alpha = true;
    return readImage((scratch / out).string(), options).image;
}

} // namespace ibl
