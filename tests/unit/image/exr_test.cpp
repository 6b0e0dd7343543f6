#include "image_files.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfRgbaFile.h>
#include <OpenEXR/ImfStandardAttributes.h>

#include <Imath/half.h>

#include <cstring>

#include <unistd.h>

namespace ibl::test {
namespace {

class Exr : public ImageFiles {
protected:
    /// Writes one constant channel of any type and sampling beside R, G and B of 1, 2 and 3.
    void writeWith(const std::string& channel, Imf::PixelType type, int sampling) {
        Imf::Header header(8, 8);
        for (const char* name : {"R", "G", "B"})
            header.channels().insert(name, Imf::Channel(type));
        header.channels().insert(channel, Imf::Channel(type, sampling, sampling));
        std::vector<std::uint32_t> zeros(64, 0);
        Imf::FrameBuffer buffer;
        for (auto c = header.channels().begin(); c != header.channels().end(); ++c) {
            const int s = c.channel().xSampling;
            buffer.insert(c.name(),
                          Imf::Slice(type, reinterpret_cast<char*>(zeros.data()), 4,
                                     std::size_t{32} / static_cast<std::size_t>(s), s, s));
        }
        Imf::OutputFile file(path("a.exr").c_str(), header);
        file.setFrameBuffer(buffer);
        file.writePixels(8);
    }
    /// Writes smooth colour through OpenEXR's RGBA interface.
    void writeRgba(Imf::RgbaChannels channels, Imf::Header header) {
        const Imath::Box2i window = header.dataWindow();
        const int width = window.max.x - window.min.x + 1;
        std::vector<Imf::Rgba> pixels;
        for (int y = window.min.y; y <= window.max.y; ++y) {
            for (int x = window.min.x; x <= window.max.x; ++x) {
                pixels.emplace_back(smooth(x), smooth(x) * 0.5F, smooth(y), 1.0F);
            }
        }
        Imf::RgbaOutputFile file(path("a.exr").c_str(), header, channels);
        file.setFrameBuffer(pixels.data() - window.min.x - std::ptrdiff_t{window.min.y} * width, 1,
                            static_cast<std::size_t>(width));
        file.writePixels(window.max.y - window.min.y + 1);
    }
    static float smooth(int i) { return 1.0F + 0.01F * static_cast<float>(i); }
};

TEST_F(Exr, FloatsRoundTripBitForBit) {
    for (const std::string compression : {"", "none", "rle", "zips", "zip", "piz"}) {
        for (const int channels : {3, 4}) {
            Image image = testPixels(67, 61, channels);
            image.at(3, 3)[0] = INFINITY;
            image.at(4, 4)[1] = -1e30F;
            WriteOptions options;
            options.compression = compression;
            writeOne(path("a.exr"), image, options);
            const ImageFile file = readImage(path("a.exr"), {"", true});
            ASSERT_EQ(file.image.channels, channels);
            EXPECT_EQ(file.image.pixels, image.pixels) << compression;
            EXPECT_EQ(file.compression, compression.empty() ? "zip" : compression);
            EXPECT_EQ(file.pixel_type, "float");
            EXPECT_EQ(file.format, "exr");
        }
    }
}

TEST_F(Exr, HalvesRoundTripBitForBit) {
    Image image = testPixels(300, 300); // more rows than are converted at once
    for (float& v : image.pixels)
        v = static_cast<float>(half(v));
    for (const std::string compression : {"zip", "zips", "piz", "pxr24", "none", "rle"}) {
        WriteOptions options;
        options.type = PixelType::half;
        options.compression = compression;
        writeOne(path("a.exr"), image, options);
        const ImageFile file = readImage(path("a.exr"));
        EXPECT_EQ(file.image.pixels, image.pixels) << compression;
        EXPECT_EQ(file.pixel_type, "half");
    }
}

/// Chunks are read by OpenEXR's C interface, which has routines of its own for three and four
/// channels, halves and floats.
TEST_F(Exr, ChannelsOfAllNumbersAndTypesAreReadExactly) {
    constexpr int kWidth = 37, kHeight = 53;
    const auto value = [](int c, int x, int y) { // a half, different everywhere
        return static_cast<float>(half(0.25F + static_cast<float>(c * 2000 + y * kWidth + x)));
    };
    for (const std::string names : {"RGB", "RGBA", "Y", "YA", "RGBZ", "RGBAZ"}) {
        for (const auto& [type, alpha_type] :
             {std::pair{Imf::HALF, Imf::HALF}, {Imf::FLOAT, Imf::FLOAT}, {Imf::HALF, Imf::FLOAT}}) {
            for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::ZIP_COMPRESSION}) {
                Imf::Header header(kWidth, kHeight);
                header.compression() = compression;
                Imf::FrameBuffer buffer;
                std::vector<std::vector<char>> planes;
                for (std::size_t c = 0; c < names.size(); ++c) {
                    const Imf::PixelType t = names[c] == 'A' ? alpha_type : type;
                    const std::size_t size = t == Imf::HALF ? 2 : 4;
                    std::vector<char>& plane = planes.emplace_back(kWidth * kHeight * size);
                    for (int i = 0; i < kWidth * kHeight; ++i) {
                        const float v = value(static_cast<int>(c), i % kWidth, i / kWidth);
                        const half h(v);
                        std::memcpy(plane.data() + static_cast<std::size_t>(i) * size,
                                    t == Imf::HALF ? static_cast<const void*>(&h) : &v, size);
                    }
                    const std::string name(1, names[c]);
                    header.channels().insert(name, Imf::Channel(t));
                    buffer.insert(name, Imf::Slice(t, plane.data(), size, kWidth * size));
                }
                {
                    Imf::OutputFile file(path("a.exr").c_str(), header);
                    file.setFrameBuffer(buffer);
                    file.writePixels(kHeight);
                }
                for (const bool keep_alpha : {false, true}) {
                    const Image image = readImage(path("a.exr"), {"", keep_alpha}).image;
                    const std::size_t alpha = names.find('A');
                    ASSERT_EQ(image.channels, keep_alpha && alpha != names.npos ? 4 : 3);
                    int wrong = 0;
                    for (int y = 0; y < kHeight; ++y) {
                        for (int x = 0; x < kWidth; ++x) {
                            const float* p = image.at(x, y);
                            for (int c = 0; c < 3; ++c)
                                wrong += p[c] != value(names[0] == 'Y' ? 0 : c, x, y);
                            if (image.channels == 4)
                                wrong += p[3] != value(static_cast<int>(alpha), x, y);
                        }
                    }
                    EXPECT_EQ(wrong, 0) << names << " " << type << " " << alpha_type << " "
                                        << compression << " " << keep_alpha;
                }
            }
        }
    }
}

