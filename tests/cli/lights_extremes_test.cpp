// The sun, black probes and bad pixels.
#include "cli/lights_of.h"

#include <gtest/gtest.h>

namespace ibl {
namespace {

using Json = nlohmann::json;

TEST(Lights, SunAndResidualAddUpToTheProbe) {
    const Scratch scratch;
    const Json sun = lightsOf({"builtin:sky", "--sun", "--residual", "rest.exr"}, scratch);
    ASSERT_EQ(sun.at("lights").size(), 1u);
    const auto energy = [&](const char* probe) {
        return Json::parse(runTool({"info", "--json", probe}, scratch.path()).out).at("energy");
    };
    const Json whole = energy("builtin:sky"), rest = energy("rest.exr");
    for (int c = 0; c < 3; ++c) {
        const double total = whole[c];
        const double light = sun["lights"][0]["irradiance"][c];
        EXPECT_NEAR(light + rest[c].get<double>(), total, 1e-6 * total);
        EXPECT_GT(light, 0.1 * total);
    }
    for (const char* probe : {"builtin:compass", "builtin:furnace"}) {
        expectRefused(runTool({"lights", probe, "--sun", "--residual", "no.exr"}, scratch.path()),
                      2, "no sun or lamp");
    }
    EXPECT_FALSE(std::filesystem::exists(scratch / "no.exr"));
}

TEST(Lights, NoSunSaysByHowMuch) {
    const Scratch scratch;
    expectRefused(runTool({"lights", "builtin:furnace", "--sun"}, scratch.path()), 2,
                  "the brightest pixel is 1 times its surroundings, 20 are needed");
}

TEST(Lights, FewerThanAskedSaysWhy) {
    const Scratch scratch;
    const auto said = [&](const std::string& rest, const std::string& peak, const char* method) {
        runProgram({"oiiotool", "--pattern", "constant:color=" + rest, "16x8", "3",
                    "--fill:color=" + peak, "1x1+5+3", "-d", "float", "-o", "p.exr"},
                   scratch.path());
        const ToolResult result =
            runTool({"lights", "p.exr", "-n", "9", "--method", method}, scratch.path());
        EXPECT_EQ(result.exit_code, 0);
        EXPECT_EQ(Json::parse(result.out).at("lights").size(), 1u);
        return result.err;
    };
    for (const char* method : {"median", "variance"}) {
        EXPECT_NE(
            said("0,0,0", "1,1,1", method).find("only 1 of 9 lights: no more pixels have energy"),
            std::string::npos);
        EXPECT_NE(said("0.5,0.5,0.5", "3e38,3e38,3e38", method)
                      .find("only 1 of 9 lights: each other pixel has less than 2e-19 of the"),
                  std::string::npos);
    }
}

TEST(Lights, BlackProbeSaysSo) {
    const Scratch scratch;
    runProgram({"oiiotool", "--pattern", "constant:color=0,0,0", "16x8", "3", "-d", "float", "-o",
                "black.exr"},
               scratch.path());
    for (const char* method : {"median", "variance", "importance"}) {
        const ToolResult result =
            runTool({"lights", "black.exr", "--method", method}, scratch.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
        EXPECT_NE(result.err.find("black: no lights"), std::string::npos);
        EXPECT_TRUE(Json::parse(result.out).at("lights").empty());
    }
    runProgram({"oiiotool", "--pattern", "constant:color=-1,-1,-1", "16x8", "3", "-d", "float",
                "-o", "negative.exr"},
               scratch.path());
    EXPECT_NE(runTool({"lights", "negative.exr"}, scratch.path())
                  .err.find("no luminance above 0: no lights"),
              std::string::npos);
    for (const char* probe : {"black.exr", "negative.exr"})
        expectRefused(runTool({"lights", probe, "--sun"}, scratch.path()), 2,
                      "no luminance above 0");
}

TEST(Lights, BadPixelsAreRefusedOrMended) {
    const Scratch scratch;
    runTool({"convert", "builtin:furnace", "--to", "latlong", "--size", "16", "--compression",
             "none", "-o", "good.exr"},
            scratch.path());
    const auto make = [&](const std::string& value) {
        // The last float of the file is the last pixel's red (channels are stored B, G, R).
        std::string bytes = readFile(scratch / "good.exr");
        bytes.replace(bytes.size() - 4, 4, value);
        writeFile(scratch / "bad.exr", bytes);
    };
    const Json good = lightsOf({"good.exr", "-n", "16"}, scratch);
    for (const std::string& value : {std::string("\0\0\xc0\x7f", 4),    // NaN
                                     std::string("\0\0\x80\x7f", 4)}) { // infinity
        make(value);
        for (const char* method : {"median", "variance", "importance"}) {
            expectRefused(
                runTool({"lights", "bad.exr", "--method", method, "-o", "no.json"}, scratch.path()),
                2, "--repair");
        }
        EXPECT_FALSE(std::filesystem::exists(scratch / "no.json"));
        const Json mended = lightsOf({"bad.exr", "-n", "16", "--repair"}, scratch);
        EXPECT_EQ(mended.at("lights"), good.at("lights"));
    }
    make(std::string("\0\0\x48\xc2", 4)); // -50
    const ToolResult kept = runTool({"lights", "bad.exr", "-n", "16"}, scratch.path());
    EXPECT_EQ(kept.exit_code, 0);
    EXPECT_NE(kept.err.find("1 negative pixel"), std::string::npos) << kept.err;
    EXPECT_LT(Json::parse(kept.out).at("total_irradiance")[0].get<double>(),
              good.at("total_irradiance")[0].get<double>());
}

TEST(Lights, ARadianceFilesExposureMayMakeInfinity) {
    // Without one its pixels are not looked at: none can be bad.
    const Scratch scratch;
    const std::string pixels(8, '\xff');
    const auto probe = [&](const std::string& lines) {
        writeFile(scratch / "e.hdr",
                  "#?RADIANCE\n" + lines + "FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + pixels);
        return runTool({"lights", "e.hdr", "-n", "2"}, scratch.path());
    };
    EXPECT_EQ(probe("").exit_code, 0);
    expectRefused(probe("EXPOSURE=1e-6\n"), 2, "2 infinite");
    expectRefused(probe("COLORCORR=1 1e-6 1\n"), 2, "2 infinite");
}

} // namespace
} // namespace ibl
