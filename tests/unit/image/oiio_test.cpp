#include "image_files.h"

#include "image/srgb.h"

#include <thread>

#include <unistd.h>

namespace ibl::test {
namespace {

class Oiio : public ImageFiles {};

TEST_F(Oiio, TheProgramDoesNotLinkIt) {
    const std::string libraries = run("ldd /proc/" + std::to_string(::getpid()) + "/exe");
    EXPECT_TRUE(contains(libraries, "libOpenEXR"));
    EXPECT_FALSE(contains(libraries, "OpenImageIO"));
}

TEST_F(Oiio, AMissingModuleIsNamedWithItsPackage) {
    fs::copy_file("/proc/self/exe", path("program")); // away from the module
    std::string text;
    EXPECT_NE(status(path("program") + " --gtest_filter=Oiio.ReadsFloatTiffAsItIs", text), 0);
    EXPECT_TRUE(contains(text, "install the package libopenimageio")) << text;
}

TEST_F(Oiio, ReadsFloatTiffAsItIs) {
    const ImageFile file = readImage(testdata("gradient.tif"));
    expectNear(file.image, gradientPixels(), 1e-6F);
    EXPECT_EQ(file.format, "tiff");
    EXPECT_EQ(file.pixel_type, "float");
    EXPECT_EQ(file.compression, "lzw");
    EXPECT_TRUE(file.notes.empty());
}

TEST_F(Oiio, DecodesIntegerFormatsFromSrgb) {
    const float expected[] = {srgbToLinear(0.5F), srgbToLinear(0.25F), srgbToLinear(0.75F)};
    for (const std::string extension : {"jpg", "webp", "tga", "bmp", "ppm"}) {
        const ImageFile file = readImage(testdata("constant." + extension));
        ASSERT_EQ(file.image.width, 32) << extension;
        ASSERT_EQ(file.image.height, 16) << extension;
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(file.image.at(20, 10)[c], expected[c], 0.02F) << extension;
        }
        EXPECT_TRUE(anyContains(file.notes, "display-referred")) << extension;
    }
    EXPECT_NEAR(readImage(testdata("grey.tif")).image.at(1, 1)[2], srgbToLinear(128.0F / 255),
                1e-6F);
}

TEST_F(Oiio, TheFirstBytesDecideNotTheName) {
    fs::copy_file(testdata("gradient.tif"), path("a.exr"));
    EXPECT_EQ(readImage(path("a.exr")).format, "tiff");
    fs::copy_file(testdata("gradient.exr"), path("b.jpg"));
    EXPECT_EQ(readImage(path("b.jpg")).format, "exr");
    fs::copy_file(testdata("gradient.hdr"), path("c"));
    EXPECT_EQ(readImage(path("c")).format, "radiance");
}

TEST_F(Oiio, WritesTiffFloatHalfAndEightBits) {
    Image image = testPixels(33, 17);
    image.at(0, 0)[0] = 1e6F;
    writeOne(path("a.tif"), image);
    expectNear(readImage(path("a.tif")).image, image, 0);

    WriteOptions options;
    options.type = PixelType::half;
    OutputSet outputs;
    const WriteLosses losses = writeImage(outputs, path("h.tif"), image, options);
    outputs.commit();
    EXPECT_EQ(losses.above, 1U);
    const ImageFile half = readImage(path("h.tif"));
    EXPECT_EQ(half.pixel_type, "half");
    EXPECT_EQ(half.image.at(0, 0)[0], 65504);

    Image grey(4, 4, 3);
    std::fill(grey.pixels.begin(), grey.pixels.end(), 0.5F);
    writeOne(path("g.bmp"), grey);
    EXPECT_NEAR(readImage(path("g.bmp")).image.at(2, 2)[1], 0.5F, 0.003F);
    EXPECT_EQ(names(), (std::vector<std::string>{"a.tif", "g.bmp", "h.tif"}));
}

TEST_F(Oiio, NoDatesInFiles) {
    writeOne(path("a.tif"), testPixels(8, 8));
    const std::string first = readBytes(path("a.tif"));
    std::this_thread::sleep_for(std::chrono::milliseconds(1100));
    writeOne(path("a.tif"), testPixels(8, 8));
    EXPECT_EQ(readBytes(path("a.tif")), first);
}

TEST_F(Oiio, RefusesUnknownFormats) {
    writeBytes(path("a.txt"), "This is no image, but a text that is longer than any magic number.");
    EXPECT_TRUE(contains(errorOf(ExitCode::input, [&] { readImage(path("a.txt")); }), "format"));
    for (const char* name : {"a.foo", "a.term", "a.null"}) {
        errorOf(ExitCode::usage, [&] { writeOne(path(name), testPixels(2, 2)); });
    }
    // Without an extension there is no format at all.
    errorOf(ExitCode::usage, [&] { writeOne(path("a"), testPixels(2, 2)); });
    errorOf(ExitCode::usage, [&] { writeOne("-", testPixels(2, 2)); });
    EXPECT_EQ(names(), std::vector<std::string>{"a.txt"});
}

} // namespace
} // namespace ibl::test
