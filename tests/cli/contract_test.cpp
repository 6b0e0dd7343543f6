// The contract with pipelines: exit codes, one line on standard error, no output on failure.
#include "cli/tool.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <sys/stat.h>
#include <unistd.h>

namespace ibl {
namespace {

using Words = std::vector<std::string>;

/// The commands that read a probe, each with the output that it is to leave alone when it fails.
const std::vector<Words> kCommands = {
    {"convert", "IN", "-o", "out.exr"},
    {"diffuse", "IN", "-o", "out.exr", "--size", "4"},
    {"specular", "IN", "-o", "out.exr", "--size", "4", "--roughness", "0.5"},
    {"lights", "IN", "-o", "out.json"},
    {"bake", "IN", "-o", "out", "--size", "4"},
    {"render", "--probe", "IN", "-o", "out.png", "--size", "8x8"},
    {"info", "IN"},
};

Words with(Words command, const std::string& input) {
    for (std::string& word : command) {
        if (word == "IN") word = input;
    }
    return command;
}

/// Every command refuses the file and leaves the folder as it was.
void expectAllRefuse(const Scratch& scratch, const std::string& file, const std::string& said) {
    const auto before = scratch.names();
    for (const Words& command : kCommands) {
        SCOPED_TRACE(command[0] + " " + file);
        expectRefused(runTool(with(command, file), scratch.path()), 2, said);
        EXPECT_EQ(scratch.names(), before);
    }
}

void make(const Scratch& scratch, const std::string& name, const Words& more = {}) {
    Words words{"convert", "builtin:sky", "--to", "latlong", "--size", "16", "-o", name, "--quiet"};
    words.insert(words.end(), more.begin(), more.end());
    const ToolResult result = runTool(words, scratch.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
}

TEST(Contract, MissingInput) {
    const Scratch scratch;
    expectAllRefuse(scratch, "nothing.exr", "nothing.exr");
    expectAllRefuse(scratch, "builtin:moon", "builtin:moon");
}

TEST(Contract, DirectoryAsInput) {
    const Scratch scratch;
    std::filesystem::create_directory(scratch / "folder");
    expectAllRefuse(scratch, "folder", "folder");
}

TEST(Contract, EmptyAndForeignFiles) {
    const Scratch scratch;
    writeFile(scratch / "empty.exr", "");
    expectAllRefuse(scratch, "empty.exr", "empty.exr");
    writeFile(scratch / "text.hdr", "this is no picture\n");
    expectAllRefuse(scratch, "text.hdr", "text.hdr");
}

TEST(Contract, TruncatedFilesOfEveryFormat) {
    const Scratch scratch;
    for (const char* name : {"a.exr", "a.hdr", "a.png", "a.tif"})
        make(scratch, name);
    for (const char* name : {"a.exr", "a.hdr", "a.png", "a.tif"}) {
        const std::string whole = readFile(scratch / name);
        for (const double part : {0.05, 0.5, 0.97}) {
            writeFile(scratch / name,
                      whole.substr(
                          0, static_cast<std::size_t>(part * static_cast<double>(whole.size()))));
            SCOPED_TRACE(std::string(name) + " cut at " + std::to_string(part));
            expectRefused(
                runTool({"convert", name, "-o", "out.exr", "--from", "latlong"}, scratch.path()), 2,
                name);
        }
    }
    EXPECT_EQ(scratch.names(), (Words{"a.exr", "a.hdr", "a.png", "a.tif"}));
}

TEST(Contract, WrongAspectIsRefusedUnlessTold) {
    const Scratch scratch;
    // 32 x 16 faces: neither lat-long nor cross nor strip when cut to one face's shape.
    make(scratch, "cube.exr", {});
    ASSERT_EQ(
        runTool({"convert", "cube.exr", "--to", "faces", "-o", "f.exr"}, scratch.path()).exit_code,
        0);
    expectRefused(runTool({"diffuse", "f_px.exr", "-o", "out.exr"}, scratch.path()), 2, "layout");
    EXPECT_EQ(runTool({"diffuse", "f_px.exr", "--from", "latlong", "--size", "2", "-o", "out.exr"},
                      scratch.path())
                  .exit_code,
              0);
}

TEST(Contract, OnePixelProbes) {
    const Scratch scratch;
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
    const std::string pixel = "\x80\x40\x20\x81";
    writeFile(scratch / "1x1.hdr", header + "-Y 1 +X 1\n" + pixel);
    writeFile(scratch / "2x1.hdr", header + "-Y 1 +X 2\n" + pixel + pixel);
    writeFile(scratch / "2x2.hdr", header + "-Y 2 +X 2\n" + pixel + pixel + pixel + pixel);
    expectAllRefuse(scratch, "1x1.hdr", "layout");
    expectAllRefuse(scratch, "2x2.hdr", "layout");
    for (const char* name : {"1x1.hdr", "2x1.hdr", "2x2.hdr"}) {
        for (Words command : kCommands) {
            command = with(command, name);
            command.insert(command.end(), {"--from", "latlong"});
            const ToolResult result = runTool(command, scratch.path());
            EXPECT_EQ(result.exit_code, 0) << command[0] << " " << name << ": " << result.err;
        }
    }
}

TEST(Contract, NotANumberIsRefusedAndMended) {
    const Scratch scratch;
    const std::string nan("\0\0\xc0\x7f", 4), inf("\0\0\x80\x7f", 4), one("\0\0\x80\x3f", 4);
    const auto exr = [&](const std::string& name, const std::string& value) {
        make(scratch, name, {"--compression", "none"});
        std::string bytes = readFile(scratch / name);
        // The last float of the file is the last pixel's red (channels are stored B, G, R).
        bytes.replace(bytes.size() - 4, 4, value);
        writeFile(scratch / name, bytes);
    };
    exr("nan.exr", nan);
    exr("inf.exr", inf);
    for (const char* name : {"nan.exr", "inf.exr"}) {
        for (const Words& command : kCommands) {
            if (command[0] == "info") continue; // it tells of them
            SCOPED_TRACE(command[0] + " " + name);
            expectRefused(runTool(with(command, name), scratch.path()), 2, "(31, 15)");
        }
        const ToolResult mended = runTool(
            {"convert", name, "--repair", "--to", "latlong", "-o", "out.exr"}, scratch.path());
        EXPECT_EQ(mended.exit_code, 0) << mended.err;
        EXPECT_NE(mended.err.find("1 bad pixel mended"), std::string::npos) << mended.err;
        const auto info =
            nlohmann::json::parse(runTool({"info", "--json", "out.exr"}, scratch.path()).out);
        EXPECT_EQ(info.at("nan").at("count"), 0);
        EXPECT_EQ(info.at("infinite").at("count"), 0);
        const auto before =
            nlohmann::json::parse(runTool({"info", "--json", name}, scratch.path()).out);
        EXPECT_EQ(before.at("nan").at("count").get<int>() +
                      before.at("infinite").at("count").get<int>(),
                  1);
    }
}

TEST(Contract, NegativePixelsAreKeptAndTold) {
    const Scratch scratch;
    make(scratch, "n.exr", {"--compression", "none"});
    std::string bytes = readFile(scratch / "n.exr");
    bytes.replace(bytes.size() - 4, 4, std::string("\0\0\x40\xc1", 4)); // -12
    writeFile(scratch / "n.exr", bytes);
    const ToolResult result =
        runTool({"convert", "n.exr", "--to", "latlong", "-o", "o.exr"}, scratch.path());
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.err.find("1 negative pixel kept, down to -12 at (31, 15)"), std::string::npos)
        << result.err;
    const auto info =
        nlohmann::json::parse(runTool({"info", "--json", "o.exr"}, scratch.path()).out);
    EXPECT_EQ(info.at("minimum")[0], -12.0);
}

TEST(Contract, UnknownOptionsValuesAndCommands) {
    const Scratch scratch;
    const auto refused = [&](const Words& words, const std::string& said) {
        expectRefused(runTool(words, scratch.path()), 1, said);
    };
    refused({}, "subcommand");
    refused({"convolve", "builtin:sky"}, "convolve");
    for (Words command : kCommands) {
        command = with(command, "builtin:sky");
        command.push_back("--sise");
        command.push_back("4");
        refused(command, "--sise");
    }
    for (const Words& command : kCommands) {
        Words words = with(command, "builtin:sky");
        words.push_back("extra");
        refused(words, "extra");
    }
    refused({"convert", "builtin:sky", "-o", "a.exr", "--to", "sphere"}, "--to");
    refused({"convert", "builtin:sky", "-o", "a.exr", "--from", "sphere"}, "--from");
    refused({"convert", "builtin:sky", "-o", "a.exr", "--size", "0"}, "--size");
    refused({"convert", "builtin:sky", "-o", "a.exr", "--size", "99999"}, "--size");
    refused({"convert", "builtin:sky", "-o", "a.exr", "--size", "4k"}, "--size");
    refused({"convert", "builtin:sky", "-o", "a.exr", "--type", "double"}, "--type");
    refused({"convert", "builtin:sky", "-o", "a.exr", "--threads", "-1"}, "--threads");
    refused({"convert", "builtin:sky", "-o", "a.exr", "--quiet", "--verbose"}, "--quiet");
    refused({"convert", "builtin:sky"}, "--output");
    refused({"convert", "builtin:sky", "-o", "-", "--format", "exr"}, "layout");
    for (const char* command : {"convert", "tonemap"})
        refused({command, "builtin:sky", "-o", "a.png", "--compression", "zip"}, "--compression");
    refused({"tonemap", "builtin:sky", "-o", "."}, "is a folder");
    EXPECT_TRUE(scratch.names().empty());
}

TEST(Contract, UnwritableTargets) {
    const Scratch scratch;
    std::filesystem::create_directory(scratch / "folder");
    for (const char* target : {"no/such/folder/o.exr", "folder"}) {
        SCOPED_TRACE(target);
        expectRefused(runTool({"convert", "builtin:furnace", "--to", "latlong", "--size", "4", "-o",
                               target, "--format", "exr"},
                              scratch.path()),
                      4, target);
    }
    expectRefused(runTool({"convert", "builtin:furnace", "--to", "latlong", "--size", "4", "-o",
                           "/dev/full", "--format", "exr"},
                          scratch.path()),
                  4, "/dev/full");
    expectRefused(runTool({"convert", "builtin:furnace", "--to", "latlong", "--size", "4", "-o",
                           "o.exr", "--report", "no/r.json"},
                          scratch.path()),
                  4, "no/r.json");
    expectRefused(
        runTool({"bake", "builtin:furnace", "--size", "4", "-o", "no/folder"}, scratch.path()), 4,
        "no/folder");
    // Said by what stands in the way, not by what was tried.
    writeFile(scratch / "file", "");
    expectRefused(runTool({"bake", "builtin:furnace", "--size", "4", "-o", "file"}, scratch.path()),
                  4, "file: is a file; name a folder");
    expectRefused(runTool({"convert", "builtin:furnace", "-o", "file/o.exr"}, scratch.path()), 4,
                  "file is a file, not a folder");
    expectRefused(runTool({"convert", "builtin:furnace", "-o", "/proc/o.exr"}, scratch.path()), 4,
                  "/proc takes no files");
    // Before any work is done.
    expectRefused(runTool({"convert", "none.exr", "-o", "o.xyz"}, scratch.path()), 1, "xyz");
    expectRefused(runTool({"convert", "builtin:furnace", "--to", "latlong", "-o", "o.exr",
                           "--report", "o.exr"},
                          scratch.path()),
                  1, "o.exr: would be written twice");
    EXPECT_EQ(scratch.names(), (Words{"file", "folder"}));
}

TEST(Contract, UsageIsRefusedInTheUsersWords) {
    const Scratch scratch;
    const auto refused = [&](Words words, const char* said) {
        words.insert(words.begin(), "render");
        words.insert(words.end(), {"--probe", "builtin:sky", "-o", "o.png"});
        SCOPED_TRACE(said);
        expectRefused(runTool(words, scratch.path()), 1, said);
    };
    refused({"--size", "8x8", "--size", "9x9"}, "--size: is given more than once");
    refused({"--base-color", "1,1"}, "--base-color: takes 3 values, not 2");
    refused({"--eye", "0..1,0,4"}, "--eye: '0..1,0,4' is no number");
    refused({"--power", "3"}, "--power: there is no such option");
    refused({"stray"}, "stray: is one word too many");
    refused({"--samples", "1e1"}, "--samples: '1e1' is not a whole number from 1 to 4096");
    expectRefused(
        runTool({"specular", "builtin:sky", "--roughness", "nan", "-o", "o.exr"}, scratch.path()),
        1, "--roughness: 'nan' is not a number from 0 to 1");
    expectRefused(runTool({"bend", "builtin:sky"}, scratch.path()), 1,
                  "bend: there is no such command");
    expectRefused(runTool({"bend", "builtin:sky", "-o", "o.exr"}, scratch.path()), 1,
                  "bend: there is no such command");
    expectRefused(runTool({"convert", "builtin:sky", "-o", ""}, scratch.path()), 1,
                  "-o: the name is empty");
    expectRefused(runTool({"bake", "builtin:sky", "-o", "-"}, scratch.path()), 1,
                  "-o -: what is baked is a folder");
    EXPECT_TRUE(scratch.names().empty());
}

TEST(Contract, TextDoesNotReplaceWhatIsRead) {
    const Scratch scratch;
    make(scratch, "in.exr");
    const std::string old = readFile(scratch / "in.exr");
    const auto refused = [&](Words words, const char* said) {
        words.insert(words.begin(), {"lights", "in.exr"});
        expectRefused(runTool(words, scratch.path()), 1, said);
        EXPECT_EQ(readFile(scratch / "in.exr"), old);
    };
    refused({"-o", "l.json", "--report", "in.exr"}, "--report: in.exr is read as well");
    refused({"-o", "l.json", "--depfile", "./in.exr"}, "--depfile: ./in.exr is read as well");
    refused({"-o", "in.exr", "--format", "json"}, "in.exr: is the probe");
    EXPECT_EQ(scratch.names(), (Words{"in.exr"}));
}

TEST(Contract, AFailedRunLeavesTheOldFile) {
    const Scratch scratch;
    make(scratch, "out.exr");
    const std::string old = readFile(scratch / "out.exr");
    writeFile(scratch / "bad.exr", old.substr(0, old.size() / 2));
    expectRefused(
        runTool({"convert", "bad.exr", "--to", "latlong", "-o", "out.exr"}, scratch.path()), 2,
        "bad.exr");
    EXPECT_EQ(readFile(scratch / "out.exr"), old);
    EXPECT_EQ(scratch.names(), (Words{"bad.exr", "out.exr"}));
}

TEST(Contract, StandardInputAndOutput) {
    const Scratch scratch;
    make(scratch, "a.exr");
    for (const char* format : {"exr", "hdr"}) {
        const ToolResult piped =
            runTool({"convert", "-", "--to", "vcross", "-o", "-", "--format", format},
                    scratch.path(), readFile(scratch / "a.exr"));
        ASSERT_EQ(piped.exit_code, 0) << piped.err;
        ASSERT_EQ(runTool({"convert", "a.exr", "--to", "vcross", "-o", std::string("b.") + format},
                          scratch.path())
                      .exit_code,
                  0);
        EXPECT_TRUE(piped.out == readFile(scratch / (std::string("b.") + format)));
    }
    expectRefused(runTool({"convert", "a.exr", "--to", "vcross", "-o", "-"}, scratch.path()), 1,
                  "--format");
    expectRefused(runTool({"info", "-"}, scratch.path(), ""), 2, "standard input");
}

TEST(Contract, SameBytesOnEveryRunAndForAnyThreadCount) {
    const Scratch scratch;
    for (const Words& command : kCommands) {
        if (command[0] == "info" || command[0] == "bake") continue;
        std::string first;
        for (const char* threads : {"1", "2", "5"}) {
            const Scratch fresh;
            Words words = with(command, "builtin:sky");
            words.insert(words.end(), {"--threads", threads});
            ASSERT_EQ(runTool(words, fresh.path()).exit_code, 0);
            std::string bytes;
            for (const std::string& name : fresh.names())
                bytes += name + readFile(fresh / name);
            if (first.empty()) first = bytes;
            EXPECT_TRUE(bytes == first) << command[0] << " with " << threads << " threads";
        }
    }
}

TEST(Contract, QuietReportAndDepfile) {
    const Scratch scratch;
    make(scratch, "in 1.exr");
    const ToolResult result =
        runTool({"diffuse", "in 1.exr", "--size", "4", "-o", "d.exr", "--quiet", "--report",
                 "r.json", "--depfile", "d.d", "--type", "half"},
                scratch.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    const auto report = nlohmann::json::parse(readFile(scratch / "r.json"));
    EXPECT_EQ(report.at("command"), "diffuse");
    EXPECT_EQ(report.at("inputs"), nlohmann::json::array({"in 1.exr"}));
    EXPECT_EQ(report.at("outputs").size(), 6u);
    EXPECT_GT(report.at("seconds").at("read").get<double>(), 0);
    const auto& map = report.at("results").at("maps")[0];
    EXPECT_LE(map.at("error_estimate").get<double>(), 1e-4);
    EXPECT_EQ(readFile(scratch / "d.d"),
              "d_px.exr d_nx.exr d_py.exr d_ny.exr d_pz.exr d_nz.exr: in\\ 1.exr\n");
}

} // namespace
} // namespace ibl
