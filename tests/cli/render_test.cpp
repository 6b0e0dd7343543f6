#include "cli/tool.h"

#include "image/read.h"
#include "image/write.h"
#include "panorama/builtin.h"
#include "panorama/lookup.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace ibl {
namespace {

using Words = std::vector<std::string>;

Image render(const Scratch& scratch, Words words, const std::string& out = "o.exr") {
    words.insert(words.begin(), "render");
    words.insert(words.end(), {"-o", out});
    const ToolResult result = runTool(words, scratch.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    ReadOptions options;
    options.keep_alpha = true;
    return readImage((scratch / out).string(), options).image;
}

V3d pixel(const Image& image, int x, int y) {
    const float* rgb = image.at(x, y);
    return {rgb[0], rgb[1], rgb[2]};
}

TEST(Render, MirrorAndBackgroundAreTheProbeLookedUp) {
    const Scratch scratch;
    const Panorama sky = builtinProbe("builtin:sky");
    const int size = 64;
    const double fov = 40, distance = 4;
    const Image frame = render(scratch, {"--probe", "builtin:sky", "--azimuth", "30", "--elevation",
                                         "20", "--size", "64x64", "--samples", "1"});
    // The camera and the sphere in plain vector algebra.
    const double az = 30 * kPi / 180, el = 20 * kPi / 180;
    const V3d back(std::cos(el) * std::sin(az), std::sin(el), std::cos(el) * std::cos(az));
    const V3d eye = back * distance;
    const V3d right = V3d(0, 1, 0).cross(back).normalized();
    const V3d up = back.cross(right);
    const double half = std::tan(0.5 * fov * kPi / 180);
    double error = 0, reference = 0;
    int mirrored = 0;
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            V3d ray = -back + right * (half * (2 * (x + 0.5) / size - 1)) -
                      up * (half * (2 * (y + 0.5) / size - 1));
            ray.normalize();
            const double b = eye.dot(ray), disc = b * b - (eye.length2() - 1);
            if (std::abs(disc) < 0.4) continue; // near the silhouette a pixel sees half the probe
            if (disc > 0) {
                const V3d normal = eye + ray * (-b - std::sqrt(disc));
                ray -= normal * (2 * ray.dot(normal));
                ++mirrored;
            }
            // The sun's own pixels are compared by the finer unit tests.
            const V3d expected = radianceAt(sky, ray);
            if (expected.y > 20) continue;
            error += (pixel(frame, x, y) - expected).length2();
            reference += expected.length2();
        }
    }
    EXPECT_GT(mirrored, 300);
    EXPECT_LT(std::sqrt(error / reference), 0.01);
}

TEST(Render, FurnaceIsOneForEveryShaderAndObject) {
    const Scratch scratch;
    for (const char* object :
         {"sphere", "cube", "torus", "teapot", "dodecahedron", "cone", "plane"}) {
        for (const char* shader :
             {"mirror", "diffuse", "mirror-diffuse", "glass", "dispersion", "coat", "ggx"}) {
            const Image frame =
                render(scratch, {"--probe", "builtin:furnace", "--object", object, "--shader",
                                 shader, "--size", "24x24", "--samples", "4"});
            for (const float v : frame.pixels) {
                ASSERT_NEAR(v, 1, 1e-5) << object << " " << shader;
            }
        }
    }
}

