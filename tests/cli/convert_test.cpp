#include "cli/tool.h"

#include "image/read.h"
#include "panorama/builtin.h"
#include "panorama/layouts.h"
#include "panorama/lookup.h"
#include "panorama/probe_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace ibl {
namespace {

using Words = std::vector<std::string>;

void run(const Scratch& scratch, const Words& words) {
    const ToolResult result = runTool(words, scratch.path());
    ASSERT_EQ(result.exit_code, 0) << words[0] << ": " << result.err;
}

Panorama probeAt(const std::filesystem::path& path, Layout layout) {
    ReadProbeOptions options;
    options.from = layout;
    return readProbe(path.string(), options).panorama;
}

/// Relative RMSE over random directions.
double difference(const Panorama& a, const Panorama& b) {
    std::mt19937 random(1);
    std::normal_distribution<double> normal;
    double difference = 0, reference = 0;
    for (int i = 0; i < 20000; ++i) {
        const V3d d(normal(random), normal(random), normal(random));
        const V3d left = radianceAt(a, d), right = radianceAt(b, d);
        difference += (left - right).length2();
        reference += right.length2();
    }
    return std::sqrt(difference / reference);
}

TEST(Convert, EveryLayoutShowsTheSameDirections) {
    const Scratch scratch;
    const Panorama compass = builtinProbe("builtin:compass");
    for (const char* name :
         {"latlong", "faces", "vcross", "hcross", "strip", "vstrip", "exr-latlong", "exr-cube"}) {
        SCOPED_TRACE(name);
        run(scratch, {"convert", "builtin:compass", "--to", name, "--size", "256", "-o",
                      std::string(name) + ".exr"});
        const Panorama result =
            probeAt(scratch / (std::string(name) + ".exr"), *layoutFromName(name));
        // Letters' edges and grid lines soften; a face turned or mirrored differs by 0.4 and more.
        EXPECT_LT(difference(result, compass), 0.15);
    }
}

TEST(Convert, CrossToFacesAndBackIsExact) {
    const Scratch scratch;
    run(scratch, {"convert", "builtin:compass", "--to", "vcross", "--size", "64", "-o", "v.exr"});
    run(scratch, {"convert", "v.exr", "--to", "faces", "-o", "f.exr"});
    run(scratch, {"convert", "f.exr", "--to", "vcross", "-o", "w.exr"});
    EXPECT_TRUE(readFile(scratch / "v.exr") == readFile(scratch / "w.exr"));
}

TEST(Convert, LatlongToFacesAndBack) {
    const Scratch scratch;
    // Something smooth, so that what is left is the conversion's own error.
    run(scratch, {"specular", "builtin:compass", "--roughness", "0.5", "--to", "latlong", "--size",
                  "64", "-o", "l.exr"});
    run(scratch, {"convert", "l.exr", "--to", "faces", "--size", "256", "-o", "f.exr"});
    run(scratch, {"convert", "f.exr", "--to", "latlong", "--size", "64", "-o", "m.exr"});
    EXPECT_LT(difference(probeAt(scratch / "m.exr", Layout::latlong),
                         probeAt(scratch / "l.exr", Layout::latlong)),
              2e-3);
}

TEST(Convert, FormatsKeepTheProbe) {
    const Scratch scratch;
    run(scratch, {"convert", "builtin:sky", "--to", "latlong", "--size", "64", "-o", "l.exr"});
    const Panorama whole = probeAt(scratch / "l.exr", Layout::latlong);
    for (const auto& [name, tolerance] :
         {std::pair{"h.hdr", 4e-3}, {"t.tif", 1e-7}, {"e.exr", 1e-7}}) {
        run(scratch, {"convert", "l.exr", "--to", "latlong", "-o", name});
        EXPECT_LT(difference(probeAt(scratch / name, Layout::latlong), whole), tolerance) << name;
    }
    for (const char* compression :
         {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
        run(scratch, {"convert", "l.exr", "--to", "latlong", "--type", "half", "--compression",
                      compression, "-o", "c.exr"});
        EXPECT_LT(difference(probeAt(scratch / "c.exr", Layout::latlong), whole), 0.02)
            << compression;
    }
}

TEST(Convert, HalfSaysWhatItCannotHold) {
    const Scratch scratch;
    const std::string bright = std::string("\x80\x80\x80", 3) + static_cast<char>(136 + 20);
    writeFile(scratch / "b.hdr",
              "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n" + bright + bright);
    const ToolResult result = runTool(
        {"convert", "b.hdr", "--to", "latlong", "--type", "half", "-o", "b.exr"}, scratch.path());
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_NE(result.err.find("65504"), std::string::npos) << result.err;
    EXPECT_EQ(readImage((scratch / "b.exr").string()).image.pixels[0], 65504.f);
}

TEST(Convert, SixFacesStandForOneName) {
    const Scratch scratch;
    run(scratch, {"convert", "builtin:compass", "--size", "16", "-o", "p.exr"});
    EXPECT_EQ(scratch.names(),
              (Words{"p_nx.exr", "p_ny.exr", "p_nz.exr", "p_px.exr", "p_py.exr", "p_pz.exr"}));
    run(scratch, {"convert", "p.exr", "--to", "hcross", "-o", "h.exr"});
    std::filesystem::remove(scratch / "p_ny.exr");
    expectRefused(runTool({"convert", "p.exr", "--to", "hcross", "-o", "i.exr"}, scratch.path()), 2,
                  "p_ny.exr");
}

TEST(Convert, AnOutsideReaderSeesTheFaces) {
    const Scratch scratch;
    // OpenEXR's own program turns its own layouts, by its own border rule, into one another.
    run(scratch, {"convert", "builtin:compass", "--to", "exr-latlong", "--size", "256", "--type",
                  "half", "-o", "l.exr"});
    const ToolResult outside =
        runProgram({"exrenvmap", "-c", "-w", "128", "l.exr", "cube.exr"}, scratch.path());
    ASSERT_EQ(outside.exit_code, 0) << outside.err;
    const Panorama cube = readProbe((scratch / "cube.exr").string(), {}).panorama;
    EXPECT_EQ(cube.layout, Layout::exrCube);
    EXPECT_LT(difference(cube, builtinProbe("builtin:compass")), 0.25);
}

} // namespace
} // namespace ibl
