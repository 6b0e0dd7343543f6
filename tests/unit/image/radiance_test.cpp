#include "image_files.h"

#include <array>

namespace ibl::test {
namespace {

class Radiance : public ImageFiles {
protected:
    ImageFile readText(const std::string& bytes) {
        writeBytes(path("in.hdr"), bytes);
        return readImage(path("in.hdr"));
    }
    std::string refusal(const std::string& bytes) {
        return errorOf(ExitCode::input, [&] { readText(bytes); });
    }
};

const std::string kHeader = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";

std::string pixel(int r, int g, int b, int e) {
    return {static_cast<char>(r), static_cast<char>(g), static_cast<char>(b), static_cast<char>(e)};
}

TEST_F(Radiance, ValueIsMantissaTimesPowerWithNoHalf) {
    const ImageFile file =
        readText(kHeader + "-Y 1 +X 5\n" + pixel(128, 1, 0, 129) + pixel(255, 200, 3, 136) +
                 pixel(9, 9, 9, 0) + pixel(255, 0, 0, 255) + pixel(128, 0, 0, 1));
    const std::vector<float> expected = {1.0F, 1.0F / 128,  0, 255, 200,       3, 0, 0,
                                         0,    0x1.fep126F, 0, 0,   0x1p-128F, 0, 0};
    ASSERT_EQ(file.image.pixels.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(file.image.pixels[i], expected[i]) << i;
    }
    EXPECT_EQ(file.format, "radiance");
    EXPECT_EQ(file.pixel_type, "rgbe");
}

TEST_F(Radiance, EveryOrientation) {
    // Stored: one scanline after the other, pixel values 1 2 3 / 4 5 6 in red.
    struct Case {
        const char* size;
        int width;
        std::array<int, 6> upright; // as seen, row by row
    };
    for (const Case& c : {
             Case{"-Y 2 +X 3", 3, {1, 2, 3, 4, 5, 6}},
             Case{"-Y 2 -X 3", 3, {3, 2, 1, 6, 5, 4}},
             Case{"+Y 2 +X 3", 3, {4, 5, 6, 1, 2, 3}},
             Case{"+Y 2 -X 3", 3, {6, 5, 4, 3, 2, 1}},
             Case{"+X 2 -Y 3", 2, {1, 4, 2, 5, 3, 6}},
             Case{"+X 2 +Y 3", 2, {3, 6, 2, 5, 1, 4}},
             Case{"-X 2 -Y 3", 2, {4, 1, 5, 2, 6, 3}},
             Case{"-X 2 +Y 3", 2, {6, 3, 5, 2, 4, 1}},
         }) {
        std::string text = kHeader + c.size + "\n";
        for (int v = 1; v <= 6; ++v)
            text += pixel(v, 0, 0, 136);
        const Image image = readText(text).image;
        ASSERT_EQ(image.width, c.width) << c.size;
        ASSERT_EQ(image.height, 6 / c.width) << c.size;
        for (std::size_t i = 0; i < 6; ++i) {
            EXPECT_EQ(image.pixels[3 * i], static_cast<float>(c.upright[i])) << c.size << " " << i;
        }
    }
}

TEST_F(Radiance, OldRunsCountToTheBase256) {
    // 1 pixel, 2 repeats, then 3 + 256 repeats, then another pixel.
    const std::string text = kHeader + "-Y 1 +X 263\n" + pixel(7, 0, 0, 136) + pixel(1, 1, 1, 2) +
                             pixel(8, 0, 0, 136) + pixel(1, 1, 1, 2) + pixel(1, 1, 1, 1) +
                             pixel(9, 0, 0, 136);
    const ImageFile file = readText(text);
    for (int x = 0; x < 263; ++x) {
        EXPECT_EQ(file.image.at(x, 0)[0], x < 3 ? 7.0F : x < 262 ? 8.0F : 9.0F) << x;
    }
    EXPECT_EQ(file.compression, "rle");
}

TEST_F(Radiance, NewRuns) {
    const auto component = [](int a, int b) { // three literals a, five b as a run
        return std::string{'\x03', char(a), char(a), char(a), '\x85', char(b)};
    };
    const ImageFile file =
        readText(kHeader + "-Y 1 +X 8\n" + std::string("\x02\x02\0\x08", 4) + component(10, 20) +
                 component(30, 40) + component(50, 60) + component(char(136), char(137)));
    EXPECT_EQ(file.image.at(2, 0)[0], 10);
    EXPECT_EQ(file.image.at(3, 0)[0], 40);
    EXPECT_EQ(file.image.at(2, 0)[2], 50);
    EXPECT_EQ(file.image.at(7, 0)[2], 120);
}

TEST_F(Radiance, DividesByExposureAndColourCorrection) {
    const ImageFile file =
        readText("#?RADIANCE\nEXPOSURE=2\nFORMAT=32-bit_rle_rgbe\nEXPOSURE= 4.0\n"
                 "COLORCORR= 1 2 4\nCOLORCORR=1 1 0.5\n# EXPOSURE=100\n\n-Y 1 +X 1\n" +
                 pixel(128, 128, 128, 136));
    EXPECT_EQ(file.exposure, 8);
    EXPECT_EQ(file.colour_correction, Imath::V3d(1, 2, 2));
    EXPECT_EQ(file.image.pixels[0], 16);
    EXPECT_EQ(file.image.pixels[1], 8);
    EXPECT_EQ(file.image.pixels[2], 8);
}

TEST_F(Radiance, RefusesBadHeaders) {
    const std::string p = pixel(1, 2, 3, 136);
    EXPECT_TRUE(contains(refusal("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n"), "truncated"));
    EXPECT_TRUE(contains(refusal(kHeader), "truncated"));
    EXPECT_TRUE(contains(refusal(kHeader + "hello\n" + p), "size line"));
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 1 +Y 1\n" + p), "size line"));
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 1 +X 1 +Z 1\n" + p), "size line"));
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 1.5 +X 1\n" + p), "size line"));
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 0 +X 1\n" + p), "no pixels"));
    EXPECT_TRUE(contains(refusal(kHeader + "-Y -4 +X 1\n" + p), "no pixels"));
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 99999999 +X 99999999\n" + p), "more than"));
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 60000 +X 60000\n" + p), "more than"));
    EXPECT_TRUE(contains(refusal("#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n" + p), "XYZ"));
    EXPECT_TRUE(contains(refusal("#?RADIANCE\nFORMAT=8-bit\n\n-Y 1 +X 1\n" + p), "unknown"));
    EXPECT_TRUE(contains(refusal("#?RADIANCE\nEXPOSURE=0\n\n-Y 1 +X 1\n" + p), "EXPOSURE"));
    EXPECT_TRUE(contains(refusal("#?RADIANCE\nEXPOSURE=x\n\n-Y 1 +X 1\n" + p), "EXPOSURE"));
    EXPECT_TRUE(contains(refusal("#?RADIANCE\nCOLORCORR=1 1\n\n-Y 1 +X 1\n" + p), "COLORCORR"));
}

TEST_F(Radiance, RefusesLyingRuns) {
    const std::string new_line = std::string("\x02\x02\0\x08", 4);
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 1 +X 8\n" + new_line + "\x89\x01"), "scanline 0"));
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 1 +X 8\n" + new_line + std::string(64, '\0')),
                         "scanline 0"));
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 1 +X 9\n" + new_line + std::string(64, '\x01')),
                         "scanline 0"));
    // An old run before any pixel, one too long, one of zeros for ever.
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 1 +X 4\n" + pixel(1, 1, 1, 4)), "scanline 0"));
    EXPECT_TRUE(contains(refusal(kHeader + "-Y 1 +X 4\n" + pixel(5, 1, 1, 4) + pixel(1, 1, 1, 4)),
                         "scanline 0"));
    std::string zeros = kHeader + "-Y 1 +X 4\n" + pixel(5, 1, 1, 4);
    for (int i = 0; i < 100; ++i)
        zeros += pixel(1, 1, 1, 0);
    EXPECT_TRUE(contains(refusal(zeros), "scanline 0"));
    // A size that the file cannot hold is found out before memory is taken.
    EXPECT_TRUE(
        contains(refusal(kHeader + "-Y 32768 +X 32767\n" + std::string(64, '\x05')), "scanline 0"));
}