TEST_F(Exr, LossyCompressionsComeNear) {
    Image image(64, 64, 3);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            for (int c = 0; c < 3; ++c) {
                image.at(x, y)[c] = 1 + 0.5F * std::sin(0.1F * static_cast<float>(x + c * y));
            }
        }
    }
    for (const std::string compression : {"b44", "b44a", "dwaa", "dwab", "pxr24"}) {
        for (const PixelType type : {PixelType::half, PixelType::float32}) {
            WriteOptions options;
            options.type = type;
            options.compression = compression;
            writeOne(path("a.exr"), image, options);
            const ImageFile file = readImage(path("a.exr"));
            expectNear(file.image, image, 0.02F);
            EXPECT_EQ(file.compression, compression);
        }
    }
}

TEST_F(Exr, HalfClampsAndCounts) {
    Image image = testPixels(4, 4);
    image.at(0, 0)[0] = 1e9F;
    image.at(1, 0)[1] = INFINITY;
    image.at(2, 0)[2] = -7e4F;
    image.at(3, 0)[0] = 65504;
    WriteOptions options;
    options.type = PixelType::half;
    OutputSet outputs;
    const WriteLosses losses = writeImage(outputs, path("a.exr"), image, options);
    outputs.commit();
    EXPECT_EQ(losses.above, 2U);
    EXPECT_EQ(losses.below, 1U);
    const Image back = readImage(path("a.exr")).image;
    EXPECT_EQ(back.at(0, 0)[0], 65504);
    EXPECT_EQ(back.at(1, 0)[1], 65504);
    EXPECT_EQ(back.at(2, 0)[2], -65504);
    EXPECT_EQ(back.at(3, 0)[0], 65504);
    EXPECT_TRUE(anyContains(describeLosses(losses, "a.exr", options), "2 values above 65504"));
}

TEST_F(Exr, SameBytesForAnyThreadsAndAnOutsideReaderAgrees) {
    const Image image = testPixels(200, 300);
    WriteOptions one, many;
    one.threads = 1;
    many.threads = 5;
    writeOne(path("one.exr"), image, one);
    writeOne(path("many.exr"), image, many);
    EXPECT_EQ(readBytes(path("one.exr")), readBytes(path("many.exr")));
    run("oiiotool " + path("one.exr") + " -d float -o " + path("out.tif"));
    EXPECT_EQ(readImage(path("out.tif")).image.pixels, image.pixels);
}

TEST_F(Exr, EnvmapAttribute) {
    for (const std::string envmap : {"latlong", "cube", ""}) {
        WriteOptions options;
        options.envmap = envmap;
        writeOne(path("a.exr"), testPixels(4, 24), options);
        EXPECT_EQ(readImage(path("a.exr")).envmap, envmap);
        const std::string header = run("exrheader " + path("a.exr"));
        EXPECT_EQ(contains(header, "envmap (type envmap)"), !envmap.empty());
        EXPECT_FALSE(contains(header, "Date")) << header;
    }
}

