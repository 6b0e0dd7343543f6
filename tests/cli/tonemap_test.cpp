#include "cli/tool.h"

#include "image/read.h"
#include "image/write.h"
#include "panorama/builtin.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

using Words = std::vector<std::string>;

Image toned(const Scratch& scratch, Words words, const std::string& out = "o.exr") {
    return pictureOf(scratch, "tonemap", std::move(words), out);
}

double luminance(const float* p) {
    return 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
}

/// Relative RMSE of `image` against what pfstools made of it, or of it in the middle of a larger
/// one; pixels that it made no number of (black ones, for instance) are left out.
double errorAgainst(const Image& theirs, const Image& image) {
    const int left = (theirs.width - image.width) / 2, top = (theirs.height - image.height) / 2;
    double error = 0, reference = 0;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const double expected = theirs.at(left + x, top + y)[c];
                if (!(expected < 60000)) continue;
                error += std::pow(image.at(x, y)[c] - expected, 2);
                reference += expected * expected;
            }
        }
    }
    return std::sqrt(error / reference);
}

/// The picture with its border going on for so many pixels on every side.
Image continued(const Image& image, int margin) {
    Image made(image.width + 2 * margin, image.height + 2 * margin);
    for (int y = 0; y < made.height; ++y) {
        for (int x = 0; x < made.width; ++x) {
            const float* from = image.at(std::clamp(x - margin, 0, image.width - 1),
                                         std::clamp(y - margin, 0, image.height - 1));
            std::copy_n(from, 3, made.at(x, y));
        }
    }
    return made;
}

double logAverage(const Image& image) {
    double logs = 0;
    for (std::size_t i = 0; i < image.pixels.size(); i += 3)
        logs += std::log(1e-5 + luminance(&image.pixels[i]));
    return std::exp(3 * logs / static_cast<double>(image.pixels.size()));
}

// Pictures whose log-average it takes with the same delta; its white is the greatest luminance.
// Outside its pictures are black, which brightens the borders of its local map by a few per cent;
// ours go on. So it is given a picture that does, whose own border is beyond the widest surround's
// reach, with the key and the phi that make the exposure and the contrasts those of the picture
// alone.
TEST(Tonemap, ReinhardAgreesWithPfstools) {
    const Scratch scratch;
    for (const std::string name : {"sky", "compass", "teapot"}) {
        const std::string file = name + ".hdr";
        Words make{"convert", "builtin:" + name, "--to", "latlong", "--size", "256", "-o", file};
        if (name == "teapot") {
            make = {"render", "--probe", "builtin:sky", "--object", name,
                    "--size", "320x240", "-o",          file};
        }
        ASSERT_EQ(runTool(make, scratch.path()).exit_code, 0);
        const Image image = readImage((scratch / file).string()).image;
        double largest = 0;
        for (std::size_t i = 0; i < image.pixels.size(); i += 3)
            largest = std::max(largest, luminance(&image.pixels[i]));
        const double white = 0.18 * largest / logAverage(image);
        const auto theirs = [&](const std::string& read, const std::string& options) {
            const ToolResult result = runProgram(
                {"sh", "-c", read + " | pfstmo_reinhard02 " + options + " | pfsoutexr theirs.exr"},
                scratch.path());
            EXPECT_EQ(result.exit_code, 0) << result.err;
            return readImage((scratch / "theirs.exr").string()).image;
        };
        const Image global = toned(scratch, {file, "--exposure", "auto", "--tonemap", "reinhard",
                                             "--white", std::to_string(white)});
        const double global_error = errorAgainst(theirs("pfsin " + file, ""), global);
        EXPECT_LT(global_error, 0.01) << name;
        RecordProperty(name + "_global", std::to_string(global_error));
        const Image larger = continued(image, 512); // a multiple of its coarsest samples' distance
        OutputSet outputs;
        writeImage(outputs, (scratch / "larger.exr").string(), larger);
        outputs.commit();
        const double key = 0.18 * logAverage(larger) / logAverage(image);
        const Image local =
            toned(scratch, {file, "--exposure", "auto", "--tonemap", "reinhard-local"});
        const double local_error = errorAgainst(
            theirs("pfsinexr larger.exr", "--scales --key " + std::to_string(key) + " --phi " +
                                              std::to_string(8 + std::log2(0.18 / key))),
            local);
        EXPECT_LT(local_error, 0.003) << name;
        RecordProperty(name + "_local", std::to_string(local_error));
    }
}

