#include "image/cube_container.h"

#include <Imath/half.h>

#include <algorithm>
#include <bit>

namespace ibl {

WriteLosses writeRgbaRows(OutputFile& file, const Image& image, int first, int rows,
                          PixelType type) {
    constexpr float kLargestHalf = 65504;
    WriteLosses losses;
    std::vector<std::uint8_t> bytes;
    for (int y = first; y < first + rows; ++y) {
        bytes.clear();
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < 4; ++c) {
                const float value = c < 3 ? image.at(x, y)[c] : 1;
                if (type == PixelType::half) {
                    losses.above += value > kLargestHalf;
                    losses.below += value < -kLargestHalf;
                    const half h(std::clamp(value, -kLargestHalf, kLargestHalf));
                    putLittleEndian(bytes, h.bits());
                } else {
                    putLittleEndian(bytes, std::bit_cast<std::uint32_t>(value));
                }
            }
        }
        file.write(bytes.data(), bytes.size());
    }
    return losses;
}

WriteLosses writeDds(OutputFile& file, std::span<const Image* const> levels, PixelType type) {
    const auto width = static_cast<std::uint32_t>(levels.front()->width);
    const auto count = static_cast<std::uint32_t>(levels.size());
    constexpr std::uint32_t kHeaderBytes = 124, kPixelFormatBytes = 32;
    // Caps, height, width, pixel format, levels; pitch.
    constexpr std::uint32_t kFlags = 0x1 | 0x2 | 0x4 | 0x1000 | 0x20000 | 0x8;
    constexpr std::uint32_t kFourCc = 0x4, kDx10 = 0x30315844; // "DX10"
    constexpr std::uint32_t kCaps = 0x1000 | 0x8 | 0x400000;   // texture, complex, levels
    constexpr std::uint32_t kSixFaces = 0x200 | 0xFC00;
    constexpr std::uint32_t kTexture2D = 3, kTextureCube = 4;
    const std::uint32_t pitch = width * static_cast<std::uint32_t>(rgbaBytes(type));
    std::vector<std::uint8_t> header{'D', 'D', 'S', ' '};
    const auto put = [&](std::initializer_list<std::uint32_t> words) {
        for (std::uint32_t word : words)
            putLittleEndian(header, word);
    };
    put({kHeaderBytes, kFlags, width, width, pitch, 0, count});
    for (int i = 0; i < 11; ++i)
        put({0});
    put({kPixelFormatBytes, kFourCc, kDx10, 0, 0, 0, 0, 0});
    put({kCaps, kSixFaces, 0, 0, 0});
    put({type == PixelType::half ? 10U : 2U, kTexture2D, kTextureCube, 1, 0});
    file.write(header.data(), header.size());
    WriteLosses losses;
    for (int face = 0; face < 6; ++face) {
        for (const Image* level : levels)
            losses += writeRgbaRows(file, *level, face * level->width, level->width, type);
    }
    return losses;
}

} // namespace ibl
