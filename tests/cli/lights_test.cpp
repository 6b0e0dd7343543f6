#include "cli/lights_of.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace ibl {
namespace {

using Json = nlohmann::json;

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

TEST(Lights, MatchedPlacesAreNearerTheProbe) {
    const Scratch scratch;
    for (const char* method : {"median", "variance"}) {
        const auto errorAt = [&](const char* place) {
            return lightsOf({"builtin:sky", "-n", "64", "--method", method, "--place", place},
                            scratch)["irradiance_error"]
                .get<double>();
        };
        EXPECT_LT(errorAt("matched"), 0.8 * errorAt("centroid")) << method;
        EXPECT_LT(errorAt("centroid"), 0.8 * errorAt("centre")) << method;
    }
}

TEST(Lights, SixtyFourByDefaultAreWithinOnePerCent) {
    const Scratch scratch;
    EXPECT_LT(lightsOf({"builtin:sky"}, scratch)["irradiance_error"].get<double>(), 0.0075);
}

TEST(Lights, MaxErrorIsKeptOrRefused) {
    const Scratch scratch;
    const Json lights = lightsOf({"builtin:sky", "--max-error", "0.01"}, scratch);
    EXPECT_LE(lights.at("irradiance_error").get<double>(), 0.01);
    ASSERT_GT(lights.at("lights").size(), 8u);
    const std::string fewer = std::to_string(lights.at("lights").size() - 1);
    EXPECT_GT(lightsOf({"builtin:sky", "-n", fewer}, scratch)["irradiance_error"].get<double>(),
              0.01);
    runTool({"convert", "builtin:sky", "--to", "latlong", "--size", "2", "-o", "s.exr"},
            scratch.path());
    expectRefused(runTool({"lights", "s.exr", "--max-error", "1e-6"}, scratch.path()), 5,
                  "--max-error");
}

TEST(Lights, EveryLayoutGivesTheSameSun) {
    const Scratch scratch;
    const Json expected = lightsOf({"builtin:sky", "--sun"}, scratch)["lights"][0];
    for (const char* layout : {"faces", "vcross", "hcross", "strip", "vstrip", "exr-cube",
                               "angular", "mirrorball", "octahedral"}) {
        runTool({"convert", "builtin:sky", "--to", layout, "--size", "256", "-o", "p.exr"},
                scratch.path());
        const Json found = lightsOf({"p.exr", "--from", layout, "--sun"}, scratch)["lights"][0];
        for (int c = 0; c < 3; ++c) {
            EXPECT_NEAR(found["direction"][c].get<double>(), expected["direction"][c].get<double>(),
                        3e-3)
                << layout;
        }
        for (const std::string& name : scratch.names())
            std::filesystem::remove(scratch / name);
    }
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
    refused({"builtin:sky", "-n", "4", "--max-error", "0.1"}, "--max-error");
    refused({"builtin:sky", "--max-error", "0"}, "--max-error");
    refused({"builtin:sky", "--method", "importance", "--max-error", "0.1"}, "--max-error");
    refused({"builtin:sky", "--method", "importance", "--place", "centre"}, "--place");
    refused({"builtin:sky", "--place", "corner"}, "--place");
    refused({"builtin:sky", "--method", "importance", "--place", "matched"}, "--place");
    refused({"builtin:sky", "--max-error", "0.1", "--place", "matched"}, "--max-error");
    refused({"builtin:sky", "--sun", "-n", "4"}, "--sun");
    refused({"builtin:sky", "--sun", "--method", "median"}, "--sun");
    refused({"builtin:sky", "--residual", "r.exr"}, "--sun");
    refused({"builtin:sky", "--sun", "--residual", "-"}, "--residual");
    refused({"builtin:sky", "-o", "l.txt"}, "--format");
    refused({"builtin:sky", "--format", "usd"}, "--format");
    refused({"builtin:sky", "--preview", "p.jpg"}, ".png");
    refused({}, "IN");
    EXPECT_TRUE(scratch.names().empty());
    writeFile(scratch / "not.json", "{}");
    expectRefused(runTool({"lights", "builtin:sky", "--previous", "not.json"}, scratch.path()), 2,
                  "not.json");
    writeFile(scratch / "m.json",
              runTool({"lights", "builtin:sky", "-n", "2"}, scratch.path()).out);
    expectRefused(runTool({"lights", "builtin:sky", "--previous", "m.json", "--method", "variance"},
                          scratch.path()),
                  2, "--method median");
}

} // namespace
} // namespace ibl
