#include "image_files.h"

namespace ibl::test {
namespace {

class ExrLayers : public ImageFiles {
protected:
    static std::string refusal(const std::string& file, const std::string& layer) {
        return errorOf(ExitCode::input, [&] { readImage(testdata(file), {layer}); });
    }
};

TEST_F(ExrLayers, ALayerIsReadByName) {
    for (const char* name : {"layers.exr", "layers_parts.exr"}) {
        const ImageFile diffuse = readImage(testdata(name), {"diffuse"});
        expectNear(diffuse.image, gradientPixels(), 0.0005F);
        EXPECT_EQ(diffuse.layers, (std::vector<std::string>{"diffuse", "specular"}));
        EXPECT_NEAR(readImage(testdata(name), {"specular"}).image.at(0, 0)[1], 0.2F, 1e-4F);
    }
}

TEST_F(ExrLayers, NothingIsGuessed) {
    const std::string none = refusal("layers.exr", "");
    EXPECT_TRUE(contains(none, "layers only: diffuse, specular")) << none;
    const std::string unknown = refusal("layers.exr", "coat");
    EXPECT_TRUE(contains(unknown, "no layer 'coat'; there is diffuse, specular")) << unknown;
    EXPECT_TRUE(contains(refusal("no_colour.exr", ""), "depth.Z"));
    EXPECT_TRUE(contains(refusal("no_colour.exr", "depth"), "depth.Z"));
    EXPECT_TRUE(contains(refusal("gradient.hdr", "diffuse"), "only OpenEXR files have layers"));
    EXPECT_TRUE(contains(refusal("gradient.tif", "diffuse"), "only OpenEXR files have layers"));
}

TEST_F(ExrLayers, PartsByNameTheFirstByDefault) {
    const ImageFile first = readImage(testdata("parts.exr"));
    expectNear(first.image, gradientPixels(), 1e-6F);
    EXPECT_TRUE(anyContains(first.notes, "2 parts; part 1 (first) is read"));
    EXPECT_EQ(first.layers, (std::vector<std::string>{"first", "second"}));
    const ImageFile second = readImage(testdata("parts.exr"), {"second"});
    EXPECT_NEAR(second.image.at(3, 3)[1], 0.2F, 1e-4F);
    EXPECT_TRUE(anyContains(second.notes, "part 2 (second) is read"));
}

TEST_F(ExrLayers, DeepImagesAreRefused) {
    EXPECT_TRUE(contains(refusal("deep.exr", ""), "deep image; flatten it"));
    run("exrmultipart -combine -i " + testdata("deep.exr") + " " + testdata("gradient.exr") +
        " -o " + path("both.exr"));
    const ImageFile flat = readImage(path("both.exr"));
    expectNear(flat.image, gradientPixels(), 1e-6F);
    EXPECT_TRUE(anyContains(flat.notes, "part 2"));
}

} // namespace
} // namespace ibl::test
