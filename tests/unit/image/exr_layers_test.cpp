#include "image_files.h"

#include <array>

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
    EXPECT_TRUE(contains(none, "outside its layers, only diffuse, specular;")) << none;
    const std::string unknown = refusal("layers.exr", "coat");
    EXPECT_TRUE(contains(unknown, "no layer 'coat'; there is diffuse, specular")) << unknown;
    EXPECT_TRUE(contains(refusal("no_colour.exr", ""), "only depth;"));
    EXPECT_TRUE(contains(refusal("gradient.exr", "depth"), "nor any other"));
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

/// A picture whose channels hold 0, 1, 2 ... / 8 in the order of their names here, by OpenImageIO.
class ExrLayersByName : public ExrLayers {
protected:
    std::string made(const std::string& names, const std::string& file) {
        const auto count = std::count(names.begin(), names.end(), ',') + 1;
        std::string colour = "0";
        for (int c = 1; c < count; ++c)
            colour += "," + std::to_string(c / 8.0);
        run("oiiotool --pattern constant:color=" + colour + " 3x2 " + std::to_string(count) +
            " -d float --chnames " + names + " -o " + path(file));
        return path(file);
    }
    static void expectPixel(const std::string& file, const std::string& layer,
                            const std::array<double, 3>& eighths) {
        const Image image = readImage(file, {layer, true}).image;
        ASSERT_EQ(image.channels, 3) << layer;
        for (std::size_t c = 0; c < 3; ++c)
            EXPECT_EQ(image.at(2, 1)[c], eighths[c] / 8) << layer;
    }
};

// As Blender and Nuke name them.
TEST_F(ExrLayersByName, VectorsAreThreeColoursAndLoneChannelsGrey) {
    const std::string file =
        made("R,G,B,A,View.Normal.X,View.Normal.Y,View.Normal.Z,N.x,N.y,N.z,depth.Z,id,"
             "forward.u,forward.v",
             "passes.exr");
    expectPixel(file, "View.Normal", {4, 5, 6});
    expectPixel(file, "N", {7, 8, 9});
    expectPixel(file, "depth", {10, 10, 10});
    expectPixel(file, "depth.Z", {10, 10, 10});
    expectPixel(file, "id", {11, 11, 11});
    expectPixel(file, "View.Normal.Y", {5, 5, 5});
    expectPixel(file, "forward.v", {13, 13, 13});
    expectPixel(file, "A", {3, 3, 3});
    expectPixel(file, "G", {1, 1, 1});
    EXPECT_EQ(readImage(file, {"", true}).image.channels, 4);
    EXPECT_EQ(readImage(file).layers, (std::vector<std::string>{"N", "View.Normal", "depth",
                                                                "forward.u", "forward.v", "id"}));
    EXPECT_TRUE(anyContains(readImage(file, {"depth"}).notes, "channel depth.Z is read as grey"));
    const std::string none = errorOf(ExitCode::input, [&] { readImage(file, {"forward"}); });
    EXPECT_TRUE(contains(none, "there is N, View.Normal, depth, forward.u, forward.v, id")) << none;
    // Vectors are no picture unless they are asked for, nor is the Y of one a luminance.
    const std::string vector = made("X,Y,Z", "vector.exr");
    EXPECT_TRUE(contains(errorOf(ExitCode::input, [&] { readImage(vector); }), "only X, Y, Z"));
    expectPixel(vector, "Z", {2, 2, 2});
    expectPixel(made("uv.X,uv.Y", "uv.exr"), "uv.Y", {1, 1, 1});
    EXPECT_EQ(readImage(path("uv.exr"), {"uv.X"}).layers,
              (std::vector<std::string>{"uv.X", "uv.Y"}));
}

TEST_F(ExrLayersByName, ChannelsOfPartsGoByThePartsName) {
    run("exrmultipart -combine -i " + made("R,G,B", "a.exr") + "::main " + made("Z", "b.exr") +
        "::far " + made("X,Y,Z,Q", "c.exr") + "::up -o " + path("parts.exr"));
    const std::string parts = path("parts.exr");
    expectPixel(parts, "", {0, 1, 2});
    expectPixel(parts, "far", {0, 0, 0});
    expectPixel(parts, "up", {0, 1, 2});
    expectPixel(parts, "up.Z", {2, 2, 2});
    expectPixel(parts, "Q", {3, 3, 3});
    EXPECT_EQ(readImage(parts).layers, (std::vector<std::string>{"main", "far", "up", "Q"}));
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