TEST(Render, ModelsOnlyWhatTheMaterialRequires) {
    const Scratch scratch;
    struct Case {
        Words words;
        std::vector<std::string> kernels; ///< of the maps that are convolved
        std::vector<std::string> stages;  ///< and what else is computed
    };
    const std::vector<Case> cases{
        {{"--shader", "mirror"}, {}, {"read"}},
        {{"--shader", "glass"}, {}, {"read"}},
        {{"--shader", "diffuse"}, {"lambert"}, {"read", "convolve"}},
        {{"--shader", "coat"}, {"lambert"}, {"read", "convolve"}},
        {{"--shader", "ggx"}, {"ggx", "lambert"}, {"read", "convolve", "split-sum"}},
        {{"--shader", "ggx", "--metallic", "1"}, {"ggx"}, {"read", "convolve", "split-sum"}},
        {{"--shader", "ggx", "--metallic", "1", "--samples-specular", "4"}, {}, {"read", "levels"}},
        {{"--shader", "diffuse", "--diffuse-map", "builtin:sky", "--background", "none"},
         {},
         {"read"}},
    };
    for (const Case& c : cases) {
        Words words{"--probe", "builtin:furnace", "--size", "8x8", "--report", "r.json"};
        words.insert(words.end(), c.words.begin(), c.words.end());
        render(scratch, words);
        const auto report = nlohmann::json::parse(readFile(scratch / "r.json"));
        std::vector<std::string> kernels, stages;
        for (const auto& map : report["results"].value("maps", nlohmann::json::array()))
            kernels.push_back(map["kernel"]);
        for (const char* stage : {"read", "convolve", "split-sum", "levels"})
            if (report["seconds"].contains(stage)) stages.emplace_back(stage);
        EXPECT_EQ(kernels, c.kernels) << c.words[1];
        EXPECT_EQ(stages, c.stages) << c.words[1];
    }
}

// Constant maps of another value than the probe's show that they, not the probe, are read.
TEST(Render, TakesMapsBakedEarlier) {
    const Scratch scratch;
    Image half(8, 4);
    for (float& v : half.pixels)
        v = 0.5f;
    OutputSet outputs;
    writeImage(outputs, (scratch / "half.exr").string(), half);
    outputs.commit();
    for (const Words& words :
         {Words{"diffuse", "half.exr", "--size", "4", "-o", "d.exr"},
          Words{"specular", "half.exr", "--levels", "4", "--size", "16", "-o", "s.exr"}}) {
        const ToolResult made = runTool(words, scratch.path());
        ASSERT_EQ(made.exit_code, 0) << made.err;
    }
    const auto middle = [&](Words words) {
        words.insert(words.end(),
                     {"--probe", "builtin:furnace", "--size", "9x9", "--background", "none"});
        return render(scratch, words).at(4, 4)[0];
    };
    EXPECT_NEAR(middle({"--shader", "diffuse", "--diffuse-map", "d.exr"}), 0.5, 1e-5);
    for (const char* roughness : {"0", "0.4", "1"}) {
        EXPECT_NEAR(middle({"--shader", "ggx", "--metallic", "1", "--roughness", roughness,
                            "--specular-map", "s.exr"}),
                    0.5, 1e-4);
    }
    const auto refused = [&](Words words, int code, const std::string& said) {
        words.insert(words.begin(), {"render", "--probe", "builtin:furnace", "-o", "q.exr"});
        expectRefused(runTool(words, scratch.path()), code, said);
    };
    refused({"--diffuse-map", "d.exr"}, 1, "--diffuse-map");
    refused({"--shader", "diffuse", "--specular-map", "s.exr"}, 1, "--specular-map");
    refused({"--shader", "diffuse", "--diffuse-map", "none.exr"}, 2, "none.exr");
    refused({"--shader", "ggx", "--specular-map", "d.exr"}, 2, "specular --levels");
}

TEST(Render, OwnShaders) {
    const Scratch scratch;
    writeFile(scratch / "own.frag", "uniform float roughness;\n"
                                    "vec3 shade(vec3 normal, vec3 incident) {\n"
                                    "    return roughness * probeRadiance(normal);\n}\n");
    const Image frame = render(scratch, {"--probe", "builtin:furnace", "--size", "9x9", "--shader",
                                         "own.frag", "--roughness", "0.25", "--depfile", "o.d"});
    EXPECT_NEAR(frame.at(4, 4)[0], 0.25, 1e-6);
    EXPECT_EQ(readFile(scratch / "o.d"), "o.exr: own.frag\n");
    const auto refused = [&](Words words, int code, const std::string& said) {
        words.insert(words.begin(), {"render", "--probe", "builtin:furnace", "-o", "q.exr"});
        expectRefused(runTool(words, scratch.path()), code, said);
    };
    refused({"--shader", "own.frag", "--metallic", "1"}, 1, "metallic");
    refused({"--shader", "missing.frag"}, 2, "missing.frag");
    writeFile(scratch / "none.frag", "// nothing\n");
    refused({"--shader", "none.frag"}, 2, "shade(vec3 normal");
    writeFile(scratch / "bad.frag", "\nvec3 shade(vec3 n, vec3 i) { return what; }\n");
    refused({"--shader", "bad.frag"}, 2, "bad.frag:2: ");
}

