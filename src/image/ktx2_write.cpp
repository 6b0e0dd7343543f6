#include "image/cube_container.h"

#include <array>
#include <string_view>

namespace ibl {
namespace {

constexpr std::array<std::uint8_t, 12> kIdentifier{0xAB, 'K',  'T',  'X',  ' ',  '2',
                                                   '0',  0xBB, '\r', '\n', 0x1A, '\n'};
constexpr std::uint32_t kHeaderBytes = 80;
constexpr std::uint32_t kLevelIndexBytes = 24;

/// The basic data format descriptor of RGBA floats (Khronos Data Format Specification 1.3, section
/// 5), with its total size in front. A sample's bounds are floats, -1 and 1 for signed ones.
std::vector<std::uint8_t> formatDescriptor(PixelType type) {
    constexpr std::uint32_t kBlockBytes = 24 + 4 * 16, kVersion = 2;
    constexpr std::uint32_t kRgbsda = 1, kBt709 = 1, kLinear = 1;
    constexpr std::array<std::uint32_t, 4> kChannels{0, 1, 2, 15}; // R G B A
    constexpr std::uint32_t kSignedFloat = 0xC0;
    const std::uint32_t bits = type == PixelType::half ? 16 : 32;
    std::vector<std::uint8_t> bytes;
    const auto put = [&](std::uint32_t word) { putLittleEndian(bytes, word); };
    put(4 + kBlockBytes);
    put(0); // vendor Khronos, basic format
    put(kVersion | kBlockBytes << 16);
    put(kRgbsda | kBt709 << 8 | kLinear << 16);
    put(0); // texel blocks of 1 x 1 x 1 x 1
    put(4 * bits / 8);
    put(0);
    for (std::uint32_t i = 0; i < 4; ++i) {
        put(i * bits | (bits - 1) << 16 | (kChannels[i] | kSignedFloat) << 24);
        put(0);          // position
        put(0xBF800000); // -1
        put(0x3F800000); // 1
    }
    return bytes;
}

/// Who wrote the file; no date.
std::vector<std::uint8_t> keysAndValues() {
    constexpr std::string_view kEntry("KTXwriter\0ibltool\0", 18);
    std::vector<std::uint8_t> bytes;
    putLittleEndian(bytes, static_cast<std::uint32_t>(kEntry.size()));
    bytes.insert(bytes.end(), kEntry.begin(), kEntry.end());
    bytes.resize((bytes.size() + 3) / 4 * 4, 0);
    return bytes;
}

} // namespace

WriteLosses writeKtx2(OutputFile& file, std::span<const Image* const> levels, PixelType type) {
    const std::vector<std::uint8_t> descriptor = formatDescriptor(type), keys = keysAndValues();
    const auto count = static_cast<std::uint32_t>(levels.size());
    const auto width = static_cast<std::uint32_t>(levels.front()->width);
    const std::uint32_t descriptor_at = kHeaderBytes + kLevelIndexBytes * count;
    const auto descriptor_bytes = static_cast<std::uint32_t>(descriptor.size());
    const std::uint32_t keys_at = descriptor_at + descriptor_bytes;

    std::vector<std::uint8_t> header(kIdentifier.begin(), kIdentifier.end());
    const std::uint32_t format = type == PixelType::half ? 97 : 109;
    const std::uint32_t type_bytes = type == PixelType::half ? 2 : 4;
    for (std::uint32_t word :
         {format, type_bytes, width, width, 0U, 0U, 6U, count, 0U, descriptor_at, descriptor_bytes,
          keys_at, static_cast<std::uint32_t>(keys.size())}) {
        putLittleEndian(header, word);
    }
    for (int i = 0; i < 2; ++i) // no supercompression data
        putLittleEndian(header, std::uint64_t{0});

    // Levels lie from the smallest to the largest, each at a multiple of a pixel's bytes; the index
    // begins with the largest.
    const std::uint64_t pixel = rgbaBytes(type);
    std::vector<std::uint64_t> offsets(count), sizes(count);
    std::uint64_t at = (keys_at + keys.size() + pixel - 1) / pixel * pixel;
    const std::uint64_t padding = at - keys_at - keys.size();
    for (std::size_t k = count; k-- > 0;) {
        offsets[k] = at;
        sizes[k] = pixel * static_cast<std::uint64_t>(levels[k]->width) *
                   static_cast<std::uint64_t>(levels[k]->height);
        at += sizes[k];
    }
    for (std::size_t k = 0; k < count; ++k) {
        for (std::uint64_t word : {offsets[k], sizes[k], sizes[k]})
            putLittleEndian(header, word);
    }
    header.insert(header.end(), descriptor.begin(), descriptor.end());
    header.insert(header.end(), keys.begin(), keys.end());
    header.insert(header.end(), padding, 0);
    file.write(header.data(), header.size());
    WriteLosses losses;
    for (std::size_t k = count; k-- > 0;)
        losses += writeRgbaRows(file, *levels[k], 0, levels[k]->height, type);
    return losses;
}

} // namespace ibl
