// Lights, shadows and the ground of render, as users call them.
#include "cli/render_support.h"

#include "panorama/builtin.h"
#include "support/oracle.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

using Json = nlohmann::json;

double relativeError(const Image& a, const Image& b) {
    double error = 0, reference = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        error += std::pow(a.pixels[i] - b.pixels[i], 2);
        reference += std::pow(b.pixels[i], 2);
    }
    return std::sqrt(error / reference);
}

TEST(RenderLights, LambertUnderManyIsDiffuseUnderTheProbe) {
    const Scratch scratch;
    const Words common{"--probe",   "builtin:sky", "--background", "0,0,0",      "--size", "48x48",
                       "--samples", "1",           "--base-color", "0.5,0.5,0.5"};
    Words lit = common, diffuse = common;
    lit.insert(lit.end(), {"--shader", "lambert", "--lights", "4096"});
    diffuse.insert(diffuse.end(), {"--shader", "diffuse"});
    EXPECT_LT(relativeError(render(scratch, lit), render(scratch, diffuse, "d.exr")), 1e-3);
}

// scripts/make-references-ground says what Cycles rendered: a black sphere on a ground of albedo
// 0.5. Over what that ground would be without it, this is the ratio that the shadow is.
TEST(RenderLights, GroundShadowIsThatOfAPathTracer) {
    const Scratch scratch;
    const Image cycles = readImage(testData("ground_cycles.exr")).image;
    const auto whole = oracle::convolve(builtinProbe("builtin:sky").image, oracle::lambert(),
                                        {{0, 1, 0}}, 1e-5)[0];
    const Image frame = render(scratch, {"--probe",
                                         "builtin:sky",
                                         "--lights",
                                         "256",
                                         "--light-method",
                                         "variance",
                                         "--shader",
                                         "lambert",
                                         "--base-color",
                                         "0,0,0",
                                         "--background",
                                         "1,1,1",
                                         "--ground",
                                         "--ground-height",
                                         "-1",
                                         "--azimuth",
                                         "30",
                                         "--elevation",
                                         "35",
                                         "--distance",
                                         "7",
                                         "--size",
                                         "64x64"});
    double error = 0, reference = 0, deepest = 1;
    for (std::size_t i = 0; i < frame.pixels.size(); ++i) {
        const double expected = cycles.pixels[i] / (0.5 * whole[i % 3]);
        error += std::pow(frame.pixels[i] - expected, 2);
        reference += expected * expected;
        if (expected > 0.01) deepest = std::min(deepest, expected);
    }
    EXPECT_LT(std::sqrt(error / reference), 0.02);
    EXPECT_LT(deepest, 0.3); // there is a shadow
    RecordProperty("relative_rmse", std::to_string(std::sqrt(error / reference)));
    std::printf("ground shadow, relative RMSE: %.4f\n", std::sqrt(error / reference));
}

TEST(RenderLights, FilesMayHoldPointAndSpotLights) {
    const Scratch scratch;
    writeFile(scratch / "l.json", R"({"lights": [
        {"direction": [0, 1, 0], "irradiance": [0, 0, 0]},
        {"type": "point", "position": [0, 0, 3], "intensity": [4, 0, 0]},
        {"type": "spot", "position": [0, 0, 3], "direction": [0, 0, -1], "intensity": [0, 4, 0],
         "inner_cone": 4, "outer_cone": 8}]})");
    const Image frame =
        render(scratch, {"--probe", "builtin:furnace", "--shader", "lambert", "--lights", "l.json",
                         "--background", "0,0,0", "--distance", "5", "--size", "65x65", "--samples",
                         "1", "--report", "r.json", "--depfile", "d"});
    // The middle faces both at the distance 2; at the sides only the point light reaches.
    const double pi = std::acos(-1.0);
    EXPECT_NEAR(frame.at(32, 32)[0], 1 / pi, 1e-4);
    EXPECT_NEAR(frame.at(32, 32)[1], 1 / pi, 1e-4);
    EXPECT_GT(frame.at(41, 32)[0], 0.05);
    EXPECT_EQ(frame.at(41, 32)[1], 0);
    const Json lights = Json::parse(readFile(scratch / "r.json")).at("results").at("lights");
    EXPECT_EQ(lights, Json({{"given", 3}, {"drawn", 2}, {"black", 1}, {"unseen", 0}}));
    EXPECT_EQ(readFile(scratch / "d"), "o.exr: l.json\n");
}