TEST(Tonemap, ReadsFilesBuiltInProbesAndStandardInput) {
    const Scratch scratch;
    writeFile(scratch / "g.exr", readFile(testData("gradient.exr")));
    const Image file = toned(scratch, {"g.exr", "--exposure", "1"});
    EXPECT_EQ(file.at(0, 0)[0], 0);
    EXPECT_NEAR(file.at(31, 0)[0], 8, 0.3);
    const ToolResult piped =
        runTool({"tonemap", "-", "--exposure", "1", "-o", "-", "--format", "exr"}, scratch.path(),
                readFile(testData("gradient.exr")));
    EXPECT_EQ(piped.exit_code, 0) << piped.err;
    EXPECT_EQ(piped.out, readFile(scratch / "o.exr"));
    EXPECT_EQ(toned(scratch, {"builtin:furnace"}).at(5, 5)[0], 1);
}

// What `render` writes beside the picture comes back by the names that its page gives.
TEST(Tonemap, ReadsTheLayersThatRenderWrites) {
    const Scratch scratch;
    ASSERT_EQ(runTool({"render", "--probe", "builtin:furnace", "--object", "sphere", "--size",
                       "9x9", "--aov", "normal,depth,id", "-o", "a.exr"},
                      scratch.path())
                  .exit_code,
              0);
    const auto middle = [&](const std::string& layer) {
        const Image image = toned(scratch, {"a.exr", "--layer", layer});
        const float* p = image.at(4, 4);
        return std::vector<float>{p[0], p[1], p[2]};
    };
    const std::vector<float> normal = middle("normal"), depth = middle("depth");
    // Unit, and towards the eye, which looks at the middle of the unit sphere.
    EXPECT_NEAR(std::hypot(normal[0], normal[1], normal[2]), 1, 1e-5);
    EXPECT_NE(normal[0], normal[2]);
    EXPECT_GT(depth[0], 1);
    EXPECT_LT(depth[0], 100);
    EXPECT_EQ(depth, middle("depth.Z"));
    EXPECT_EQ(middle("normal.Y"), std::vector<float>(3, normal[1]));
    EXPECT_EQ(middle("id"), std::vector<float>(3, 1));
    expectRefused(runTool({"tonemap", "a.exr", "--layer", "coat", "-o", "o.png"}, scratch.path()),
                  2, "there is depth, normal, id");
}

TEST(Tonemap, KeepsAlpha) {
    const Scratch scratch;
    writeFile(scratch / "a.exr", readFile(testData("alpha.exr")));
    const Image image = toned(scratch, {"a.exr", "--tonemap", "reinhard"});
    ASSERT_EQ(image.channels, 4);
    EXPECT_NEAR(image.at(3, 3)[3], 0.25, 1e-3);
    const ToolResult glow =
        runTool({"tonemap", "a.exr", "--bloom", "0.5", "-o", "b.png"}, scratch.path());
    expectRefused(glow, 1, "alpha");
}

TEST(Tonemap, AutoExposureBringsTheLogAverageToTheKey) {
    const Scratch scratch;
    writeFile(scratch / "g.exr", readFile(testData("gradient.exr")));
    for (const double key : {0.045, 0.18, 0.72}) {
        const Image image = toned(scratch, {"g.exr", "--exposure", "auto", "--key",
                                            std::to_string(key), "--delta", "1e-9"});
        double logs = 0;
        for (std::size_t i = 0; i < image.pixels.size(); i += 3)
            logs += std::log(luminance(&image.pixels[i]));
        EXPECT_NEAR(std::exp(logs / (32 * 16)) / key, 1, 1e-4);
    }
}

TEST(Tonemap, AdaptationIsCarriedBetweenProcesses) {
    const Scratch scratch;
    const auto frame = [&](const std::string& probe) {
        toned(scratch, {probe, "--exposure", "auto", "--adapt", "2", "--adapt-state", "s.json",
                        "--report", "r.json"});
        return nlohmann::json::parse(readFile(scratch / "r.json"))["results"];
    };
    writeFile(scratch / "g.exr", readFile(testData("gradient.exr")));
    const double bright = frame("builtin:furnace")["adapted_log_average"];
    EXPECT_NEAR(bright, 1, 1e-4);
    double seen = bright;
    for (int i = 1; i <= 4; ++i) {
        const auto results = frame("g.exr");
        const double now = results["log_average"];
        seen = results["adapted_log_average"];
        EXPECT_NEAR(std::log(seen / now), std::log(bright / now) * std::exp2(-i / 2.0), 1e-6);
    }
    EXPECT_NEAR(nlohmann::json::parse(readFile(scratch / "s.json"))["log_average"], seen, 1e-12);
    const auto refusedState = [&](const std::string& text) {
        writeFile(scratch / "s.json", text);
        expectRefused(runTool({"tonemap", "g.exr", "--exposure", "auto", "--adapt", "2",
                               "--adapt-state", "s.json", "-o", "n.exr"},
                              scratch.path()),
                      2, "s.json");
    };
    refusedState("");
    refusedState("{\"log_average\": -1}");
    refusedState("[1]");
}

