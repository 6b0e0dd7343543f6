// Sequences of frames, as users call them.
#include "cli/render_support.h"

#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>

namespace ibl {
namespace {

TEST(RenderFrames, FramesAreTheBytesOfSeparateRuns) {
    const Scratch scratch;
    const Words shared{"render",         "--probe", "builtin:sky", "--object",  "cube", "--shader",
                       "mirror-diffuse", "--size",  "40x30",       "--samples", "2"};
    const auto run = [&](const Words& more) {
        Words words = shared;
        words.insert(words.end(), more.begin(), more.end());
        const ToolResult result = runTool(words, scratch.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
    };
    for (const char* threads : {"1", "5"}) {
        run({"--frames",       "7-10",      "--azimuth",  "0..90",       "--yaw",
             "30..-60",        "--rotate",  "0,10..40,0", "--translate", "0,0,0..0.75",
             "--reflectivity", "0.25..1",   "--threads",  threads,       "--report",
             "r.json",         "--depfile", "d",          "-o",          "f.%03d.png"});
        for (int k = 0; k < 4; ++k) {
            const auto number = [](double v) { return std::to_string(v); };
            run({"--azimuth", number(30 * k), "--yaw", number(30 - 30 * k), "--rotate",
                 "0," + number(10 + 10 * k) + ",0", "--translate", "0,0," + number(0.25 * k),
                 "--reflectivity", number(0.25 + 0.25 * k), "-o", "one.png"});
            char name[16];
            std::snprintf(name, sizeof name, "f.%03d.png", 7 + k);
            EXPECT_TRUE(readFile(scratch / name) == readFile(scratch / "one.png")) << name;
        }
        EXPECT_FALSE(readFile(scratch / "f.007.png") == readFile(scratch / "f.008.png"));
    }
    EXPECT_EQ(readFile(scratch / "d"), "f.007.png f.008.png f.009.png f.010.png:\n");
    const auto report = nlohmann::json::parse(readFile(scratch / "r.json"));
    ASSERT_EQ(report["results"]["frames"].size(), 4u);
    EXPECT_EQ(report["results"]["frames"][3]["frame"], 10);
}

TEST(RenderFrames, FramesAdaptAsRunsThatHandTheirStateOn) {
    const Scratch scratch;
    const auto run = [&](Words words) {
        words.insert(words.begin(), {"render", "--size", "24x16", "--samples", "1", "--exposure",
                                     "auto", "--adapt", "2", "--distance", "3"});
        const ToolResult result = runTool(words, scratch.path());
        EXPECT_EQ(result.exit_code, 0) << result.err;
    };
    // Probes of the frame's name: from dark to bright.
    render(scratch, {"--probe", "builtin:furnace", "--exposure", "-6", "--size", "16x8"}, "p1.exr");
    render(scratch, {"--probe", "builtin:furnace", "--exposure", "4", "--size", "16x8"}, "p2.exr");
    render(scratch, {"--probe", "builtin:furnace", "--exposure", "4", "--size", "16x8"}, "p3.exr");
    run({"--probe", "p%d.exr", "--frames", "1-3", "-o", "f%d.exr"});
    for (const char* k : {"1", "2", "3"}) {
        run({"--probe", std::string("p") + k + ".exr", "--adapt-state", "s.json", "-o", "one.exr"});
        EXPECT_TRUE(readFile(scratch / (std::string("f") + k + ".exr")) ==
                    readFile(scratch / "one.exr"))
            << k;
    }
}

TEST(RenderFrames, FramesBeforeAFailureStay) {
    const Scratch scratch;
    writeFile(scratch / "t1.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n");
    writeFile(scratch / "t3.obj", "f 1 2 3\n");
    std::filesystem::copy_file(scratch / "t1.obj", scratch / "t2.obj");
    expectRefused(
        runTool({"render", "--probe", "builtin:furnace", "--object", "t%d.obj", "--frames", "1-4",
                 "--size", "16x16", "-o", "f%d.png", "--report", "r.json"},
                scratch.path()),
        2, "t3.obj");
    EXPECT_EQ(scratch.names(), (Words{"f1.png", "f2.png", "t1.obj", "t2.obj", "t3.obj"}));
}

} // namespace
} // namespace ibl
