#include "image_files.h"

#include "image/png.h"
#include "image/srgb.h"

#include <png.h>

namespace ibl::test {
namespace {

class Png : public ImageFiles {};

double srgbDecoded(double v) {
    return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

TEST(Srgb, RoundsToTheNearestCodeAtEveryBoundary) {
    for (int code = 1; code < 256; ++code) {
        const double boundary = srgbDecoded((code - 0.5) / 255);
        const float above = static_cast<float>(boundary * 1.000001);
        const float below = static_cast<float>(boundary * 0.999999);
        EXPECT_EQ(linearToSrgb8(above), code);
        EXPECT_EQ(linearToSrgb8(below), code - 1);
    }
}

TEST(Srgb, InvertsAndClamps) {
    for (int code = 0; code < 256; ++code) {
        const float linear = srgbToLinear(static_cast<float>(code) / 255);
        EXPECT_EQ(linearToSrgb8(linear), code);
        EXPECT_NEAR(linearToSrgb(linear), static_cast<float>(code) / 255, 1e-6F);
    }
    EXPECT_EQ(linearToSrgb8(-1), 0);
    EXPECT_EQ(linearToSrgb8(NAN), 0);
    EXPECT_EQ(linearToSrgb8(1e-30F), 0);
    EXPECT_EQ(linearToSrgb8(1.5F), 255);
    EXPECT_EQ(linearToSrgb8(INFINITY), 255);
}

/// The codes in a PNG file of greys or colours, by libpng.
std::vector<int> codesOf(const std::string& name, int bits) {
    std::vector<int> codes;
    for (const float v : readImage(name).image.pixels) {
        const double c = v;
        const double encoded = c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
        codes.push_back(static_cast<int>(std::lround(encoded * ((1 << bits) - 1))));
    }
    return codes;
}

TEST_F(Png, CodesOf8And16BitsRoundTrip) {
    for (const int bits : {8, 16}) {
        for (const int width : {1, 3, 500}) {
            const int height = width == 500 ? 700 : 2; // more than one strip
            const int largest = (1 << bits) - 1;
            Image image(width, height);
            std::vector<int> codes;
            std::uint32_t state = 1;
            for (float& v : image.pixels) {
                codes.push_back(static_cast<int>((state = state * 1664525 + 1013904223) >> 16) &
                                largest);
                v = static_cast<float>(codes.back()) / static_cast<float>(largest);
            }
            OutputSet outputs;
            writePng(outputs.add(path("a.png")), image, {bits, false, true});
            outputs.commit();
            EXPECT_TRUE(codesOf(path("a.png"), bits) == codes) << bits << " " << width;
            if (bits == 16) continue;
            run("oiiotool " + path("a.png") + " -d uint8 -o " + path("a.ppm"));
            const std::string ppm = readBytes(path("a.ppm"));
            EXPECT_TRUE(
                std::equal(codes.begin(), codes.end(), ppm.end() - codes.size(),
                           [](int code, char c) { return code == static_cast<std::uint8_t>(c); }));
        }
    }
}

// The transfer function of the standard, in double, rounded: no code is off, whatever the bits.
TEST_F(Png, SrgbIsExactToACode) {
    Image image(4096, 3);
    for (std::size_t i = 0; i < image.pixels.size(); ++i) {
        image.pixels[i] = static_cast<float>(std::pow(static_cast<double>(i) / 36864, 3));
    }
    for (const int bits : {8, 16}) {
        OutputSet outputs;
        writePng(outputs.add(path("a.png")), image, {bits, false, false});
        outputs.commit();
        const std::vector<int> codes = codesOf(path("a.png"), bits);
        for (std::size_t i = 0; i < codes.size(); ++i) {
            const double c = image.pixels[i];
            const double encoded =
                c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
            ASSERT_EQ(codes[i], static_cast<int>(std::floor(encoded * ((1 << bits) - 1) + 0.5)))
                << bits << " bits of " << c;
        }
    }
}

// The two floats about each place where one code becomes the next, of all 65536.
TEST_F(Png, EveryDeepCodeBeginsWhereItShould) {
    Image image(65535, 1, 3);
    for (int code = 1; code < 65536; ++code) {
        const long double v = (code - 0.5L) / 65535;
        const long double boundary =
            v <= 0.04045L ? v / 12.92L : std::pow((v + 0.055L) / 1.055L, 2.4L);
        float from = static_cast<float>(boundary);
        if (from < boundary) from = std::nextafter(from, 2.0F);
        float* p = image.at(code - 1, 0);
        p[0] = std::nextafter(from, -1.0F);
        p[1] = from;
        p[2] = 0;
    }
    OutputSet outputs;
    writePng(outputs.add(path("a.png")), image, {16, false, false});
    outputs.commit();
    const std::vector<int> codes = codesOf(path("a.png"), 16);
    for (int code = 1; code < 65536; ++code) {
        ASSERT_EQ(codes[static_cast<std::size_t>(3 * code - 3)], code - 1);
        ASSERT_EQ(codes[static_cast<std::size_t>(3 * code - 2)], code);
    }
}

TEST_F(Png, DitheringKeepsTheMeanBetweenCodes) {
    for (const double code : {0.25, 17.5, 200.125}) {
        Image image(16, 16);
        for (float& v : image.pixels)
            v = static_cast<float>(code / 255);
        OutputSet outputs;
        writePng(outputs.add(path("a.png")), image, {8, true, true});
        outputs.commit();
        run("oiiotool " + path("a.png") + " -d uint8 -o " + path("a.ppm"));
        const std::string ppm = readBytes(path("a.ppm"));
        double sum = 0;
        for (std::size_t i = ppm.size() - 768; i < ppm.size(); ++i) {
            const int got = static_cast<std::uint8_t>(ppm[i]);
            EXPECT_LE(std::abs(got - code), 1);
            sum += got;
        }
        EXPECT_NEAR(sum / 768, code, 0.003);
    }
}

TEST_F(Png, LinearFloatsAreEncodedClampedAndCounted) {
    Image image(2, 2, 3);
    const float values[] = {0, 0.5F, 1, -1, 2, NAN, 0.18F, 0.2F, 0.9F, 0.001F, 1e-9F, 1};
    std::copy(std::begin(values), std::end(values), image.pixels.begin());
    OutputSet outputs;
    const WriteLosses losses = writeImage(outputs, path("a.png"), image);
    outputs.commit();
    EXPECT_EQ(losses.above, 1U);
    EXPECT_EQ(losses.below, 1U);
    EXPECT_EQ(losses.not_number, 1U);
    const ImageFile file = readImage(path("a.png"));
    for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_FLOAT_EQ(file.image.pixels[i],
                        srgbToLinear(static_cast<float>(linearToSrgb8(values[i])) / 255));
    }
    EXPECT_EQ(file.format, "png");
    EXPECT_EQ(file.pixel_type, "uint8");
    EXPECT_TRUE(anyContains(file.notes, "display-referred"));
    EXPECT_TRUE(contains(readBytes(path("a.png")), "sRGB"));
    EXPECT_TRUE(anyContains(describeLosses(losses, "a.png"), "1 value above 1 was written as 1"));
}

TEST_F(Png, AlphaIsPremultipliedInMemoryAndNotInTheFile) {
    Image image(1, 2, 4);
    const float values[] = {0.25F, 0.125F, 0, 0.5F, 0, 0, 0, 0};
    std::copy(std::begin(values), std::end(values), image.pixels.begin());
    writeOne(path("a.png"), image);
    const Image back = readImage(path("a.png"), {"", true}).image;
    ASSERT_EQ(back.channels, 4);
    EXPECT_NEAR(back.at(0, 0)[0], 0.25F, 0.003F);
    EXPECT_NEAR(back.at(0, 0)[1], 0.125F, 0.002F);
    EXPECT_NEAR(back.at(0, 0)[3], 128.0F / 255, 1e-6F);
    EXPECT_EQ(back.at(0, 1)[3], 0);
    // Without alpha the stored colour is read as it is.
    EXPECT_NEAR(readImage(path("a.png")).image.at(0, 0)[0], 0.5F, 0.003F);
}

TEST_F(Png, ReadsOtherPeoplesTypes) {
    // Associated 0.1 0.2 0.05 with alpha 0.25, which the file holds divided out: 0.4 0.8 0.2.
    for (const char* name : {"alpha8.png", "alpha16.png"}) {
        const bool deep = std::string(name) == "alpha16.png";
        const ImageFile file = readImage(testdata(name), {"", true});
        EXPECT_EQ(file.pixel_type, deep ? "uint16" : "uint8");
        EXPECT_NEAR(file.image.at(3, 3)[3], 0.25F, deep ? 1e-5F : 0.002F);
        EXPECT_NEAR(file.image.at(3, 3)[0], 0.25 * srgbDecoded(0.4), deep ? 1e-5F : 0.002F);
        EXPECT_NEAR(file.image.at(3, 3)[1], 0.25 * srgbDecoded(0.8), deep ? 1e-5F : 0.004F);
        EXPECT_TRUE(anyContains(readImage(testdata(name)).notes, "alpha"));
    }
    const Image grey = readImage(testdata("grey.png")).image;
    ASSERT_EQ(grey.channels, 3);
    EXPECT_NEAR(grey.at(5, 5)[2], srgbDecoded(128.0 / 255), 1e-6);
}

/// A file of any type by libpng: `rows` are its packed bytes.
void writeByLibpng(const std::string& path, int width, int depth, int type, int interlace,
                   double gamma, const std::vector<png_color>& palette,
                   std::vector<std::vector<png_byte>> rows) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(rows.size()),
                 depth, type, interlace, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (!palette.empty()) png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
    if (gamma > 0) png_set_gAMA(png, info, gamma);
    png_write_info(png, info);
    std::vector<png_bytep> pointers;
    for (auto& row : rows)
        pointers.push_back(row.data());
    png_write_image(png, pointers.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    std::fclose(file);
}

TEST_F(Png, InterlacedPalettes) {
    const std::vector<png_color> palette = {{0, 0, 0}, {255, 128, 0}, {10, 20, 30}, {9, 9, 9}};
    // Two bits a pixel: 0 1 2 3 and 3 2 1 0, nine rows.
    std::vector<std::vector<png_byte>> rows(9, {0x1b});
    rows[8] = {0xe4};
    writeByLibpng(path("a.png"), 4, 2, PNG_COLOR_TYPE_PALETTE, PNG_INTERLACE_ADAM7, 0, palette,
                  rows);
    const Image image = readImage(path("a.png")).image;
    ASSERT_EQ(image.height, 9);
    for (const int x : {0, 1, 2, 3}) {
        const png_color& colour = palette[static_cast<std::size_t>(x)];
        EXPECT_NEAR(image.at(x, 3)[0], srgbDecoded(colour.red / 255.0), 1e-6);
        EXPECT_NEAR(image.at(3 - x, 8)[1], srgbDecoded(colour.green / 255.0), 1e-6);
    }
}

TEST_F(Png, AGammaChunkIsHonoured) {
    // 16 bits, linear: 0x8000 and 0x0100 of 65535.
    writeByLibpng(path("a.png"), 2, 16, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, 1.0, {},
                  {{0x80, 0, 1, 0}});
    const ImageFile file = readImage(path("a.png"));
    EXPECT_NEAR(file.image.at(0, 0)[0], 32768.0 / 65535, 1e-6);
    EXPECT_NEAR(file.image.at(1, 0)[2], 256.0 / 65535, 1e-7);
    EXPECT_TRUE(anyContains(file.notes, "gAMA"));
}

TEST_F(Png, SameBytesForAnyThreads) {
    const Image image = testPixels(600, 700);
    WriteOptions one, many;
    one.threads = 1;
    many.threads = 5;
    writeOne(path("one.png"), image, one);
    writeOne(path("many.png"), image, many);
    EXPECT_EQ(readBytes(path("one.png")), readBytes(path("many.png")));
}

} // namespace
} // namespace ibl::test