TEST(Tonemap, BadPixelsAreRefusedOrMended) {
    const Scratch scratch;
    ASSERT_EQ(runProgram({"oiiotool", "--pattern", "constant:color=1,1,1", "8x4", "3",
                          "--point:color=nan,1,1", "3,2", "-d", "float", "-o", "n.exr"},
                         scratch.path())
                  .exit_code,
              0);
    expectRefused(runTool({"tonemap", "n.exr", "-o", "o.png"}, scratch.path()), 2, "--repair");
    const Image mended = toned(scratch, {"n.exr", "--repair"});
    EXPECT_EQ(mended.at(3, 2)[0], 1);
}

TEST(Tonemap, PngHasTheBitsThatAreAskedFor) {
    const Scratch scratch;
    writeFile(scratch / "g.exr", readFile(testData("gradient.exr")));
    const Image linear = toned(scratch, {"g.exr", "--tonemap", "reinhard"});
    const Image eight = toned(scratch, {"g.exr", "--tonemap", "reinhard"}, "8.png");
    const Image sixteen =
        toned(scratch, {"g.exr", "--tonemap", "reinhard", "--bits", "16"}, "16.png");
    const Image dithered = toned(scratch, {"g.exr", "--tonemap", "reinhard", "--dither"}, "d.png");
    double worst8 = 0, worst16 = 0;
    for (std::size_t i = 0; i < linear.pixels.size(); ++i) {
        const double light = std::min(linear.pixels[i], 1.0F);
        worst8 = std::max(worst8, std::abs(eight.pixels[i] - light));
        worst16 = std::max(worst16, std::abs(sixteen.pixels[i] - light));
    }
    EXPECT_LT(worst8, 0.005);
    EXPECT_GT(worst8, 1e-4);
    EXPECT_LT(worst16, 2e-5);
    EXPECT_FALSE(dithered.pixels == eight.pixels);
    toned(scratch, {"g.exr", "--tonemap", "reinhard", "--dither", "--threads", "1"}, "e.png");
    EXPECT_EQ(readFile(scratch / "d.png"), readFile(scratch / "e.png"));
}

