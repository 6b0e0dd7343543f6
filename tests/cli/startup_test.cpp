// Start-up is part of speed: the tool is started once a frame and once an asset.
#include "cli/tool.h"

#include <gtest/gtest.h>

#include <sstream>

namespace ibl {
namespace {

TEST(Startup, LoadsFewLibrariesAndNoneOfTheHeavyOnes) {
    const Scratch scratch;
    // The dynamic loader lists what it would load, and starts nothing.
    const ToolResult listing = runTool({}, scratch.path(), {}, {"LD_TRACE_LOADED_OBJECTS=1"});
    ASSERT_EQ(listing.exit_code, 0);
    std::istringstream lines(listing.out);
    int libraries = 0;
    for (std::string line; std::getline(lines, line);) {
        const bool sanitizer =
            line.find("libasan") != std::string::npos || line.find("libubsan") != std::string::npos;
        if (!sanitizer) ++libraries;
        for (const char* heavy : {"OpenImageIO", "OpenColorIO", "libEGL", "libGL", "libLLVM"}) {
            EXPECT_EQ(line.find(heavy), std::string::npos) << line;
        }
    }
    EXPECT_GE(libraries, 5) << listing.out;
    EXPECT_LE(libraries, 16) << listing.out;
}

TEST(Startup, VersionAndHelp) {
    const Scratch scratch;
    const ToolResult version = runTool({"--version"}, scratch.path());
    EXPECT_EQ(version.exit_code, 0);
    EXPECT_EQ(version.out.rfind("ibltool ", 0), 0u) << version.out;
    EXPECT_EQ(version.err, "");
    const ToolResult help = runTool({"--help"}, scratch.path());
    EXPECT_EQ(help.exit_code, 0);
    for (const char* command :
         {"convert", "diffuse", "specular", "lights", "render", "bake", "info"}) {
        EXPECT_NE(help.out.find(command), std::string::npos) << command;
        EXPECT_EQ(runTool({command, "--help"}, scratch.path()).exit_code, 0);
    }
}

} // namespace
} // namespace ibl