TEST_F(Exr, RefusesOptionsThatAreNone) {
    const auto refused = [&](ExitCode code, const char* name, const char* compression,
                             const char* envmap) {
        WriteOptions options;
        options.compression = compression;
        options.envmap = envmap;
        errorOf(code, [&] { writeOne(path(name), testPixels(2, 2), options); });
    };
    refused(ExitCode::output, "a.exr", "lzma", "");
    refused(ExitCode::output, "a.exr", "", "sphere");
    refused(ExitCode::usage, "a.hdr", "zip", "");
    refused(ExitCode::usage, "a.png", "", "cube");
    EXPECT_TRUE(names().empty());
}

TEST_F(Exr, ReadsOtherPeoplesScanlinesAndTiles) {
    for (const char* name : {"gradient.exr", "tiled_mip.exr", "tiled_rip.exr"}) {
        expectNear(readImage(testdata(name)).image, gradientPixels(), 1e-6F);
    }
    expectNear(readImage(testdata("gradient_half_piz.exr")).image, gradientPixels(), 0.0005F);
}

TEST_F(Exr, DecreasingLineOrder) {
    Imf::Header header(20, 40);
    header.lineOrder() = Imf::DECREASING_Y;
    const int width = 20;
    std::vector<Imf::Rgba> pixels;
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < width; ++x)
            pixels.emplace_back(smooth(x), smooth(y), 0.0F, 1.0F);
    }
    {
        Imf::RgbaOutputFile file(path("a.exr").c_str(), header, Imf::WRITE_RGB);
        file.setFrameBuffer(pixels.data(), 1, width);
        file.writePixels(40);
    }
    const Image image = readImage(path("a.exr")).image;
    EXPECT_EQ(image.at(5, 7)[0], static_cast<float>(half(smooth(5))));
    EXPECT_EQ(image.at(5, 7)[1], static_cast<float>(half(smooth(7))));
}

TEST_F(Exr, UintChannelsBecomeFloats) {
    writeWith("Z", Imf::UINT, 1);
    const ImageFile file = readImage(path("a.exr"));
    EXPECT_EQ(file.pixel_type, "uint");
    EXPECT_EQ(file.image.at(7, 7)[2], 0);
}

TEST_F(Exr, SubsampledColoursAreRefusedOtherChannelsIgnored) {
    writeWith("Z", Imf::HALF, 2);
    EXPECT_EQ(readImage(path("a.exr")).image.width, 8);
    Imf::Header header(8, 8);
    for (const char* name : {"R", "G", "B"}) {
        header.channels().insert(name, Imf::Channel(Imf::HALF, 2, 2));
    }
    { Imf::OutputFile file(path("b.exr").c_str(), header); }
    EXPECT_TRUE(
        contains(errorOf(ExitCode::input, [&] { readImage(path("b.exr")); }), "subsampled"));
}

TEST_F(Exr, DataWindows) {
    const Image gradient = gradientPixels();
    const ImageFile inside = readImage(testdata("window_inside.exr"));
    ASSERT_EQ(inside.image.width, 32);
    ASSERT_EQ(inside.image.height, 16);
    EXPECT_TRUE(anyContains(inside.notes, "data window (4, 3) to (23, 12)"));
    for (int y = 0; y < 16; ++y) {
        for (int x = 0; x < 32; ++x) {
            const bool has = x >= 4 && x < 24 && y >= 3 && y < 13;
            EXPECT_NEAR(inside.image.at(x, y)[1], has ? gradient.at(x, y)[1] : 0, 1e-6F);
        }
    }
    const ImageFile outside = readImage(testdata("window_outside.exr"));
    ASSERT_EQ(outside.image.width, 16);
    ASSERT_EQ(outside.image.height, 8);
    for (int y = 0; y < 8; ++y) {
        for (int x = 0; x < 16; ++x) {
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(outside.image.at(x, y)[c], gradient.at(x + 8, y + 4)[c], 1e-6F);
            }
        }
    }
    for (const float v : readImage(testdata("window_apart.exr")).image.pixels)
        EXPECT_EQ(v, 0);
}

TEST_F(Exr, DataWindowsAtNegativePlacesAndOverlappingTheEdge) {
    Imf::Header header(Imath::Box2i({-10, -20}, {29, 59}), Imath::Box2i({-30, -5}, {4, 400}));
    writeRgba(Imf::WRITE_RGB, header);
    const Image image = readImage(path("a.exr")).image;
    ASSERT_EQ(image.width, 40);
    ASSERT_EQ(image.height, 80);
    for (int y = -20; y < 60; ++y) {
        for (int x = -10; x < 30; ++x) {
            const float expected = y >= -5 && x <= 4 ? float(half(smooth(x))) : 0;
            ASSERT_EQ(image.at(x + 10, y + 20)[0], expected) << x << " " << y;
        }
    }
}