TEST_F(Radiance, RoundTripWithinHalfAStep) {
    for (const int width : {1, 7, 8, 100, 300, 40000}) {
        const Image image = testPixels(width, width > 1000 ? 1 : 5);
        writeOne(path("a.hdr"), image);
        const Image back = readImage(path("a.hdr")).image;
        for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
            const float largest =
                std::max({image.pixels[i], image.pixels[i + 1], image.pixels[i + 2]});
            int e = 0;
            std::frexp(largest, &e);
            // A carry doubles the step.
            const float step = std::ldexp(1.0F, e - 8) * (largest > std::ldexp(.998F, e) ? 2 : 1);
            for (std::size_t c = i; c < i + 3; ++c) {
                ASSERT_NEAR(back.pixels[c], image.pixels[c], step / 2 * 1.000001F) << width;
            }
        }
        writeOne(path("b.hdr"), back);
        EXPECT_EQ(readBytes(path("a.hdr")), readBytes(path("b.hdr"))) << "not idempotent";
    }
}

TEST_F(Radiance, RunsOfAllLengthsSurvive) {
    Image image(2000, 1, 3);
    int x = 0;
    for (int run = 1; x < 2000; ++run) {
        for (int i = 0; i < run * 5 && x < 2000; ++i, ++x) {
            for (int c = 0; c < 3; ++c)
                image.at(x, 0)[c] = static_cast<float>(128 + run);
        }
    }
    writeOne(path("a.hdr"), image);
    expectNear(readImage(path("a.hdr")).image, image, 0);
    EXPECT_LT(fs::file_size(path("a.hdr")), 500U);
}

