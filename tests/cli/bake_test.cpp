#include "cli/tool.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace ibl {
namespace {

TEST(Bake, WritesWhatItsManifestNames) {
    const Scratch scratch;
    const ToolResult result = runTool(
        {"bake", "builtin:sky", "-o", "b", "--size", "8", "--lights", "5", "--depfile", "b.d"},
        scratch.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const auto manifest = nlohmann::json::parse(readFile(scratch / "b/bake.json"));
    EXPECT_EQ(manifest.at("specular").size(), 4u); // 8, 4, 2, 1
    EXPECT_EQ(manifest.at("specular")[3].at("roughness"), 1.0);
    EXPECT_EQ(manifest.at("diffuse").at("size"), 8);
    EXPECT_EQ(nlohmann::json::parse(readFile(scratch / "b/lights.json")).at("lights").size(), 5u);
    // Folder, six diffuse faces, four levels of six, lights, coefficients, manifest, depfile.
    EXPECT_EQ(scratch.names().size(), 1u + 6 + 24 + 3 + 1);
}

TEST(Bake, IsTheOtherCommandsResults) {
    const Scratch scratch;
    ASSERT_EQ(
        runTool({"bake", "builtin:sky", "-o", "b", "--size", "16", "--levels", "3"}, scratch.path())
            .exit_code,
        0);
    ASSERT_EQ(runTool({"diffuse", "builtin:sky", "-o", "d.exr", "--size", "16"}, scratch.path())
                  .exit_code,
              0);
    ASSERT_EQ(runTool({"specular", "builtin:sky", "-o", "s.exr", "--size", "16", "--levels", "3"},
                      scratch.path())
                  .exit_code,
              0);
    ASSERT_EQ(runTool({"lights", "builtin:sky", "-o", "l.json"}, scratch.path()).exit_code, 0);
    EXPECT_TRUE(readFile(scratch / "b/lights.json") == readFile(scratch / "l.json"));
    ASSERT_EQ(runTool({"diffuse", "builtin:sky", "--sh", "c.json"}, scratch.path()).exit_code, 0);
    EXPECT_TRUE(readFile(scratch / "b/sh.json") == readFile(scratch / "c.json"));
    EXPECT_TRUE(readFile(scratch / "b/specular_m0_py.exr") == readFile(scratch / "s_m0_py.exr"));
    EXPECT_TRUE(readFile(scratch / "b/diffuse_py.exr").size() ==
                readFile(scratch / "d_py.exr").size());
}

TEST(Bake, ContainersAreTheOtherCommands) {
    const Scratch scratch;
    for (const std::string format : {"ktx2", "dds"}) {
        const std::string folder = "in_" + format;
        for (const std::vector<std::string>& words :
             {std::vector<std::string>{"bake", "builtin:sky", "-o", folder, "--size", "16",
                                       "--levels", "3", "--format", format, "--type", "half"},
              {"diffuse", "builtin:sky", "-o", "d." + format, "--size", "16", "--type", "half"},
              {"specular", "builtin:sky", "-o", "s." + format, "--size", "16", "--levels", "3",
               "--type", "half"}}) {
            const ToolResult result = runTool(words, scratch.path());
            ASSERT_EQ(result.exit_code, 0) << result.err;
        }
        EXPECT_EQ(readFile(scratch / (folder + "/specular." + format)),
                  readFile(scratch / ("s." + format)));
        EXPECT_EQ(readFile(scratch / (folder + "/diffuse." + format)).size(),
                  readFile(scratch / ("d." + format)).size());
        const auto manifest = nlohmann::json::parse(readFile(scratch / (folder + "/bake.json")));
        EXPECT_EQ(manifest.at("diffuse").at("file"), "diffuse." + format);
        EXPECT_EQ(manifest.at("specular").at(2).at("file"), "specular." + format);
        EXPECT_EQ(manifest.at("specular").at(2).at("size"), 4);
    }
    expectRefused(
        runTool({"bake", "builtin:furnace", "-o", "c", "--format", "png"}, scratch.path()), 1,
        "--format");
}

TEST(Bake, RoughnessMapIsInTheManifest) {
    const Scratch scratch;
    ASSERT_EQ(
        runTool({"bake", "builtin:furnace", "-o", "b", "--size", "4", "--roughness-map", "square"},
                scratch.path())
            .exit_code,
        0);
    const auto manifest = nlohmann::json::parse(readFile(scratch / "b/bake.json"));
    EXPECT_EQ(manifest.at("specular")[1].at("roughness"), 0.25);
    expectRefused(
        runTool({"bake", "builtin:furnace", "-o", "c", "--roughness-map", "cubic"}, scratch.path()),
        1, "--roughness-map");
}

TEST(Bake, AnExistingFolderIsUsedAndAFailedRunLeavesNone) {
    const Scratch scratch;
    std::filesystem::create_directory(scratch / "b");
    writeFile(scratch / "b/kept.txt", "mine");
    EXPECT_EQ(
        runTool({"bake", "builtin:furnace", "-o", "b", "--size", "2"}, scratch.path()).exit_code,
        0);
    EXPECT_EQ(readFile(scratch / "b/kept.txt"), "mine");
    expectRefused(
        runTool({"bake", "builtin:furnace", "-o", "c", "--size", "2", "--report", "no/r.json"},
                scratch.path()),
        4, "no/r.json");
    EXPECT_FALSE(std::filesystem::exists(scratch / "c"));
    for (const char* folder : {"no/c", "/proc/c"}) {
        expectRefused(runTool({"bake", "builtin:furnace", "-o", folder}, scratch.path()), 4,
                      "name one in a folder that is there and takes files");
    }
}

} // namespace
} // namespace ibl
