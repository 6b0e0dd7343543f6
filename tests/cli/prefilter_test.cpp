#include "cli/tool.h"

#include "image/read.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <map>

namespace ibl {
namespace {

using Words = std::vector<std::string>;

void expectConstant(const std::filesystem::path& file, float value, float tolerance) {
    const Image image = readImage(file.string()).image;
    for (const float v : image.pixels)
        ASSERT_NEAR(v, value, tolerance) << file;
}

TEST(Diffuse, FurnaceIsItselfInEveryLayout) {
    const Scratch scratch;
    for (const char* layout : {"latlong", "strip", "vstrip"}) {
        const ToolResult result =
            runTool({"diffuse", "builtin:furnace", "--to", layout, "--size", "8", "-o", "f.exr"},
                    scratch.path());
        ASSERT_EQ(result.exit_code, 0) << result.err;
        expectConstant(scratch / "f.exr", 1, 1e-6f);
    }
}

TEST(Diffuse, CoefficientsOfAConstantProbeInEveryConvention) {
    const Scratch scratch;
    const double pi = std::acos(-1.0);
    for (const auto& [name, first] : {std::pair{"radiance", std::sqrt(4 * pi)},
                                      {"irradiance", pi * std::sqrt(4 * pi)},
                                      {"filament", 1.0}}) {
        const ToolResult result = runTool(
            {"diffuse", "builtin:furnace", "--sh", "-", "--sh-convention", name}, scratch.path());
        ASSERT_EQ(result.exit_code, 0) << result.err;
        const auto json = nlohmann::json::parse(result.out);
        EXPECT_EQ(json.at("convention"), name);
        EXPECT_EQ(json.at("order"), 3);
        ASSERT_EQ(json.at("coefficients").size(), 9u);
        for (int i = 0; i < 9; ++i) {
            EXPECT_NEAR(json.at("coefficients")[i][1].get<double>(), i == 0 ? first : 0, 1e-12);
        }
    }
    EXPECT_TRUE(scratch.names().empty());
}

TEST(Diffuse, CoefficientsAreAnOutputLikeTheMap) {
    const Scratch scratch;
    const ToolResult result =
        runTool({"diffuse", "builtin:sky", "--sh", "c.json", "--sh-order", "20", "--to", "latlong",
                 "--size", "4", "-o", "d.exr", "--depfile", "d"},
                scratch.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(scratch.names(), (Words{"c.json", "d", "d.exr"}));
    EXPECT_NE(readFile(scratch / "d").find("c.json"), std::string::npos);
    EXPECT_EQ(nlohmann::json::parse(readFile(scratch / "c.json")).at("coefficients").size(), 400u);
}

TEST(Diffuse, RefusalsOfCoefficients) {
    const Scratch scratch;
    const auto refused = [&](Words words, const std::string& said) {
        words.insert(words.begin(), {"diffuse", "builtin:sky"});
        expectRefused(runTool(words, scratch.path()), 1, said);
    };
    refused({}, "--sh");
    refused({"--sh", "c.json", "--sh-order", "0"}, "--sh-order");
    refused({"--sh", "c.json", "--sh-order", "21"}, "--sh-order");
    refused({"--sh", "c.json", "--sh-convention", "unity"}, "--sh-convention");
    refused({"--sh", "c.json", "--sh-convention", "filament", "--sh-order", "4"}, "filament");
    refused({"--sh", "c.json", "--sh-window", "hann"}, "--sh-window");
    refused({"-o", "d.exr", "--sh-order", "3"}, "--sh-order");
    refused({"-o", "d.exr", "--sh-convention", "radiance"}, "--sh-convention");
    refused({"-o", "d.exr", "--sh-window", "auto"}, "--sh-window");
    for (const char* option : {"--size", "--to", "--quality", "--type", "--compression"}) {
        const std::map<std::string, const char*> values{{"--size", "8"},
                                                        {"--to", "strip"},
                                                        {"--quality", "high"},
                                                        {"--type", "half"},
                                                        {"--compression", "zip"}};
        refused({"--sh", "c.json", option, values.at(option)}, option);
    }
    refused({"--sh", "-", "-o", "-", "--format", "exr"}, "--sh -");
    EXPECT_TRUE(scratch.names().empty());
}

TEST(Specular, FurnaceIsItselfForEveryLobe) {
    const Scratch scratch;
    const auto furnace = [&](const Words& lobe) {
        Words words{"specular", "builtin:furnace", "--to", "vstrip", "--size", "8", "-o", "f.exr"};
        words.insert(words.end(), lobe.begin(), lobe.end());
        const ToolResult result = runTool(words, scratch.path());
        ASSERT_EQ(result.exit_code, 0) << result.err;
        expectConstant(scratch / "f.exr", 1, 1e-6f);
    };
    for (const char* roughness : {"0", "0.1", "0.5", "1"})
        furnace({"--roughness", roughness});
    for (const char* exponent : {"0", "1", "100", "1e5"}) {
        furnace({"--kernel", "phong", "--exponent", exponent});
        furnace({"--kernel", "blinn-phong", "--exponent", exponent});
    }
    for (const char* roughness : {"0.05", "0.5", "1"})
        furnace({"--kernel", "charlie", "--roughness", roughness});
    furnace({"--kernel", "lambert"});
}

TEST(Specular, WhatHalfCannotHoldIsClippedAndCounted) {
    const Scratch scratch;
    // 244 * 2^(148 - 136), about 1e6, in each of 4 x 2 pixels.
    std::string radiance = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
    for (int pixel = 0; pixel < 8; ++pixel)
        radiance += "\xf4\xf4\xf4\x94";
    std::ofstream(scratch / "bright.hdr", std::ios::binary) << radiance;
    const ToolResult result = runTool({"specular", "bright.hdr", "--roughness", "0.5", "--to",
                                       "strip", "--size", "4", "--type", "half", "-o", "h.exr"},
                                      scratch.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    expectConstant(scratch / "h.exr", 65504, 0);
    EXPECT_NE(result.err.find("288 "), std::string::npos) << result.err; // 96 texels, 3 values each
}

TEST(Specular, RoughnessZeroIsConvert) {
    const Scratch scratch;
    ASSERT_EQ(
        runTool({"specular", "builtin:sky", "--roughness", "0", "--size", "32", "-o", "s.exr"},
                scratch.path())
            .exit_code,
        0);
    ASSERT_EQ(runTool({"convert", "builtin:sky", "--size", "32", "-o", "c.exr"}, scratch.path())
                  .exit_code,
              0);
    for (const char* face : {"px", "nx", "py", "ny", "pz", "nz"}) {
        const auto pixels = [&](const char* stem) {
            return readImage((scratch / (stem + std::string(face) + ".exr")).string()).image.pixels;
        };
        EXPECT_TRUE(pixels("s_") == pixels("c_")) << face;
    }
}

TEST(Specular, ChainHasTheLevelsAskedAndTheirLobes) {
    const Scratch scratch;
    const ToolResult result = runTool({"specular", "builtin:sky", "--levels", "5", "--size", "16",
                                       "--to", "vcross", "-o", "s.exr", "--report", "r.json"},
                                      scratch.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(scratch.names(),
              (Words{"r.json", "s_m0.exr", "s_m1.exr", "s_m2.exr", "s_m3.exr", "s_m4.exr"}));
    const auto maps = nlohmann::json::parse(readFile(scratch / "r.json")).at("results").at("maps");
    for (int k = 0; k < 5; ++k) {
        EXPECT_EQ(maps[k].at("roughness"), k / 4.0);
        EXPECT_EQ(maps[k].at("size"), 16 >> k);
        EXPECT_EQ(readImage((scratch / ("s_m" + std::to_string(k) + ".exr")).string()).image.width,
                  3 * (16 >> k));
    }
    // A level of the chain is the lobe alone.
    ASSERT_EQ(runTool({"specular", "builtin:sky", "--roughness", "0.5", "--size", "4", "--to",
                       "vcross", "-o", "one.exr"},
                      scratch.path())
                  .exit_code,
              0);
    const Image one = readImage((scratch / "one.exr").string()).image;
    const Image level = readImage((scratch / "s_m2.exr").string()).image;
    for (std::size_t i = 0; i < one.pixels.size(); ++i) {
        EXPECT_NEAR(one.pixels[i], level.pixels[i], 1e-3f * (1 + level.pixels[i]));
    }
}

nlohmann::json chainReport(const Scratch& scratch, const char* levels, Words words) {
    words.insert(words.begin(), {"specular", "builtin:sky", "--size", "16", "--levels", levels,
                                 "--to", "vstrip", "-o", "c.exr", "--report", "c.json"});
    const ToolResult result = runTool(words, scratch.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return nlohmann::json::parse(readFile(scratch / "c.json")).at("results").at("maps");
}

TEST(Specular, ChainsOfEveryKernelSayTheirRoughness) {
    const Scratch scratch;
    for (const char* kernel : {"phong", "blinn-phong", "charlie"}) {
        const auto maps = chainReport(scratch, "5", {"--kernel", kernel});
        for (int k = 0; k < 5; ++k)
            EXPECT_EQ(maps[k].at("roughness"), k / 4.0) << kernel;
        EXPECT_EQ(maps[0].at("band_limit"), 0) << kernel; // the area-filtered probe
        EXPECT_EQ(maps[2].at("kernel"), kernel);
        if (std::string(kernel) != "charlie") {
            EXPECT_EQ(maps[2].at("exponent"), 30.0);
        }
    }
}

TEST(Specular, RoughnessMapsAreTheirFormulas) {
    const Scratch scratch;
    const auto filament = chainReport(scratch, "5", {"--roughness-map", "filament"});
    for (int k = 0; k < 5; ++k) {
        EXPECT_NEAR(filament[k].at("roughness").get<double>(), 1 - std::sqrt(1 - k / 4.0), 1e-15);
    }
    const auto square = chainReport(scratch, "3", {"--roughness-map", "square"});
    for (int k = 0; k < 3; ++k)
        EXPECT_EQ(square[k].at("roughness"), k * k / 4.0);
    // The level is the lobe of the roughness that it says.
    ASSERT_EQ(runTool({"specular", "builtin:sky", "--roughness", "0.25", "--size", "8", "--to",
                       "vstrip", "-o", "one.exr"},
                      scratch.path())
                  .exit_code,
              0);
    const Image one = readImage((scratch / "one.exr").string()).image;
    const Image level = readImage((scratch / "c_m1.exr").string()).image;
    for (std::size_t i = 0; i < one.pixels.size(); ++i)
        EXPECT_NEAR(one.pixels[i], level.pixels[i], 1e-3f * (1 + level.pixels[i]));
}

TEST(Specular, LambertIsDiffuse) {
    const Scratch scratch;
    for (const Words& words : {Words{"diffuse", "builtin:sky"},
                               Words{"specular", "builtin:sky", "--kernel", "lambert"}}) {
        Words all = words;
        all.insert(all.end(), {"--size", "8", "--to", "vstrip", "-o", words[0] + ".exr"});
        ASSERT_EQ(runTool(all, scratch.path()).exit_code, 0);
    }
    EXPECT_TRUE(readFile(scratch / "diffuse.exr") == readFile(scratch / "specular.exr"));
}

TEST(Specular, Refusals) {
    const Scratch scratch;
    const auto refused = [&](Words words, const std::string& said) {
        words.insert(words.begin(), {"specular", "builtin:sky", "-o", "s.exr"});
        expectRefused(runTool(words, scratch.path()), 1, said);
    };
    refused({}, "--roughness");
    refused({"--roughness", "-0.1"}, "--roughness");
    refused({"--roughness", "1.5"}, "--roughness");
    refused({"--roughness", "nan"}, "roughness");
    refused({"--kernel", "phong", "--roughness", "0.5"}, "--exponent");
    refused({"--exponent", "5"}, "--roughness");
    refused({"--kernel", "phong", "--exponent", "-1"}, "--exponent");
    refused({"--kernel", "phong", "--exponent", "1e7"}, "--exponent");
    refused({"--kernel", "cook", "--roughness", "0.5"}, "--kernel");
    refused({"--kernel", "blinn-phong", "--roughness", "0.5"}, "--exponent");
    refused({"--kernel", "blinn-phong", "--exponent", "1e7"}, "--exponent");
    refused({"--kernel", "charlie", "--exponent", "5"}, "--roughness");
    refused({"--kernel", "charlie", "--roughness", "0"}, "[0.05, 1]");
    refused({"--kernel", "lambert", "--roughness", "0.5"}, "no parameter");
    refused({"--kernel", "lambert", "--levels", "3"}, "--levels");
    refused({"--kernel", "charlie", "--levels", "6", "--roughness-map", "square"}, "level 1");
    refused({"--roughness", "0.5", "--roughness-map", "square"}, "--levels");
    refused({"--levels", "3", "--roughness-map", "cubic"}, "--roughness-map");
    refused({"--levels", "10", "--size", "256"}, "--levels");
    refused({"--levels", "3", "--roughness", "0.5"}, "--levels");
    refused({"--roughness", "0.5", "--max-error", "0"}, "--max-error");
    refused({"--roughness", "0.5", "--quality", "best"}, "--quality");
    refused({"--roughness", "0.5", "--quality", "high", "--max-error", "1e-3"}, "--quality");
    EXPECT_TRUE(scratch.names().empty());
}

TEST(Diffuse, MaxErrorIsKeptOrRefused) {
    const Scratch scratch;
    const ToolResult result = runTool({"diffuse", "builtin:sky", "--size", "8", "--max-error",
                                       "1e-5", "-o", "d.exr", "--report", "r.json"},
                                      scratch.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto map =
        nlohmann::json::parse(readFile(scratch / "r.json")).at("results").at("maps")[0];
    EXPECT_LE(map.at("error_estimate").get<double>(), 1e-5);
}

TEST(Specular, AnErrorThatTheQualityDoesNotProveIsTold) {
    const Scratch scratch;
    const auto told = [&](const std::string& roughness) {
        const ToolResult result =
            runTool({"specular", "builtin:sky", "--kernel", "charlie", "--roughness", roughness,
                     "--quality", "high", "--size", "16", "-o", "s.exr"},
                    scratch.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return result.err;
    };
    EXPECT_EQ(told("0.5"), "");
    EXPECT_NE(told("0.05").find("--quality high: not proven"), std::string::npos);
}

TEST(Specular, WhatNarrowLobesCannotKeepIsRefusedBeforeTheWork) {
    const Scratch scratch;
    const auto start = std::chrono::steady_clock::now();
    const ToolResult result =
        runTool({"specular", "builtin:sky", "--roughness", "0.02", "--to", "exr-latlong", "--size",
                 "256", "--max-error", "1e-6", "-o", "s.exr"}, // minutes of work
                scratch.path());
    EXPECT_EQ(result.exit_code, 5);
    EXPECT_NE(result.err.find("1e-06 cannot be met"), std::string::npos) << result.err;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(30));
    EXPECT_TRUE(scratch.names().empty());
}

} // namespace
} // namespace ibl
