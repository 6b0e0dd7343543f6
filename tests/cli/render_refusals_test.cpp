// What render refuses, and what it tells.
#include "cli/tool.h"

#include "image/write.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace ibl {
namespace {

using Words = std::vector<std::string>;

TEST(Render, Refusals) {
    const Scratch scratch;
    const auto refused = [&](Words words, int code, const std::string& said) {
        words.insert(words.begin(), {"render", "--probe", "builtin:furnace", "-o", "o.png"});
        expectRefused(runTool(words, scratch.path()), code, said);
    };
    refused({"--size", "64"}, 1, "--size");
    refused({"--size", "0x64"}, 1, "--size");
    refused({"--size", "64x64x64"}, 1, "--size");
    refused({"--size", "64x-1"}, 1, "--size");
    refused({"--size", "100000x8"}, 1, "16384");
    refused({"--samples", "0"}, 1, "--samples");
    refused({"--object", "pyramid"}, 1, "pyramid");
    refused({"--object", "nowhere/pyramid"}, 2, "nowhere/pyramid");
    refused({"--object", "missing.obj"}, 2, "missing.obj");
    refused({"--shader", "wood"}, 1, "--shader");
    refused({"--tonemap", "magic"}, 1, "--tonemap");
    refused({"--fov", "0"}, 1, "--fov");
    refused({"--fov", "180"}, 1, "--fov");
    refused({"--fov", "nan"}, 1, "");
    refused({"--eye", "0,0,0"}, 1, "");
    refused({"--eye", "0,4,0"}, 1, "up");
    refused({"--eye", "1,2"}, 1, "--eye");
    refused({"--eye", "0,0,4", "--azimuth", "3"}, 1, "--azimuth");
    refused({"--up", "0,0,1"}, 1, "--eye");
    refused({"--background", "missing.png"}, 2, "missing.png");
    refused({"--reflectivity", "1.5"}, 1, "--reflectivity");
    refused({"--background", "nan,0,0"}, 1, "three numbers from 0");
    refused({"--background", "0,inf,0"}, 1, "three numbers from 0");
    refused({"--background", "0,0,-1"}, 1, "three numbers from 0");
    refused({"--background", "0,0,1e39"}, 1, "three numbers from 0");
    refused({"--roughness", "0.5"}, 1, "--roughness: --shader mirror does not have it");
    refused({"--shader", "coat", "--fresnel", "0,1,5", "--ior", "1.4"}, 1, "--ior");
    refused({"--scale", "0"}, 1, "--scale");
    refused({"--distance", "0"}, 1, "above 0");
    refused({"--light-method", "median"}, 1, "--light-method");
    refused({"--shadow-size", "64"}, 1, "--shadow-size");
    refused({"--shader", "lambert", "--lights", "-3"}, 1, "1 to 65536");
    refused({"--shader", "lambert", "--lights", "2.5"}, 1, "1 to 65536");
    refused({"--shader", "lambert", "--lights", "0"}, 1, "1 to 65536");
    refused({"--shader-folder", "none"}, 2, "none");
    refused({"--shader-folder", "."}, 2, "built-in shader's name");
    refused({"--shader", "ggx", "--roughness", "1.01"}, 1, "--roughness");
    refused({"--shader", "glass", "--ior", "0.9"}, 1, "--ior");
    refused({"--shader", "glass", "--fresnel", "0.1,0.9"}, 1, "--fresnel");
    refused({"--shader", "glass", "--samples-specular", "8"}, 1, "--samples-specular");
    refused({"--shader", "ggx", "--samples-specular", "0"}, 1, "--samples-specular");
    refused({"--multiscatter", "off"}, 1, "--multiscatter");
    refused({"--masking", "separable"}, 1, "--masking");
    refused({"--shader", "ggx", "--masking", "smith"}, 1, "--masking");
    refused({"--interpolation", "flat"}, 1, "sphere");
    writeFile(scratch / "bad.obj", "v 1 2 three\nf 1 2 9\n");
    refused({"--object", "bad.obj"}, 2, "bad.obj");
    writeFile(scratch / "own.frag", "vec3 shade(vec3 n, vec3 i) { return vec3(1.0); }\n");
    refused({"--shader", "own.frag", "--lights", "4"}, 1, "own.frag is not lit");
    refused({"--shader", "own.frag", "--roughness", "1"}, 1, "own.frag has no uniform roughness");
    writeFile(scratch / "picture", std::string("\x89PNG\r\n\x1a\n\0\0\0\rIHDR", 16));
    refused({"--object", "picture"}, 2, "none of OBJ, PLY and glTF");
    EXPECT_EQ(scratch.names(), (Words{"bad.obj", "own.frag", "picture"}));
}

TEST(Render, PicturesThatAreNoNumbersAreRefused) {
    const Scratch scratch;
    Image picture(4, 4);
    std::fill(picture.pixels.begin(), picture.pixels.end(), 0.5F);
    picture.at(1, 2)[1] = std::numeric_limits<float>::quiet_NaN();
    OutputSet outputs;
    writeImage(outputs, (scratch / "nan.exr").string(), picture);
    outputs.commit();
    const auto refused = [&](Words words, const char* said) {
        words.insert(words.begin(), {"render", "--probe", "builtin:sky", "-o", "o.exr"});
        SCOPED_TRACE(words[5]);
        expectRefused(runTool(words, scratch.path()), 2, said);
    };
    refused({"--base-texture", "nan.exr"}, "the first at (1, 2)");
    refused({"--background", "nan.exr"}, "the first at (1, 2)");
    refused({"--ground", "--lights", "2", "--plate", "nan.exr"}, "the first at (1, 2)");
    writeImage(outputs, (scratch / "small.exr").string(), Image(2, 3));
    outputs.commit();
    refused({"--background", "small.exr", "--size", "8x8"}, "small.exr: is of 2x3 pixels");
    EXPECT_EQ(scratch.names(), (Words{"nan.exr", "small.exr"}));
}

TEST(Render, OwnShadersThatDivideByZeroAreTold) {
    const Scratch scratch;
    writeFile(
        scratch / "own.frag",
        "vec3 shade(vec3 normal, vec3 incident) { return vec3(1.0 / (normal.y - normal.y)); }\n");
    const ToolResult result =
        runTool({"render", "--probe", "builtin:sky", "--shader", "own.frag", "--object", "cube",
                 "--size", "16x16", "--samples", "1", "-o", "o.exr"},
                scratch.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("NaN or infinite"), std::string::npos) << result.err;
}

TEST(Render, FrameAndDeviceRefusals) {
    const Scratch scratch;
    const auto refused = [&](Words words, int code, const std::string& said) {
        words.insert(words.begin(), {"render", "--probe", "builtin:furnace", "--size", "8x8"});
        expectRefused(runTool(words, scratch.path()), code, said);
    };
    refused({"--azimuth", "0..90", "-o", "o.png"}, 1, "--frames");
    refused({"--frames", "1-3", "-o", "o.png"}, 1, "%04d");
    refused({"-o", "o.%04d.png"}, 1, "--frames");
    for (const char* range : {"3", "3-1", "-1-3", "a-b", "1-2-3", "1-99999999999"})
        refused({"--frames", range, "-o", "o%d.png"}, 1, "--frames");
    for (const char* ramp : {"0..", "..9", "0..nan", "1..2..3", "x"})
        refused({"--frames", "1-2", "--yaw", ramp, "-o", "o%d.png"}, 1, "--yaw");
    refused({"--frames", "1-2", "--elevation", "0..91", "-o", "o%d.png"}, 1, "--elevation");
    refused({"--rotate", "1,2", "-o", "o.png"}, 1, "--rotate");
    refused({"--scale", "0", "-o", "o.png"}, 1, "--scale");
    refused({"--focal-length", "50", "--fov", "40", "-o", "o.png"}, 1, "--fov");
    refused({"--sensor", "24", "-o", "o.png"}, 1, "--focal-length");
    refused({"--camera", "0", "-o", "o.png"}, 1, "--camera");
    refused({"--camera", "0", "--eye", "1,2,3", "-o", "o.png"}, 1, "--camera");
    refused({"--aov", "depth", "-o", "o.png"}, 1, "--aov");
    refused({"--aov", "beauty", "-o", "o.exr"}, 1, "--aov");
    refused({"--base-texture", "none.png", "-o", "o.png"}, 2, "none.png");
    refused({"--device", "gpu", "-o", "o.png"}, 1, "--device");
    refused({"--exposure", "auto", "--adapt", "2", "-o", "o.png"}, 1, "--adapt-state");
    EXPECT_TRUE(scratch.names().empty());
}

} // namespace
} // namespace ibl