TEST(Render, PngIsTheSrgbOfTheLinearFrame) {
    const Scratch scratch;
    const Words words{"--probe", "builtin:sky", "--size", "40x30",     "--samples",
                      "4",       "--exposure",  "-1",     "--tonemap", "scurve"};
    const Image linear = render(scratch, words);
    const Image png = render(scratch, words, "o.png");
    ASSERT_EQ(png.width, 40);
    ASSERT_EQ(png.height, 30);
    const auto encode = [](double v) {
        v = std::min(std::max(v, 0.0), 1.0);
        return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
    };
    for (std::size_t i = 0; i < png.pixels.size(); ++i) {
        ASSERT_NEAR(255 * encode(png.pixels[i]), 255 * encode(linear.pixels[i]), 0.51);
    }
}

TEST(Render, NoBackgroundHasAlpha) {
    const Scratch scratch;
    const Image frame = render(scratch, {"--probe", "builtin:furnace", "--background", "none",
                                         "--size", "32x32", "--samples", "16"});
    ASSERT_EQ(frame.channels, 4);
    EXPECT_EQ(frame.at(0, 0)[3], 0.f);
    EXPECT_EQ(frame.at(0, 0)[0], 0.f);
    EXPECT_EQ(frame.at(16, 16)[3], 1.f);
    bool edge = false;
    for (int i = 0; i < 32 * 32; ++i) {
        const float* p = &frame.pixels[static_cast<std::size_t>(i) * 4];
        EXPECT_NEAR(p[0], p[3], 1e-5); // premultiplied white
        edge = edge || (p[3] > 0.1f && p[3] < 0.9f);
    }
    EXPECT_TRUE(edge);
}

TEST(Render, BackgroundColourAndImage) {
    const Scratch scratch;
    const Image colour = render(
        scratch, {"--probe", "builtin:furnace", "--background", "0.25,0.5,2", "--size", "16x16"});
    EXPECT_EQ(pixel(colour, 0, 0), V3d(0.25, 0.5, 2));
    const Image plate =
        render(scratch, {"--probe", "builtin:furnace", "--background", "o.exr", "--size", "16x16"},
               "p.exr");
    EXPECT_EQ(pixel(plate, 0, 0), V3d(0.25, 0.5, 2));
    expectRefused(runTool({"render", "--probe", "builtin:furnace", "--background", "o.exr",
                           "--size", "17x16", "-o", "q.exr"},
                          scratch.path()),
                  2, "the picture of 17x16");
}

TEST(Render, ObjFilesAreDrawn) {
    const Scratch scratch;
    writeFile(scratch / "t.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n");
    const Image frame =
        render(scratch, {"--probe", "builtin:furnace", "--object", "t.obj", "--background", "0,0,0",
                         "--size", "32x32", "--depfile", "o.d"});
    EXPECT_NEAR(frame.at(16, 16)[0], 1, 1e-5);
    EXPECT_EQ(frame.at(1, 1)[0], 0.f);
    EXPECT_EQ(readFile(scratch / "o.d"), "o.exr: t.obj\n");
}

