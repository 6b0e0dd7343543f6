#include "cli/tool.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>

namespace ibl {
namespace {

using Json = nlohmann::json;

TEST(Info, TellsTheFurnace) {
    const Scratch scratch;
    const Json info =
        Json::parse(runTool({"info", "--json", "builtin:furnace"}, scratch.path()).out);
    EXPECT_EQ(info.at("layout"), "latlong");
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(info.at("energy")[c].get<double>(), 4 * std::acos(-1.0), 1e-9);
        EXPECT_NEAR(info.at("mean_radiance")[c].get<double>(), 1, 1e-12);
    }
    EXPECT_EQ(info.at("nan").at("count"), 0);
    EXPECT_EQ(info.at("negative").at("count"), 0);
}

TEST(Info, ReportsExposure) {
    const Scratch scratch;
    const std::string pixel = "\x80\x80\x80\x81"; // 128 * 2^(129-136) = 1
    writeFile(scratch / "e.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=4\nEXPOSURE=0.5\n"
                                 "COLORCORR=1 2 4\n\n-Y 1 +X 2\n" +
                                     pixel + pixel);
    const ToolResult result = runTool({"info", "e.hdr"}, scratch.path());
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.err.find("EXPOSURE"), std::string::npos) << result.err;
    const Json info = Json::parse(runTool({"info", "--json", "e.hdr"}, scratch.path()).out);
    EXPECT_EQ(info.at("exposure"), 2.0);
    EXPECT_EQ(info.at("maximum"), Json::array({0.5, 0.25, 0.125}));
}

TEST(Info, TextNamesTheBrightestPixel) {
    const Scratch scratch;
    const ToolResult result = runTool({"info", "builtin:sky"}, scratch.path());
    EXPECT_EQ(result.exit_code, 0);
    for (const char* word : {"layout", "latlong", "brightest", "energy", "NaN"}) {
        EXPECT_NE(result.out.find(word), std::string::npos) << word;
    }
}

} // namespace
} // namespace ibl
