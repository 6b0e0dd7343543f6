// KTX 2 and DDS against readers written from their specifications.
#include "image/write.h"

#include "core/error.h"
#include "image/output_set.h"

#include <Imath/half.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include <unistd.h>

namespace ibl {
namespace {

using Bytes = std::vector<unsigned char>;

template <class T>
T at(const Bytes& bytes, std::size_t offset) {
    T value;
    EXPECT_LE(offset + sizeof value, bytes.size());
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

/// Texel (x, y) of a face of a level tells which it is.
float valueOf(int level, int face, int x, int y, int channel) {
    return static_cast<float>(level * 100 + face * 10 + y + x * 0.25 + channel * 0.0625);
}

std::vector<Image> chain() {
    std::vector<Image> levels;
    for (int level = 0; level < 3; ++level) {
        const int n = 4 >> level;
        Image image(n, 6 * n);
        for (int y = 0; y < 6 * n; ++y)
            for (int x = 0; x < n; ++x)
                for (int c = 0; c < 3; ++c)
                    image.at(x, y)[c] = valueOf(level, y / n, x, y % n, c);
        levels.push_back(image);
    }
    return levels;
}

Bytes written(const std::string& extension, PixelType type, const std::vector<Image>& levels,
              WriteLosses* losses = nullptr) {
    const std::string path = (std::filesystem::temp_directory_path() /
                              ("ibl_cube_" + std::to_string(::getpid()) + "." + extension))
                                 .string();
    std::vector<const Image*> pointers;
    for (const Image& level : levels)
        pointers.push_back(&level);
    OutputSet outputs;
    WriteOptions options;
    options.type = type;
    const WriteLosses lost = writeCubeMap(outputs, path, pointers, options);
    if (losses) *losses = lost;
    outputs.commit();
    std::ifstream in(path, std::ios::binary);
    const Bytes bytes{std::istreambuf_iterator<char>(in), {}};
    std::filesystem::remove(path);
    return bytes;
}

void expectTexels(const Bytes& bytes, std::size_t offset, PixelType type, int level, int face) {
    const int n = 4 >> level;
    for (int k = 0; k < n * n * 4; ++k) {
        const int c = k % 4, x = k / 4 % n, y = k / 4 / n;
        const float expected = c == 3 ? 1 : valueOf(level, face, x, y, c);
        if (type == PixelType::float32) {
            ASSERT_EQ(at<float>(bytes, offset + 4UL * k), expected);
        } else {
            half h;
            h.setBits(at<std::uint16_t>(bytes, offset + 2UL * k));
            ASSERT_EQ(float(h), float(half(expected)));
        }
    }
}

TEST(CubeContainer, Ktx2) {
    for (PixelType type : {PixelType::half, PixelType::float32}) {
        const bool is_half = type == PixelType::half;
        const std::size_t pixel = is_half ? 8 : 16;
        const Bytes b = written("ktx2", type, chain());
        EXPECT_EQ(std::string(b.begin(), b.begin() + 12), "\xABKTX 20\xBB\r\n\x1A\n");
        const std::uint32_t header[]{is_half ? 97U : 109U, is_half ? 2U : 4U, 4, 4, 0, 0, 6, 3, 0};
        for (std::size_t i = 0; i < 9; ++i)
            EXPECT_EQ(at<std::uint32_t>(b, 12 + 4 * i), header[i]) << i;
        const auto descriptor = at<std::uint32_t>(b, 48);
        EXPECT_EQ(descriptor, 80U + 3 * 24);
        EXPECT_EQ(at<std::uint32_t>(b, 52), 92U);
        EXPECT_EQ(at<std::uint32_t>(b, descriptor), 92U);
        EXPECT_EQ(b[descriptor + 20], pixel); // bytesPlane0
        const auto keys = at<std::uint32_t>(b, 56);
        EXPECT_EQ(keys, descriptor + 92);
        EXPECT_EQ(std::string(b.begin() + keys + 4, b.begin() + keys + 13), "KTXwriter");
        std::uint64_t end = b.size();
        for (int level = 0; level < 3; ++level) { // the largest is the last
            const auto offset = at<std::uint64_t>(b, 80 + 24UL * level);
            const auto size = at<std::uint64_t>(b, 88 + 24UL * level);
            const int n = 4 >> level;
            EXPECT_EQ(size, pixel * 6 * n * n);
            EXPECT_EQ(at<std::uint64_t>(b, 96 + 24UL * level), size);
            EXPECT_EQ(offset % pixel, 0U);
            EXPECT_EQ(offset + size, end);
            end = offset;
            for (int face = 0; face < 6; ++face)
                expectTexels(b, offset + size / 6 * face, type, level, face);
        }
        EXPECT_GE(end, keys + at<std::uint32_t>(b, 60));
    }
}

TEST(CubeContainer, Dds) {
    for (PixelType type : {PixelType::half, PixelType::float32}) {
        const std::size_t pixel = type == PixelType::half ? 8 : 16;
        const Bytes b = written("dds", type, chain());
        EXPECT_EQ(std::string(b.begin(), b.begin() + 4), "DDS ");
        EXPECT_EQ(at<std::uint32_t>(b, 4), 124U);
        EXPECT_EQ(at<std::uint32_t>(b, 12), 4U);
        EXPECT_EQ(at<std::uint32_t>(b, 16), 4U);
        EXPECT_EQ(at<std::uint32_t>(b, 28), 3U); // levels
        EXPECT_EQ(at<std::uint32_t>(b, 76), 32U);
        EXPECT_EQ(std::string(b.begin() + 84, b.begin() + 88), "DX10");
        EXPECT_EQ(at<std::uint32_t>(b, 112), 0xFE00U);
        EXPECT_EQ(at<std::uint32_t>(b, 128), type == PixelType::half ? 10U : 2U);
        EXPECT_EQ(at<std::uint32_t>(b, 132), 3U);
        EXPECT_EQ(at<std::uint32_t>(b, 136), 4U);
        EXPECT_EQ(at<std::uint32_t>(b, 140), 1U);
        std::size_t offset = 148;
        for (int face = 0; face < 6; ++face) {
            for (int level = 0; level < 3; ++level) {
                expectTexels(b, offset, type, level, face);
                offset += pixel * (4 >> level) * (4 >> level);
            }
        }
        EXPECT_EQ(offset, b.size());
    }
}

TEST(CubeContainer, CountsWhatHalfCannotHold) {
    std::vector<Image> levels = chain();
    levels[0].at(1, 2)[0] = 1e6f;
    levels[2].at(0, 5)[1] = -7e4f;
    for (const char* extension : {"ktx2", "dds"}) {
        WriteLosses losses;
        written(extension, PixelType::half, levels, &losses);
        EXPECT_EQ(losses.above, 1U);
        EXPECT_EQ(losses.below, 1U);
        written(extension, PixelType::float32, levels, &losses);
        EXPECT_EQ(losses.above + losses.below, 0U);
    }
}

TEST(CubeContainer, RefusesWhatIsNoCubeMap) {
    OutputSet outputs;
    EXPECT_THROW(writeImage(outputs, "p.dds", Image(4, 4)), Error);
    WriteOptions compressed;
    compressed.compression = "zip";
    const Image image(1, 6);
    const Image* level = &image;
    EXPECT_THROW(writeCubeMap(outputs, "p.ktx2", {&level, 1}, compressed), Error);
    EXPECT_TRUE(isCubeContainer("a/b.KTX2"));
    EXPECT_FALSE(isCubeContainer("a/b.exr"));
    EXPECT_FALSE(isCubeContainer("-"));
}

} // namespace
} // namespace ibl