TEST(Render, FramesAreTheBytesOfSeparateRuns) {
    const Scratch scratch;
    const Words shared{"render",         "--probe", "builtin:sky", "--object",  "cube", "--shader",
                       "mirror-diffuse", "--size",  "40x30",       "--samples", "2"};
    const auto run = [&](const Words& more) {
        Words words = shared;
        words.insert(words.end(), more.begin(), more.end());
        const ToolResult result = runTool(words, scratch.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
    };
    for (const char* threads : {"1", "5"}) {
        run({"--frames",       "7-10",      "--azimuth",  "0..90",       "--yaw",
             "30..-60",        "--rotate",  "0,10..40,0", "--translate", "0,0,0..0.75",
             "--reflectivity", "0.25..1",   "--threads",  threads,       "--report",
             "r.json",         "--depfile", "d",          "-o",          "f.%03d.png"});
        for (int k = 0; k < 4; ++k) {
            const auto number = [](double v) { return std::to_string(v); };
            run({"--azimuth", number(30 * k), "--yaw", number(30 - 30 * k), "--rotate",
                 "0," + number(10 + 10 * k) + ",0", "--translate", "0,0," + number(0.25 * k),
                 "--reflectivity", number(0.25 + 0.25 * k), "-o", "one.png"});
            char name[16];
            std::snprintf(name, sizeof name, "f.%03d.png", 7 + k);
            EXPECT_TRUE(readFile(scratch / name) == readFile(scratch / "one.png")) << name;
        }
        EXPECT_FALSE(readFile(scratch / "f.007.png") == readFile(scratch / "f.008.png"));
    }
    EXPECT_EQ(readFile(scratch / "d"), "f.007.png f.008.png f.009.png f.010.png:\n");
    const auto report = nlohmann::json::parse(readFile(scratch / "r.json"));
    ASSERT_EQ(report["results"]["frames"].size(), 4u);
    EXPECT_EQ(report["results"]["frames"][3]["frame"], 10);
}

TEST(Render, FramesAdaptAsRunsThatHandTheirStateOn) {
    const Scratch scratch;
    const auto run = [&](Words words) {
        words.insert(words.begin(), {"render", "--size", "24x16", "--samples", "1", "--exposure",
                                     "auto", "--adapt", "2", "--distance", "3"});
        const ToolResult result = runTool(words, scratch.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
    };
    // Probes of the frame's name: from dark to bright.
    render(scratch, {"--probe", "builtin:furnace", "--exposure", "-6", "--size", "16x8"}, "p1.exr");
    render(scratch, {"--probe", "builtin:furnace", "--exposure", "4", "--size", "16x8"}, "p2.exr");
    render(scratch, {"--probe", "builtin:furnace", "--exposure", "4", "--size", "16x8"}, "p3.exr");
    run({"--probe", "p%d.exr", "--frames", "1-3", "-o", "f%d.exr"});
    for (const char* k : {"1", "2", "3"}) {
        run({"--probe", std::string("p") + k + ".exr", "--adapt-state", "s.json", "-o", "one.exr"});
        EXPECT_TRUE(readFile(scratch / (std::string("f") + k + ".exr")) ==
                    readFile(scratch / "one.exr"))
            << k;
    }
}

TEST(Render, FramesBeforeAFailureStay) {
    const Scratch scratch;
    writeFile(scratch / "t1.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n");
    writeFile(scratch / "t3.obj", "f 1 2 3\n");
    std::filesystem::copy_file(scratch / "t1.obj", scratch / "t2.obj");
    expectRefused(
        runTool({"render", "--probe", "builtin:furnace", "--object", "t%d.obj", "--frames", "1-4",
                 "--size", "16x16", "-o", "f%d.png", "--report", "r.json"},
                scratch.path()),
        2, "t3.obj");
    EXPECT_EQ(scratch.names(), (Words{"f1.png", "f2.png", "t1.obj", "t2.obj", "t3.obj"}));
}

TEST(Render, FocalLengthIsOfTheSensorsWidth) {
    const Scratch scratch;
    // A 36 mm wide sensor behind 18 mm sees 90 degrees across; at 2:1, 2 atan(1/2) upwards.
    const Words words{"--probe", "builtin:sky", "--size", "64x32", "--samples", "1"};
    Words focal = words, fov = words;
    focal.insert(focal.end(), {"--focal-length", "18"});
    fov.insert(fov.end(), {"--fov", "53.13010235415598"});
    const Image a = render(scratch, focal), b = render(scratch, fov);
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        ASSERT_NEAR(a.pixels[i], b.pixels[i], 1e-3 * (1 + b.pixels[i]));
}

TEST(Render, BaseTextureOfIntegersIsDecoded) {
    const Scratch scratch;
    // All linear 0.5: a background, and a camera that sees nothing else.
    render(scratch,
           {"--probe", "builtin:furnace", "--background", "0.5,0.5,0.5", "--eye", "0,0,9",
            "--target", "0,0,18", "--size", "16x8"},
           "grey.png");
    for (const char* object : {"sphere", "cube", "cylinder", "torus", "teapot", "plane"}) {
        const Image frame =
            render(scratch, {"--probe", "builtin:furnace", "--base-texture", "grey.png", "--object",
                             object, "--elevation", "30", "--background", "0,0,0", "--size",
                             "32x32", "--samples", "1"});
        float largest = 0;
        for (const float v : frame.pixels)
            largest = std::max(largest, v);
        EXPECT_NEAR(largest, 0.5, 0.005) << object;
    }
}

TEST(Render, AovsAreLayersOfTheExr) {
    const Scratch scratch;
    render(scratch, {"--probe", "builtin:furnace", "--size", "17x17", "--type", "half", "--aov",
                     "normal,depth,id"});
    const ToolResult info = runProgram({"oiiotool", "--info", "-v", "o.exr"}, scratch.path());
    for (const char* name :
         {"R (half)", "normal.X (float)", "normal.Z (float)", "depth.Z (float)", "id (float)"}) {
        EXPECT_NE(info.out.find(name), std::string::npos) << info.out;
    }
    const auto centre = [&](const std::string& channel) {
        const ToolResult cut =
            runProgram({"oiiotool", "o.exr", "--ch", channel, "--cut", "1x1+8+8", "--printstats"},
                       scratch.path());
        return cut.out;
    };
    EXPECT_NE(centre("depth.Z").find("Avg: 3.0"), std::string::npos) << centre("depth.Z");
    EXPECT_NE(centre("normal.Z").find("Avg: 1.0"), std::string::npos) << centre("normal.Z");
}

TEST(Render, NoDeviceIsExitThreeAndNamesThePackages) {
    const Scratch scratch;
    // No vendor's driver is found in an empty folder.
    expectRefused(runTool({"render", "--probe", "builtin:furnace", "-o", "o.png"}, scratch.path(),
                          {}, {"__EGL_VENDOR_LIBRARY_DIRS=" + scratch.path().string()}),
                  3, "libgl1-mesa-dri");
    EXPECT_TRUE(scratch.names().empty());
}

TEST(Render, NeedsNoDisplay) {
    const Scratch scratch;
    const ToolResult result = runTool(
        {"render", "--probe", "builtin:furnace", "-o", "o.png", "--size", "8x8", "--verbose"},
        scratch.path(), {}, {"DISPLAY=", "WAYLAND_DISPLAY=", "XDG_RUNTIME_DIR="});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("device: "), std::string::npos) << result.err;
}

TEST(Render, DepthOfFieldBlursWhatIsOutOfFocus) {
    const Scratch scratch;
    const auto drawn = [&](const char* name, std::vector<std::string> more) {
        std::vector<std::string> words{"render", "--probe", "builtin:compass",
                                       "--size", "96x64",   "--samples",
                                       "4",      "-o",      name};
        words.insert(words.end(), more.begin(), more.end());
        const ToolResult result = runTool(words, scratch.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return readImage((scratch / name).string()).image;
    };
    const auto steps = [](const Image& picture) { // between neighbours in the upper row
        double sum = 0;
        for (int x = 1; x < picture.width; ++x)
            sum += std::abs(picture.at(x, 0)[0] - picture.at(x - 1, 0)[0]);
        return sum;
    };
    const Image sharp = drawn("s.exr", {}), blurred = drawn("b.exr", {"--aperture", "0.3"});
    EXPECT_LT(steps(blurred), 0.8 * steps(sharp));
    // In focus the middle of the sphere, 3 away, stays as it is.
    const Image focused = drawn("f.exr", {"--aperture", "0.02", "--focus", "3"});
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(focused.at(48, 32)[c], sharp.at(48, 32)[c], 1e-5);
    for (const auto& bad :
         std::vector<std::vector<std::string>>{{"--focus", "3"},
                                               {"--aperture", "0", "--focus", "3"},
                                               {"--aperture", "-1"},
                                               {"--aperture", "1", "--focus", "0"},
                                               {"--aperture", "1000"}}) {
        std::vector<std::string> words{"render", "--probe", "builtin:sky", "--size",
                                       "64x64",  "-o",      "bad.exr"};
        words.insert(words.end(), bad.begin(), bad.end());
        EXPECT_EQ(runTool(words, scratch.path()).exit_code, 1) << bad[0];
        EXPECT_FALSE(std::filesystem::exists(scratch / "bad.exr"));
    }
}

} // namespace
} // namespace ibl