TEST_F(Exr, VastWindowsAreRefusedBeforeMemoryIsTaken) {
    const auto refused = [&](const Imath::Box2i& display, const Imath::Box2i& data) {
        Imf::Header header(display, data);
        for (const char* name : {"R", "G", "B"}) {
            header.channels().insert(name, Imf::Channel(Imf::HALF));
        }
        header.compression() = Imf::DWAB_COMPRESSION;
        { Imf::OutputFile file(path("a.exr").c_str(), header); }
        return errorOf(ExitCode::input, [&] { readImage(path("a.exr")); });
    };
    const Imath::Box2i small({0, 0}, {7, 7});
    EXPECT_TRUE(contains(refused(small, {{0, 0}, {7, 9999999}}), "more than"));
    EXPECT_TRUE(contains(refused({{0, 0}, {70000, 7}}, small), "more than"));
    EXPECT_TRUE(contains(refused({{0, 0}, {20000, 20000}}, small), "display window"));
    EXPECT_TRUE(contains(refused({{-1000000000, 0}, {1000000000, 7}}, small), "2000000001x8"));
}

TEST_F(Exr, LuminanceOnly) {
    writeRgba(Imf::WRITE_Y, Imf::Header(33, 17));
    const ImageFile file = readImage(path("a.exr"));
    EXPECT_TRUE(anyContains(file.notes, "luminance only"));
    const float* p = file.image.at(10, 5);
    const float luminance = 0.2126F * smooth(10) + 0.7152F * smooth(10) / 2 + 0.0722F * smooth(5);
    EXPECT_NEAR(p[0], luminance, 0.002F);
    EXPECT_EQ(p[0], p[1]);
    EXPECT_EQ(p[0], p[2]);
}

TEST_F(Exr, LuminanceChroma) {
    for (const bool shifted : {false, true}) {
        Imf::Header header(48, 32);
        if (shifted) header = Imf::Header({{4, 2}, {43, 27}}, {{0, 0}, {47, 31}});
        writeRgba(Imf::WRITE_YC, header);
        const ImageFile file = readImage(path("a.exr"));
        ASSERT_EQ(file.image.width, shifted ? 40 : 48);
        EXPECT_TRUE(anyContains(file.notes, "chroma"));
        const int dx = shifted ? 4 : 0, dy = shifted ? 2 : 0;
        for (int y = 0; y < file.image.height; ++y) {
            for (int x = 0; x < file.image.width; ++x) {
                const float* p = file.image.at(x, y);
                ASSERT_NEAR(p[0], smooth(x + dx), 0.03F) << x << " " << y;
                ASSERT_NEAR(p[1], smooth(x + dx) / 2, 0.03F);
                ASSERT_NEAR(p[2], smooth(y + dy), 0.06F);
            }
        }
    }
}

TEST_F(Exr, ChromaticitiesAreNoted) {
    Imf::Header header(8, 8);
    Imf::addChromaticities(header, Imf::Chromaticities()); // Rec. 709
    writeRgba(Imf::WRITE_RGB, header);
    EXPECT_TRUE(readImage(path("a.exr")).notes.empty());
    Imf::addChromaticities(header,
                           Imf::Chromaticities({0.7347F, 0.2653F}, {0, 1}, {0.0001F, -0.077F}));
    writeRgba(Imf::WRITE_RGB, header);
    EXPECT_TRUE(anyContains(readImage(path("a.exr")).notes, "chromaticities"));
}

TEST_F(Exr, AlphaIsIgnoredWithANoteOrKept) {
    const ImageFile without = readImage(testdata("alpha.exr"));
    EXPECT_EQ(without.image.channels, 3);
    EXPECT_TRUE(anyContains(without.notes, "alpha"));
    const ImageFile with = readImage(testdata("alpha.exr"), {"", true});
    ASSERT_EQ(with.image.channels, 4);
    EXPECT_TRUE(with.notes.empty());
    EXPECT_NEAR(with.image.at(3, 3)[1], 0.2F, 1e-4F);
    EXPECT_NEAR(with.image.at(3, 3)[3], 0.25F, 1e-4F);
}

TEST_F(Exr, StandardInputIsReadFromMemory) {
    for (const char* name : {"gradient.exr", "gradient.hdr", "alpha8.png", "gradient.tif"}) {
        const int saved = ::dup(0);
        ASSERT_NE(std::freopen(testdata(name).c_str(), "rb", stdin), nullptr);
        const ImageFile file = readImage("-");
        ::dup2(saved, 0);
        ::close(saved);
        EXPECT_EQ(file.image.pixels, readImage(testdata(name)).image.pixels) << name;
    }
}

} // namespace
} // namespace ibl::test
