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

TEST(Lights, JsonKeepsToThePublishedSchema) {
    const Scratch scratch;
    const auto make = [&](std::vector<std::string> words) {
        words.insert(words.begin(), "lights");
        const ToolResult result = runTool(words, scratch.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
    };
    make({"builtin:sky", "-n", "9", "-o", "cut.json"});
    make({"builtin:sky", "--previous", "cut.json", "-o", "next.json"});
    make({"builtin:sky", "--method", "importance", "-n", "5", "-o", "importance.json"});
    make({"builtin:sky", "--sun", "-o", "sun.json"});
    Json wrong = Json::parse(readFile(scratch / "cut.json"));
    wrong["lights"][0].erase("direction");
    writeFile(scratch / "wrong.json", wrong.dump());
    const std::string validate = "import json, sys, jsonschema\n"
                                 "schema = json.load(open(sys.argv[1]))\n"
                                 "jsonschema.Draft7Validator.check_schema(schema)\n"
                                 "jsonschema.validate(json.load(open(sys.argv[2])), schema)\n";
    const std::string schema = std::string(IBLTOOL_SOURCE_DIR) + "/testdata/lights.schema.json";
    for (const std::string name :
         {"cut.json", "next.json", "importance.json", "sun.json", "wrong.json"}) {
        const ToolResult result =
            runProgram({"python3", "-W", "ignore", "-c", validate, schema, name}, scratch.path());
        EXPECT_EQ(result.exit_code == 0, name != "wrong.json") << result.err;
        if (name == "wrong.json") {
            EXPECT_NE(result.err.find("'direction' is a required"), std::string::npos);
        }
    }
}

TEST(Lights, TheManualNamesTheSchemasMembers) {
    const std::string root = IBLTOOL_SOURCE_DIR;
    const Json schema = Json::parse(readFile(root + "/testdata/lights.schema.json"));
    const std::string page = readFile(root + "/man/ibltool-lights.1");
    const Json& members = schema["properties"];
    for (const Json& part :
         {members, members["change"]["properties"], members["lights"]["items"]["properties"]}) {
        for (const auto& member : part.items()) {
            EXPECT_NE(page.find("\\fI" + member.key() + "\\fR"), std::string::npos) << member.key();
        }
    }
}

TEST(Lights, FormatsByExtensionOrByName) {
    const Scratch scratch;
    for (const std::string format : {"json", "csv", "gltf", "usda"}) {
        const std::string name = "l." + format;
        EXPECT_EQ(runTool({"lights", "builtin:sky", "-n", "3", "-o", name}, scratch.path()).err,
                  "");
        const std::string out =
            runTool({"lights", "builtin:sky", "-n", "3", "--format", format}, scratch.path()).out;
        EXPECT_EQ(out, readFile(scratch / name));
        EXPECT_NE(out.find("builtin:sky"), std::string::npos) << out;
    }
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

TEST(Lights, PreviewIsAPicture) {
    const Scratch scratch;
    lightsOf({"builtin:sky", "--preview", "p.png"}, scratch);
    EXPECT_EQ(readFile(scratch / "p.png").substr(1, 3), "PNG");
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
        EXPECT_NE(result.err.find("no lights"), std::string::npos);
        EXPECT_TRUE(Json::parse(result.out).at("lights").empty());
    }
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
