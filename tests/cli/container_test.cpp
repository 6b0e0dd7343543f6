// KTX 2 and DDS cube maps from the command line, read by their published specifications and
// compared with the EXR faces of the same command.
#include "cli/tool.h"

#include "image/read.h"

#include <Imath/half.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <cstring>
#include <numeric>

namespace ibl {
namespace {

using Words = std::vector<std::string>;

constexpr const char* kFaces[] = {"px", "nx", "py", "ny", "pz", "nz"};

template <class T>
T at(const std::string& bytes, std::size_t offset) {
    T value{};
    EXPECT_LE(offset + sizeof value, bytes.size());
    if (offset + sizeof value <= bytes.size())
        std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

std::uint32_t word(const std::string& bytes, std::size_t offset) {
    return at<std::uint32_t>(bytes, offset);
}

/// Where each face of each level begins: [level][face].
using Places = std::vector<std::vector<std::size_t>>;

/// KTX 2.0, sections 3 and 4.
Places readKtx2(const std::string& bytes, std::uint32_t size, std::uint32_t levels, bool half) {
    EXPECT_EQ(bytes.substr(0, 12), std::string("\xABKTX 20\xBB\r\n\x1A\n"));
    const std::uint32_t expected[] = {
        half ? 97U : 109U, half ? 2U : 4U, size, size, 0, 0, 6, levels, 0};
    for (std::size_t i = 0; i < std::size(expected); ++i)
        EXPECT_EQ(word(bytes, 12 + 4 * i), expected[i]) << "header word " << i;
    const std::size_t descriptor = word(bytes, 48), keys = word(bytes, 56);
    EXPECT_EQ(descriptor, 80 + 24 * levels);
    EXPECT_EQ(word(bytes, 52), 92u); // 4, 24 and four samples of 16
    EXPECT_EQ(word(bytes, descriptor), 92u);
    EXPECT_EQ(keys % 4, 0u);
    const std::uint32_t pixel = half ? 8 : 16;
    std::size_t end = keys + word(bytes, 60);
    Places places(levels);
    for (std::uint32_t k = levels; k-- > 0;) {
        const auto begin = at<std::uint64_t>(bytes, 80 + 24 * k);
        const auto length = at<std::uint64_t>(bytes, 88 + 24 * k);
        const std::size_t face_bytes = std::size_t{size >> k} * (size >> k) * pixel;
        EXPECT_EQ(length, 6 * face_bytes);
        EXPECT_EQ(at<std::uint64_t>(bytes, 96 + 24 * k), length);
        EXPECT_EQ(begin % std::lcm(pixel, 4U), 0u);
        EXPECT_GE(begin, end);
        EXPECT_LT(begin - end, pixel);
        end = begin + length;
        for (std::size_t face = 0; face < 6; ++face)
            places[k].push_back(begin + face * face_bytes);
    }
    EXPECT_EQ(end, bytes.size());
    return places;
}

/// DDS_HEADER and DDS_HEADER_DXT10 of Microsoft's programming guide.
Places readDds(const std::string& bytes, std::uint32_t size, std::uint32_t levels, bool half) {
    EXPECT_EQ(bytes.substr(0, 4), "DDS ");
    EXPECT_EQ(word(bytes, 4), 124u);
    EXPECT_EQ(word(bytes, 8) & 0x21007u, 0x21007u); // caps, height, width, format, levels
    EXPECT_EQ(word(bytes, 12), size);
    EXPECT_EQ(word(bytes, 16), size);
    EXPECT_EQ(word(bytes, 28), levels);
    EXPECT_EQ(word(bytes, 76), 32u);
    EXPECT_EQ(word(bytes, 80), 4u);
    EXPECT_EQ(bytes.substr(84, 4), "DX10");
    EXPECT_EQ(word(bytes, 108) & 0x1008u, 0x1008u); // texture, complex
    EXPECT_EQ(word(bytes, 112), 0xFE00u);           // cube map with all faces
    EXPECT_EQ(word(bytes, 128), half ? 10u : 2u);
    EXPECT_EQ(word(bytes, 132), 3u); // two-dimensional
    EXPECT_EQ(word(bytes, 136), 4u); // cube
    EXPECT_EQ(word(bytes, 140), 1u);
    Places places(levels, std::vector<std::size_t>(6));
    std::size_t end = 148;
    for (std::size_t face = 0; face < 6; ++face) {
        for (std::uint32_t k = 0; k < levels; ++k) {
            places[k][face] = end;
            end += std::size_t{size >> k} * (size >> k) * (half ? 8 : 16);
        }
    }
    EXPECT_EQ(end, bytes.size());
    return places;
}

void expectFace(const std::string& bytes, std::size_t begin, const Image& face, bool is_half) {
    for (int y = 0; y < face.height; ++y) {
        for (int x = 0; x < face.width; ++x) {
            for (int c = 0; c < 4; ++c, begin += is_half ? 2 : 4) {
                float value = at<float>(bytes, is_half ? 0 : begin);
                if (is_half) {
                    half h;
                    h.setBits(at<std::uint16_t>(bytes, begin));
                    value = h;
                }
                ASSERT_EQ(value, c < 3 ? face.at(x, y)[c] : 1) << x << ' ' << y << ' ' << c;
            }
        }
    }
}

/// A command's containers hold what it writes as EXR faces.
void expectSameAsFaces(Words command, std::uint32_t levels, bool chain) {
    for (const bool half : {false, true}) {
        const Scratch scratch;
        const auto run = [&](const std::string& output) {
            Words words = command;
            words.insert(words.end(),
                         {"--size", "8", "--type", half ? "half" : "float", "-o", output});
            const ToolResult result = runTool(words, scratch.path());
            ASSERT_EQ(result.exit_code, 0) << result.err;
        };
        for (const char* name : {"f.exr", "c.ktx2", "c.dds"})
            run(name);
        const std::string ktx = readFile(scratch / "c.ktx2"), dds = readFile(scratch / "c.dds");
        const Places in_ktx = readKtx2(ktx, 8, levels, half);
        const Places in_dds = readDds(dds, 8, levels, half);
        EXPECT_EQ(scratch.names().size(), 2 + 6 * levels);
        for (std::uint32_t k = 0; k < levels; ++k) {
            for (std::size_t face = 0; face < 6; ++face) {
                const std::string name = (chain ? "f_m" + std::to_string(k) : std::string("f")) +
                                         "_" + kFaces[face] + ".exr";
                SCOPED_TRACE(name);
                const Image image = readImage((scratch / name).string()).image;
                ASSERT_EQ(image.width, static_cast<int>(8 >> k));
                expectFace(ktx, in_ktx[k][face], image, half);
                expectFace(dds, in_dds[k][face], image, half);
            }
        }
    }
}

TEST(Container, HoldsTheFacesOfConvertDiffuseAndSpecular) {
    expectSameAsFaces({"convert", "builtin:compass"}, 1, false);
    expectSameAsFaces({"diffuse", "builtin:compass"}, 1, false);
    expectSameAsFaces({"specular", "builtin:compass", "--levels", "4"}, 4, true);
}

TEST(Container, StandardOutputThreadsReportAndDepfile) {
    const Scratch scratch;
    for (const std::string format : {"ktx2", "dds"}) {
        const Words base{"specular", "builtin:compass", "--levels", "3", "--size", "8"};
        const auto run = [&](const Words& more) {
            Words words = base;
            words.insert(words.end(), more.begin(), more.end());
            const ToolResult result = runTool(words, scratch.path());
            EXPECT_EQ(result.exit_code, 0) << result.err;
            return result.out;
        };
        run({"--threads", "1", "-o", "a." + format, "--report", "r", "--depfile", "d"});
        run({"--threads", "3", "-o", "b." + format});
        const std::string bytes = readFile(scratch / ("a." + format));
        EXPECT_TRUE(bytes == readFile(scratch / ("b." + format)));
        EXPECT_TRUE(bytes == run({"-o", "-", "--format", format}));
        EXPECT_EQ(readFile(scratch / "d"), "a." + format + ":\n");
        EXPECT_EQ(nlohmann::json::parse(readFile(scratch / "r")).at("outputs"),
                  nlohmann::json({"a." + format}));
    }
}

TEST(Container, RefusesWhatItCannotHold) {
    const Scratch scratch;
    for (const std::string format : {"ktx2", "dds"}) {
        for (const char* command : {"convert", "diffuse", "specular"}) {
            const auto refused = [&](Words more, const std::string& said) {
                more.insert(more.begin(),
                            {command, "builtin:compass", "--size", "8", "-o", "x." + format});
                if (more.front() == "specular") more.insert(more.end(), {"--levels", "2"});
                expectRefused(runTool(more, scratch.path()), 1, said);
            };
            refused({"--to", "latlong"}, "hold faces, not latlong");
            refused({"--compression", "zip"}, "compression");
        }
    }
    EXPECT_TRUE(scratch.names().empty());
}

TEST(Container, IsWrittenButNotRead) {
    const Scratch scratch;
    for (const std::string name : {"x.ktx2", "x.dds"}) {
        const Words write{"convert", "builtin:compass", "--size", "4", "-o", name};
        ASSERT_EQ(runTool(write, scratch.path()).exit_code, 0);
        for (const Words& words : {Words{"info", name}, Words{"convert", name, "-o", "y.exr"},
                                   Words{"tonemap", name, "-o", "y.png"}}) {
            expectRefused(runTool(words, scratch.path()), 2,
                          name == "x.dds" ? "x.dds: is a DDS container, which is written but not"
                                          : "x.ktx2: is a KTX container, which is written but not");
        }
    }
}

} // namespace
} // namespace ibl