TEST(RenderLights, PlateGivesItsSizeAndKeepsWhatIsNotShadowed) {
    const Scratch scratch;
    const Words common{"--probe", "builtin:sky", "--shader",    "mirror",     "--lights",
                       "64",      "--ground",    "--elevation", "30",         "--size",
                       "40x30",   "--samples",   "4",           "--distance", "8"};
    Words first = common;
    first.insert(first.end(), {"--background", "0.5,0.25,2"});
    // The plate is a picture of one colour: what the first shows without object is what it shows.
    render(scratch,
           {"--probe", "builtin:furnace", "--eye", "0,9,0", "--target", "0,19,0", "--up", "0,0,1",
            "--background", "0.5,0.25,2", "--size", "40x30"},
           "plate.exr");
    Words second(common.begin(), common.begin() + 9);
    second.insert(second.end(), {"--samples", "4", "--distance", "8", "--plate", "plate.exr"});
    EXPECT_EQ(render(scratch, first).pixels, render(scratch, second, "p.exr").pixels);
}

// What a compositor needs beside the finished picture: alpha as without the background, in a layer
// of its own, since the picture is whole. PNG has no layers.
TEST(RenderLights, PlatesExrHasTheMatteInALayer) {
    const Scratch scratch;
    const Words common{"--probe", "builtin:sky", "--object", "torus",      "--shader",
                       "lambert", "--lights",    "60",       "--ground",   "--elevation",
                       "30",      "--samples",   "4",        "--distance", "8",
                       "--size",  "40x30"};
    const auto with = [&](const Words& more, const std::string& out) {
        Words words = common;
        words.insert(words.end(), more.begin(), more.end());
        return render(scratch, words, out);
    };
    const Image alone = with({"--background", "none"}, "none.exr");
    render(scratch, {"--probe", "builtin:compass", "--size", "40x30"}, "plate.exr");
    const Image finished = with({"--plate", "plate.exr"}, "plated.exr");
    const Image coded = with({"--plate", "plate.exr"}, "plated.png");
    EXPECT_EQ(finished.channels, 3);
    EXPECT_EQ(coded.channels, 3);
    const Image plate = readImage((scratch / "plate.exr").string()).image;
    const auto matteOf = [&](const std::string& name) {
        return readImage((scratch / name).string(), {"matte"}).image;
    };
    const Image matte = matteOf("plated.exr");
    int partial = 0, none = 0, full = 0;
    for (std::size_t i = 0; i < matte.pixels.size(); i += 3) {
        const float alpha = alone.pixels[i / 3 * 4 + 3];
        ASSERT_EQ(matte.pixels[i], alpha);
        partial += alpha > 0.05 && alpha < 0.95;
        full += alpha > 1 - 1e-6;
        if (alpha != 0) continue;
        ++none;
        for (std::size_t c = i; c < i + 3; ++c)
            ASSERT_EQ(finished.pixels[c], plate.pixels[c]);
    }
    EXPECT_GT(partial, 50);
    EXPECT_GT(none, 20);
    EXPECT_GT(full, 50);
    // Out of focus, too.
    const Image blurred = with({"--background", "none", "--aperture", "0.4"}, "blurred.exr");
    with({"--plate", "plate.exr", "--aperture", "0.4"}, "plated.exr");
    const Image soft = matteOf("plated.exr");
    for (std::size_t i = 0; i < soft.pixels.size(); i += 3)
        ASSERT_EQ(soft.pixels[i], blurred.pixels[i / 3 * 4 + 3]);
    EXPECT_NE(soft.pixels, matte.pixels);
}

TEST(RenderLights, SameBytesForAnyThreads) {
    const Scratch scratch;
    const auto run = [&](const char* threads) {
        return render(scratch, {"--probe", "builtin:sky", "--object", "torus", "--shader", "phong",
                                "--lights", "60", "--shadow-size", "64", "--ground", "--elevation",
                                "30", "--size", "32x32", "--samples", "2", "--threads", threads})
            .pixels;
    };
    EXPECT_EQ(run("1"), run("3"));
}

