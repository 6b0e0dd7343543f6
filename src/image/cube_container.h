// Cube maps with all their levels in one file: KTX 2 and DDS.
//
// A level is an image of N x 6N pixels, the faces +X -X +Y -Y +Z -Z one under the other; levels are
// given from the largest, each half as wide as the one before. RGB becomes RGBA with an alpha of 1,
// half or float, little-endian; half values beyond 65504 are clamped to it and counted.
#pragma once

#include "image/image.h"
#include "image/output_set.h"
#include "image/write.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace ibl {

/// The Khronos texture format, version 2.0: VK_FORMAT_R16G16B16A16_SFLOAT (97) or R32G32B32A32
/// (109).
WriteLosses writeKtx2(OutputFile& file, std::span<const Image* const> levels, PixelType type);

/// A DirectDraw surface with the header of Direct3D 10: DXGI_FORMAT_R16G16B16A16_FLOAT (10) or
/// R32G32B32A32_FLOAT (2).
WriteLosses writeDds(OutputFile& file, std::span<const Image* const> levels, PixelType type);

/// Appends a number to a header, lowest byte first.
template <class T>
void putLittleEndian(std::vector<std::uint8_t>& bytes, T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i)
        bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

/// Bytes of an RGBA pixel.
inline std::size_t rgbaBytes(PixelType type) {
    return type == PixelType::half ? 8 : 16;
}

/// Writes `rows` rows from `first` as RGBA.
WriteLosses writeRgbaRows(OutputFile& file, const Image& image, int first, int rows,
                          PixelType type);

} // namespace ibl
