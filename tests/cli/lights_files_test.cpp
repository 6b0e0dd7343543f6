// What ibltool lights writes.
#include "cli/lights_of.h"

#include <gtest/gtest.h>

#include <sstream>

namespace ibl {
namespace {

using Json = nlohmann::json;

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

// A glTF light shines along its node's -Z, so that +Z points towards it.
TEST(Lights, AssimpReadsTheGltf) {
    const Scratch scratch;
    const Json lights = lightsOf({"builtin:compass", "-n", "20"}, scratch).at("lights");
    runTool({"lights", "builtin:compass", "-n", "20", "-o", "l.gltf"}, scratch.path());
    const std::string info = runProgram({"assimp", "info", "l.gltf", "-r"}, scratch.path()).out;
    const std::size_t count = info.find("Lights:");
    ASSERT_NE(count, std::string::npos) << info;
    EXPECT_EQ(std::stoi(info.substr(count + 7)), 20);
    runProgram({"assimp", "dump", "l.gltf", "l.xml", "-r"}, scratch.path());
    const std::string nodes = readFile(scratch / "l.xml");
    for (std::size_t i = 0; i < lights.size(); ++i) {
        const std::string name = "<Node name=\"light_" + std::to_string(i) + "\">";
        ASSERT_NE(nodes.find(name), std::string::npos) << nodes;
        std::istringstream matrix(nodes.substr(nodes.find("<Matrix4>", nodes.find(name)) + 9));
        for (std::size_t row = 0; row < 3; ++row) {
            double x, y, z, shift;
            matrix >> x >> y >> z >> shift;
            EXPECT_NEAR(z, lights[i]["direction"][row].get<double>(), 2e-6) << i;
            EXPECT_EQ(shift, 0);
        }
    }
}

TEST(Lights, PreviewIsAPicture) {
    const Scratch scratch;
    lightsOf({"builtin:sky", "--preview", "p.png"}, scratch);
    EXPECT_EQ(readFile(scratch / "p.png").substr(1, 3), "PNG");
}

} // namespace
} // namespace ibl
