// Cameras, backgrounds and formats of render, as users call them.
#include "cli/render_support.h"

#include "panorama/builtin.h"
#include "panorama/lookup.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace ibl {
namespace {

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

TEST(Render, ADeviceThatIsNotThereIsAnsweredWithThoseThatAre) {
    const Scratch scratch;
    const Words words{"render", "--probe", "builtin:furnace", "-o", "o.png", "--size", "8x8"};
    const auto with = [&](const Words& more) {
        Words all = words;
        all.insert(all.end(), more.begin(), more.end());
        return runTool(all, scratch.path());
    };
    const std::string said = with({"--verbose"}).err;
    std::string names;
    int count = 0;
    for (;; ++count) {
        const std::string line = "EGL device " + std::to_string(count) + ": ";
        const std::size_t at = said.find(line);
        if (at == said.npos) break;
        const std::size_t begin = at + line.size();
        names += (count ? ", " : "") + std::to_string(count) + " (" +
                 said.substr(begin, said.find('\n', begin) - begin) + ")";
    }
    ASSERT_GT(count, 0) << said;
    const std::string there =
        count == 1 ? "is 1 device: " : "are " + std::to_string(count) + " devices: ";
    expectRefused(with({"--device", "63"}), 3,
                  "device 63 is not on this machine; there " + there + names + "\n");
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
