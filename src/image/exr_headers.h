// An OpenEXR file up to its pixels: opened, its headers read and held to be sane.
#pragma once

#include "image/source.h"

#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace ibl {

/// A stream over the source's file or, if it is whole, over its bytes, which have to outlive it.
std::unique_ptr<Imf::IStream> openExrStream(const Source& source);

/// The headers of all parts, read before OpenEXR is given the file, since it takes memory by what
/// they say. (File layout: magic number, version, headers; those of a multi-part file end with an
/// empty one.) Throws inputError for windows and tiles that cannot be, and what OpenEXR throws.
std::vector<Imf::Header> readExrHeaders(Imf::IStream& stream, const std::string& name);

/// Width or height of a window from its corners, which may lie anywhere in the range of int.
inline std::int64_t windowExtent(int low, int high) {
    return std::int64_t{high} - low + 1;
}

} // namespace ibl
