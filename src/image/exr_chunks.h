// Pixels of an OpenEXR part by the library's C interface.
#pragma once

#include "image/source.h"

#include <OpenEXR/ImfHeader.h>

#include <cstddef>
#include <string>
#include <vector>

namespace ibl {

/// Where a part's pixels go: channel c of the data window's first pixel to first[place[c]], pixels
/// and rows that many floats apart.
struct ExrPixels {
    std::vector<std::string> channels; ///< full names, not subsampled
    std::vector<std::size_t> place;    ///< of each
    float* first;
    std::size_t pixel_floats;
    std::size_t row_floats;
};

/// Reads all rows of a part whose header is sound (readExrHeaders), chunks on several threads;
/// false where that cannot be done: for tiles, whole numbers, compressions without a decoder in
/// that interface, and for files that are damaged, of which the C++ interface says what is wrong.
/// The C++ one takes floats from ZIP a byte at a time: 1920x1080 in 68 ms on two cores, this in 36,
/// the same values.
bool readExrChunks(const Source& source, const Imf::Header& header, int part,
                   const ExrPixels& pixels, int threads);

} // namespace ibl
