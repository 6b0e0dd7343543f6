#include "panorama/probe_file.h"

#include "panorama/square_maps.h"

#include "panorama/layouts.h"
#include "unit/panorama/probes.h"
#include "unit/panorama/scratch_folder.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <fstream>

namespace ibl {
namespace {

using test::noise;
using test::ScratchFolder;

void write(const std::string& path, const Panorama& p, const WriteOptions& options = {}) {
    OutputSet outputs;
    writeProbe(outputs, path, p, options);
    outputs.commit();
}

/// One image as another program writes it: nothing says its layout.
void writeUnlabelled(const std::string& path, const Image& image) {
    OutputSet outputs;
    writeImage(outputs, path, image);
    outputs.commit();
}

void expectRefused(const std::string& path, std::optional<Layout> from, const std::string& about) {
    try {
        readProbe(path, {from, "", 1});
        ADD_FAILURE() << about;
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::input) << e.what();
        EXPECT_NE(std::string(e.what()).find(about), std::string::npos) << e.what();
    }
}

TEST(ProbeFile, FaceNamesStandBeforeTheExtension) {
    const std::vector<std::string> names = probeFileNames("dir.x/p.y.exr", Layout::faces);
    ASSERT_EQ(names.size(), 6u);
    EXPECT_EQ(names[0], "dir.x/p.y_px.exr");
    EXPECT_EQ(names[5], "dir.x/p.y_nz.exr");
    EXPECT_EQ(probeFileNames("dir.x/p", Layout::faces)[1], "dir.x/p_nx");
    EXPECT_EQ(probeFileNames("p.exr", Layout::vcross), std::vector<std::string>{"p.exr"});
}

TEST(ProbeFile, EveryLayoutComesBackAsWritten) {
    const ScratchFolder folder;
    for (Layout layout : test::kAllLayouts) {
        const V2i e = layoutExtent(layout, 8);
        Panorama p = noise(layout, e.x, e.y, 31);
        const std::string path = folder.file(std::string(layoutName(layout)) + ".exr");
        write(path, p);
        const ProbeFile file = readProbe(path); // crosses: their blank cells are 0
        EXPECT_TRUE(file.notes.empty());
        EXPECT_EQ(file.metadata.layout, layoutName(layout));
        EXPECT_EQ(file.panorama.layout, layout) << layoutName(layout);
        ASSERT_EQ(file.panorama.image.pixels.size(), p.image.pixels.size());
        EXPECT_EQ(test::largestDifference(file.panorama.image, p.image), 0);
        EXPECT_EQ(file.files, probeFileNames(path, layout));
        EXPECT_EQ(file.metadata.format, "exr");
        EXPECT_TRUE(file.metadata.image.pixels.empty());
    }
}

TEST(ProbeFile, ShapesTellLayoutsThatAreNotLabelled) {
    const ScratchFolder folder;
    const std::string path = folder.file("p.exr");
    for (Layout layout : test::kAllLayouts) {
        if (layout == Layout::faces) continue;
        const V2i e = layoutExtent(layout, 8);
        const Panorama p = noise(layout, e.x, e.y, 31);
        writeUnlabelled(path, p.image);
        const bool by_border = layout == Layout::exrLatlong || layout == Layout::exrCube;
        if (isSquareMap(layout)) {
            expectRefused(path, std::nullopt, "no layout has the shape");
        } else if (!by_border) {
            EXPECT_EQ(readProbe(path).panorama.layout, layout);
        }
        EXPECT_EQ(readProbe(path, {layout, "", 1}).panorama.layout, layout);
    }
}

TEST(ProbeFile, OnlyExrLayoutsSayEnvmap) {
    const ScratchFolder folder;
    const std::string path = folder.file("p.exr");
    write(path, noise(Layout::latlong, 16, 8, 32));
    EXPECT_EQ(readImage(path).envmap, "");
    write(path, noise(Layout::exrLatlong, 16, 8, 32));
    EXPECT_EQ(readImage(path).envmap, "latlong");
    write(path, noise(Layout::exrCube, 4, 24, 32));
    EXPECT_EQ(readImage(path).envmap, "cube");
    // What the user says goes before what the header says.
    EXPECT_EQ(readProbe(path, {Layout::vstrip, "", 1}).panorama.layout, Layout::vstrip);
    OutputSet outputs;
    EXPECT_THROW(writeProbe(outputs, folder.file("p.hdr"), noise(Layout::exrCube, 4, 24, 32)),
                 Error);
}

TEST(ProbeFile, BuiltinProbesAreNoFiles) {
    const ProbeFile sky = readProbe("builtin:sky");
    EXPECT_EQ(sky.panorama.image.width, 1024);
    EXPECT_TRUE(sky.files.empty());
    expectRefused("builtin:moon", std::nullopt, "builtin:moon");
    expectRefused("builtin:sky", Layout::vcross, "builtin:sky");
}

TEST(ProbeFile, AFileGoesBeforeFacesOfItsName) {
    const ScratchFolder folder;
    const std::string path = folder.file("p.exr");
    write(path, noise(Layout::faces, 8, 48, 33));
    EXPECT_EQ(readProbe(path).panorama.layout, Layout::faces);
    EXPECT_EQ(readProbe(path, {Layout::faces, "", 1}).files.size(), 6u);
    expectRefused(path, Layout::latlong, "p.exr");
    write(path, noise(Layout::latlong, 16, 8, 34));
    EXPECT_EQ(readProbe(path).panorama.layout, Layout::latlong);
    expectRefused(path, Layout::faces, "p.exr");
}

TEST(ProbeFile, FacesMustBeSixSquaresOfOneSize) {
    const ScratchFolder folder;
    const std::string path = folder.file("p.exr");
    write(path, noise(Layout::faces, 8, 48, 35));
    std::filesystem::remove(folder.file("p_ny.exr"));
    expectRefused(path, std::nullopt, "p_ny.exr");
    writeUnlabelled(folder.file("p_ny.exr"), noise(Layout::latlong, 8, 4, 36).image);
    expectRefused(path, std::nullopt, "p_ny.exr");
    writeUnlabelled(folder.file("p_ny.exr"), noise(Layout::latlong, 4, 4, 36).image);
    expectRefused(path, std::nullopt, "one size");
    write(folder.file("p_ny.exr"), noise(Layout::latlong, 8, 8, 36));
    expectRefused(path, std::nullopt, "labelled latlong");
    expectRefused(folder.file("q.exr"), std::nullopt, "q.exr");
}

TEST(ProbeFile, WrongShapesAreRefusedUnlessNamed) {
    const ScratchFolder folder;
    const std::string path = folder.file("p.exr");
    writeUnlabelled(path, noise(Layout::latlong, 1, 1, 37).image);
    expectRefused(path, std::nullopt, "1x1");
    EXPECT_EQ(readProbe(path, {Layout::latlong, "", 1}).panorama.image.width, 1);
    writeUnlabelled(path, noise(Layout::latlong, 64, 64, 37).image);
    expectRefused(path, std::nullopt, "64x64");
    expectRefused(path, Layout::hcross, "hcross");
    // 4:3, but a picture to its corners: a photograph, not a cross.
    writeUnlabelled(path, noise(Layout::latlong, 64, 48, 37).image);
    expectRefused(path, std::nullopt, "hcross");
    EXPECT_EQ(readProbe(path, {Layout::hcross, "", 1}).panorama.layout, Layout::hcross);
}

TEST(ProbeFile, SixFacesDoNotFitStandardOutput) {
    OutputSet outputs;
    WriteOptions options;
    options.format = "exr";
    try {
        writeProbe(outputs, "-", noise(Layout::faces, 2, 12, 38), options);
        ADD_FAILURE();
    } catch (const Error& e) {
        EXPECT_EQ(e.code(), ExitCode::usage);
    }
}

} // namespace
} // namespace ibl