TEST_F(Radiance, ExtremeValuesAreClampedCarriedAndCounted) {
    Image image(8, 1, 3);
    std::fill(image.pixels.begin(), image.pixels.end(), 0.0F);
    image.at(0, 0)[0] = 255.9F;    // rounds to 256: carries
    image.at(1, 0)[0] = INFINITY;  // clamped
    image.at(2, 0)[0] = 3e38F;     // clamped
    image.at(3, 0)[0] = -2;        // 0
    image.at(4, 0)[1] = NAN;       // 0
    image.at(5, 0)[2] = 1e-40F;    // black
    image.at(6, 0)[0] = 0x1p-128F; // the least
    OutputSet outputs;
    const WriteLosses losses = writeImage(outputs, path("a.hdr"), image, {});
    outputs.commit();
    EXPECT_EQ(losses.above, 2U);
    EXPECT_EQ(losses.below, 1U);
    EXPECT_EQ(losses.not_number, 1U);
    const Image back = readImage(path("a.hdr")).image;
    const std::array<float, 8> red = {256, 0x1.fep126F, 0x1.fep126F, 0, 0, 0, 0x1p-128F, 0};
    for (int x = 0; x < 8; ++x) {
        EXPECT_EQ(back.at(x, 0)[0], red[static_cast<std::size_t>(x)]) << x;
        EXPECT_EQ(back.at(x, 0)[1], 0) << x;
        EXPECT_EQ(back.at(x, 0)[2], 0) << x;
    }
    EXPECT_EQ(describeLosses(losses, "a.hdr").size(), 3U);
}

TEST_F(Radiance, OutsideReaderAndWriterAgree) {
    // Its writer truncates: up to a whole step below, of 8 / 256 where red is 4.
    expectNear(readImage(testdata("gradient.hdr")).image, gradientPixels(), 0, 8.0F / 256);
    const Image image = testPixels(64, 32);
    writeOne(path("a.hdr"), image);
    run("oiiotool " + path("a.hdr") + " -d float -o " + path("a.exr"));
    expectNear(readImage(path("a.exr")).image, readImage(path("a.hdr")).image, 0);
}

TEST_F(Radiance, SameBytesForAnyThreads) {
    const Image image = testPixels(100, 200);
    WriteOptions one, many;
    one.threads = 1;
    many.threads = 5;
    writeOne(path("one.hdr"), image, one);
    writeOne(path("many.hdr"), image, many);
    EXPECT_EQ(readBytes(path("one.hdr")), readBytes(path("many.hdr")));
}

} // namespace
} // namespace ibl::test
