// The bytes of an input, before anybody knows its format.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ibl {

/// Largest edge and area of an image that is read. An image of this area is 12 GiB of RGB floats;
/// the limits keep a hostile header from asking for more.
constexpr std::int64_t kMaxImageEdge = 65536;
constexpr std::int64_t kMaxImagePixels = std::int64_t{1} << 30;

struct Source {
    std::string name; ///< for messages
    std::string path; ///< if it is a regular file, from which a library may read on demand
    std::vector<std::uint8_t> bytes; ///< its first bytes, or all of it (`whole`)
    bool whole = false;
};

/// Opens a file ("-": standard input). Regular files are read as far as their format needs to be
/// told, streams to their end. Throws inputError: not there, a folder, empty.
Source openSource(const std::string& path);

/// Reads the rest; afterwards `bytes` is the whole file.
void readWhole(Source& source);

/// Throws inputError unless 1 <= width, height <= kMaxImageEdge and the area is within
/// kMaxImagePixels.
void checkSize(const std::string& name, std::int64_t width, std::int64_t height);

} // namespace ibl
