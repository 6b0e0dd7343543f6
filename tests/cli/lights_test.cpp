#include "cli/tool.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>

namespace ibl {
namespace {

using Json = nlohmann::json;

Json lightsOf(const std::vector<std::string>& arguments, const Scratch& scratch) {
    std::vector<std::string> words{"lights"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const ToolResult result = runTool(words, scratch.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out);
}

TEST(Lights, ColoursSumToTheProbesEnergy) {
    const Scratch scratch;
    for (const std::string probe : {"builtin:sky", "builtin:compass", "builtin:furnace"}) {
        const Json info = Json::parse(runTool({"info", "--json", probe}, scratch.path()).out);
        for (const char* count : {"1", "7", "64", "1000"}) {
            const Json lights = lightsOf({probe, "-n", count}, scratch);
            EXPECT_EQ(lights.at("lights").size(), std::stoul(count));
            for (int c = 0; c < 3; ++c) {
                double sum = 0;
                for (const Json& light : lights.at("lights")) {
                    sum += light.at("irradiance")[c].get<double>();
                }
                const double energy = info.at("energy")[c];
                EXPECT_NEAR(sum, energy, 1e-6 * energy) << probe << " " << count;
            }
        }
    }
}

TEST(Lights, FurnaceIsFourPi) {
    const Scratch scratch;
    const Json lights = lightsOf({"builtin:furnace", "-n", "16"}, scratch);
    const double four_pi = 4 * std::acos(-1.0);
    EXPECT_NEAR(lights.at("total_irradiance")[0].get<double>(), four_pi, 1e-6 * four_pi);
}

TEST(Lights, BrightestLightOfTheSkyIsTheSun) {
    const Scratch scratch;
    const Json info = Json::parse(runTool({"info", "--json", "builtin:sky"}, scratch.path()).out);
    const Json sun = lightsOf({"builtin:sky", "-n", "64"}, scratch).at("lights")[0];
    double cosine = 0;
    for (int c = 0; c < 3; ++c) {
        cosine += sun.at("direction")[c].get<double>() *
                  info.at("brightest").at("direction")[c].get<double>();
    }
    EXPECT_GT(cosine, std::cos(2.0 * std::acos(-1.0) / 180));
}

TEST(Lights, SameBytesForAnyThreadCount) {
    const Scratch scratch;
    const auto run = [&](const char* threads) {
        return runTool({"lights", "builtin:sky", "-n", "100", "--threads", threads}, scratch.path())
            .out;
    };
    EXPECT_EQ(run("1"), run("3"));
}

TEST(Lights, WritesToAFile) {
    const Scratch scratch;
    const ToolResult result =
        runTool({"lights", "builtin:sky", "-o", "l.json", "--depfile", "l.d"}, scratch.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_EQ(Json::parse(readFile(scratch / "l.json")).at("lights").size(), 64u);
    EXPECT_EQ(readFile(scratch / "l.d"), "l.json:\n");
}

TEST(Lights, Refusals) {
    const Scratch scratch;
    const auto refused = [&](std::vector<std::string> words, const std::string& said) {
        words.insert(words.begin(), "lights");
        expectRefused(runTool(words, scratch.path()), 1, said);
    };
    refused({"builtin:sky", "-n", "0"}, "--count");
    refused({"builtin:sky", "-n", "65537"}, "--count");
    refused({"builtin:sky", "-n", "many"}, "--count");
    refused({"builtin:sky", "--method", "best"}, "--method");
    refused({}, "IN");
    EXPECT_TRUE(scratch.names().empty());
}

} // namespace
} // namespace ibl
