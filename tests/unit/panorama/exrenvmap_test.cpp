// OpenEXR's own converter as the judge of the exr layouts.
#include "panorama/lookup.h"
#include "panorama/probe_file.h"
#include "panorama/resample.h"
#include "unit/panorama/probes.h"
#include "unit/panorama/scratch_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace ibl {
namespace {

using test::filled;

/// No two directions alike, and no symmetry that a mirrored face would hide behind.
V3d scene(const V3d& d) {
    return {1 + 0.8 * d.x, 1 + 0.8 * d.y + 0.1 * d.x * d.z, 1 + 0.8 * d.z};
}

Panorama converted(const test::ScratchFolder& folder, const Panorama& source,
                   const std::string& options) {
    OutputSet outputs;
    writeProbe(outputs, folder.file("in.exr"), source);
    outputs.commit();
    const std::string command = "exrenvmap -z none " + options + " '" + folder.file("in.exr") +
                                "' '" + folder.file("out.exr") + "'";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return readProbe(folder.file("out.exr")).panorama;
}

double worstAgainstScene(const Panorama& p) {
    double worst = 0;
    for (int y = 0; y < p.image.height; ++y) {
        for (int x = 0; x < p.image.width; ++x) {
            const auto d =
                texelDirection(p.layout, p.image.width, p.image.height, x + 0.5, y + 0.5);
            worst = std::max(worst, (test::pixel(p, x, y) - scene(*d)).length());
        }
    }
    return worst;
}

TEST(ExrEnvmap, ReadsOurLatlongAndWritesTheCubeWeExpect) {
    const test::ScratchFolder folder;
    const Panorama source = filled(Layout::exrLatlong, 128, 64, scene);
    const Panorama cube = converted(folder, source, "-c -w 32");
    ASSERT_EQ(cube.layout, Layout::exrCube);
    ASSERT_EQ(cube.image.width, 32);
    EXPECT_LT(worstAgainstScene(cube), 5e-3);
    EXPECT_LT(test::largestDifference(cube.image, resample(source, Layout::exrCube, 32).image),
              5e-3);
}

TEST(ExrEnvmap, ReadsOurCubeAndWritesTheLatlongWeExpect) {
    const test::ScratchFolder folder;
    const Panorama source = filled(Layout::exrCube, 32, 192, scene);
    const Panorama latlong = converted(folder, source, "-l -w 64");
    ASSERT_EQ(latlong.layout, Layout::exrLatlong);
    EXPECT_LT(worstAgainstScene(latlong), 1e-2);
    // Ours takes texels as constant, so that a pixel of one and a half is off by a part of one.
    EXPECT_LT(
        test::largestDifference(latlong.image, resample(source, Layout::exrLatlong, 32).image),
        3e-2);
}

// What we convert ourselves is the scene, in both layouts, from the plain ones.
TEST(ExrEnvmap, OurConversionsAgreeWithTheScene) {
    const Panorama latlong = filled(Layout::latlong, 128, 64, scene);
    EXPECT_LT(worstAgainstScene(resample(latlong, Layout::exrCube, 24)), 5e-3);
    EXPECT_LT(worstAgainstScene(resample(latlong, Layout::exrLatlong, 40)), 1e-2);
    EXPECT_LT(
        worstAgainstScene(resample(filled(Layout::exrCube, 33, 198, scene), Layout::faces, 33)),
        5e-3);
}

} // namespace
} // namespace ibl