TEST(RenderLights, Refusals) {
    const Scratch scratch;
    const auto refused = [&](Words words, int code, const std::string& said) {
        words.insert(words.begin(), {"render", "-o", "o.png", "--size", "8x8", "--samples", "1"});
        if (std::ranges::find(words, "--probe") == words.end())
            words.insert(words.end(), {"--probe", "builtin:sky"});
        expectRefused(runTool(words, scratch.path()), code, said);
    };
    refused({"--shader", "phong"}, 1, "give --lights");
    refused({"--ground"}, 1, "give --lights");
    refused({"--lights", "16"}, 1, "not lit by lights");
    refused({"--lights", "16", "--shader", "diffuse"}, 1, "not lit by lights");
    refused({"--lights", "0", "--shader", "lambert"}, 1, "65536");
    refused({"--lights", "70000", "--shader", "lambert"}, 1, "65536");
    refused({"--lights", "99999999999", "--shader", "lambert"}, 1, "65536");
    refused({"--lights", "missing.json", "--shader", "lambert"}, 2, "missing.json");
    refused({"--lights", "16", "--light-method", "importance", "--shader", "lambert"}, 1,
            "--light-method");
    refused({"--ground-height", "-2"}, 1, "--ground");
    refused({"--ground-albedo", "0.5,0.5,0.5"}, 1, "--ground");
    refused({"--plate", "p.exr"}, 1, "--ground");
    refused({"--lights", "4", "--ground", "--ground-albedo", "1.5,0,0"}, 1, "--ground-albedo");
    refused({"--lights", "4", "--ground", "--ground-albedo", "0.5,0.5,0.5", "--background", "none"},
            1, "alpha");
    refused({"--lights", "4", "--ground", "--ground-height", "-0.5"}, 1, "cuts the object");
    refused({"--lights", "4", "--ground", "--elevation", "-40"}, 1, "below the ground");
    refused({"--lights", "4", "--ground", "--plate", "p.exr", "--background", "none"}, 1,
            "--background");
    refused({"--lights", "4", "--ground", "--plate", "missing.exr"}, 2, "missing.exr");
    refused({"--lights", "4", "--ground", "--shadow-size", "8"}, 1, "--shadow-size");
    refused({"--shader", "phong", "--lights", "4", "--sigma", "3"}, 1, "oren-nayar");
    refused({"--shader", "phong", "--lights", "4", "--exponent", "0"}, 1, "--exponent");
    refused({"--shader", "ward", "--lights", "4", "--alpha-u", "0"}, 1, "--alpha-u");
    const auto file = [&](const std::string& light, const std::string& said) {
        writeFile(scratch / "l.json", R"({"lights": [)" + light + "]}");
        refused({"--lights", "l.json", "--shader", "lambert"}, 2, said);
    };
    file("", "no lights");
    file("3", "light 0");
    file(R"({"direction": [0, 1, 0]})", "has no irradiance");
    file(R"({"direction": [0, 2, 0], "irradiance": [1, 1, 1]})", "length 1");
    file(R"({"direction": [0, 1, 0], "irradiance": [1, 1, 1e39]})", "finite");
    file(R"({"type": "area"})", "unknown type");
    file(R"({"type": "point", "intensity": [1, 1, 1]})", "has no position");
    file(R"({"type": "spot", "position": [0, 3, 0], "intensity": [1, 1, 1], "direction": [0, -1, 0],
             "inner_cone": 30, "outer_cone": 20})",
         "inner_cone < outer_cone");
    writeFile(scratch / "l.json", "{\"lights\": 3}");
    refused({"--lights", "l.json", "--shader", "lambert"}, 2, "is no JSON of lights");
    refused({"--lights", "l.json", "--light-method", "median", "--shader", "lambert"}, 1,
            "--light-method");
    EXPECT_EQ(scratch.names(), Words{"l.json"});
    for (const char* colour : {"0,0,0", "-1,-1,-1"}) {
        runProgram({"oiiotool", "--pattern", std::string("constant:color=") + colour, "16x8", "3",
                    "-d", "float", "-o", "dark.exr"},
                   scratch.path());
        refused({"--probe", "dark.exr", "--shader", "lambert", "--lights", "4"}, 2,
                "no luminance above 0");
    }
}

} // namespace
} // namespace ibl