// One line, of a picture or of all frames; silent where nothing clips, and with --quiet.
TEST(Tonemap, PngSaysHowMuchClips) {
    const Scratch scratch;
    writeFile(scratch / "g.exr", readFile(testData("gradient.exr")));
    const auto said = [&](Words words) {
        const ToolResult result = runTool(words, scratch.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return result.err;
    };
    const Image image = readImage((scratch / "g.exr").string()).image;
    int values = 0, pixels = 0;
    for (std::size_t i = 0; i < image.pixels.size(); i += 3) {
        const int above = (image.pixels[i] > 1) + (image.pixels[i + 1] > 1);
        values += above;
        pixels += above > 0;
    }
    char share[32];
    std::snprintf(share, sizeof share, "%.3g", 100.0 * pixels / 512);
    const std::string clipped = std::to_string(values) + " values above 1 were written as 1 (" +
                                share + " % of the pixels)";
    for (const char* bits : {"8", "16"}) {
        EXPECT_EQ(said({"tonemap", "g.exr", "--bits", bits, "-o", "o.png"}),
                  "ibltool: o.png: " + clipped + "; try --exposure auto\n");
    }
    EXPECT_EQ(said({"tonemap", "g.exr", "--quiet", "-o", "o.png"}), "");
    EXPECT_EQ(said({"tonemap", "g.exr", "--tonemap", "clamp", "-o", "o.png"}), "");
    EXPECT_EQ(said({"tonemap", "g.exr", "-o", "o.exr"}), "");
    const Words render{"render", "--probe", "builtin:furnace", "--size", "8x4", "--exposure", "1"};
    Words one = render, all = render;
    one.insert(one.end(), {"-o", "r.png"});
    all.insert(all.end(), {"--frames", "1-3", "-o", "r%d.png"});
    EXPECT_EQ(said(one), "ibltool: r.png: 96 values above 1 were written as 1 (100 % of the "
                         "pixels); try --exposure auto\n");
    EXPECT_EQ(said(all), "ibltool: r%d.png: 288 values above 1 were written as 1 (100 % of the "
                         "pixels); try --exposure auto\n");
}

TEST(Tonemap, RefusesWhatHasNoEffectOrNoSense) {
    const Scratch scratch;
    const auto refused = [&](Words words, int code, const std::string& said,
                             const std::string& out = "o.png") {
        words.insert(words.begin(), {"tonemap", "builtin:furnace", "-o", out});
        expectRefused(runTool(words, scratch.path()), code, said);
    };
    refused({"--tonemap", "magic"}, 1, "--tonemap");
    refused({"--exposure", "bright"}, 1, "--exposure");
    refused({"--exposure", "65"}, 1, "--exposure");
    refused({"--exposure", "nan"}, 1, "--exposure");
    refused({"--key", "0.18"}, 1, "--key");
    refused({"--exposure", "auto", "--key", "1"}, 1, "--key");
    refused({"--delta", "1"}, 1, "--delta");
    refused({"--exposure", "auto", "--adapt", "2"}, 1, "--adapt-state");
    refused({"--adapt", "2", "--adapt-state", "s"}, 1, "--adapt");
    refused({"--white", "4"}, 1, "--white");
    refused({"--tonemap", "scurve", "--rate", "4"}, 1, "--rate");
    refused({"--tonemap", "scurve", "--scurve-n", "0"}, 1, "--scurve-n");
    refused({"--tonemap", "aces", "--per", "luminance"}, 1, "--per");
    refused({"--tonemap", "retinex", "--retinex-scales", "2.5"}, 1, "--retinex-scales");
    refused({"--view", "x"}, 1, "--tonemap display");
    refused({"--tonemap", "display"}, 1, "PNG", "o.exr");
    refused({"--tonemap", "display", "--ocio-config", "missing.ocio"}, 2, "missing.ocio");
    refused({"--tonemap", "display", "--view", "x"}, 1, "$OCIO: is not set");
    refused({"--bits", "16"}, 1, "PNG", "o.exr");
    refused({"--bits", "12"}, 1, "--bits");
    refused({"--bloom", "1.5"}, 1, "--bloom");
    refused({"--bloom", "0.6", "--streaks", "0.6"}, 1, "weights");
    refused({"--bloom-radius", "0.1"}, 1, "--bloom");
    refused({"--threshold", "2"}, 1, "--threshold");
    EXPECT_TRUE(scratch.names().empty());
    expectRefused(runTool({"tonemap", "missing.exr", "-o", "o.png"}, scratch.path()), 2,
                  "missing.exr");
}

/// A makefile makes the picture anew when the config or a table that its view uses has changed.
TEST(Tonemap, DepfileNamesTheConfigAndItsTables) {
    const Scratch scratch;
    writeFile(scratch / "c.ocio", "ocio_profile_version: 2\n"
                                  "search_path: .\n"
                                  "roles: {scene_linear: lin, default: lin}\n"
                                  "displays:\n"
                                  "  D:\n"
                                  "    - !<View> {name: V, colorspace: out}\n"
                                  "colorspaces:\n"
                                  "  - !<ColorSpace>\n"
                                  "    name: lin\n"
                                  "  - !<ColorSpace>\n"
                                  "    name: out\n"
                                  "    from_scene_reference: !<FileTransform> {src: t.spi1d}\n");
    writeFile(scratch / "t.spi1d",
              "Version 1\nFrom 0 1\nLength 3\nComponents 1\n{\n0\n0.7\n1\n}\n");
    for (const bool by_environment : {false, true}) {
        Words words{"tonemap", "builtin:sky", "--tonemap", "display", "--depfile",
                    "d",       "--report",    "r.json",    "-o",      "o.png"};
        std::vector<std::string> environment;
        if (by_environment)
            environment.push_back("OCIO=" + (scratch / "c.ocio").string());
        else
            words.insert(words.end(), {"--ocio-config", "c.ocio"});
        const ToolResult result = runTool(words, scratch.path(), {}, environment);
        ASSERT_EQ(result.exit_code, 0) << result.err;
        EXPECT_NE(readFile(scratch / "d").find("c.ocio"), std::string::npos);
        EXPECT_NE(readFile(scratch / "d").find("t.spi1d"), std::string::npos);
    }
}

} // namespace
} // namespace ibl
