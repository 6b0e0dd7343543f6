#include "panorama/builtin.h"

#include "panorama/lookup.h"
#include "panorama/resample.h"
#include "unit/panorama/probes.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace ibl {
namespace {

TEST(Builtin, NamesAreKnown) {
    EXPECT_TRUE(isBuiltin("builtin:sky"));
    EXPECT_TRUE(isBuiltin("builtin:whatever"));
    EXPECT_FALSE(isBuiltin("sky"));
    EXPECT_FALSE(isBuiltin("folder/builtin:sky"));
    for (const char* name : {"builtin:", "builtin:Sky", "sky", "builtin:sky2"}) {
        try {
            builtinProbe(name);
            ADD_FAILURE() << name;
        } catch (const Error& e) {
            EXPECT_EQ(e.code(), ExitCode::input);
        }
    }
}

TEST(Builtin, AreLatlongsOfPositiveFiniteRadiance) {
    for (const char* name : {"builtin:sky", "builtin:compass", "builtin:furnace"}) {
        for (int height : {1, 2, 33, 128}) {
            const Panorama p = builtinProbe(name, height, 1);
            EXPECT_EQ(p.layout, Layout::latlong);
            EXPECT_EQ(p.image.width, 2 * height);
            EXPECT_EQ(p.image.height, height);
            for (float v : p.image.pixels)
                ASSERT_TRUE(std::isfinite(v) && v > 0) << name;
            EXPECT_EQ(test::largestDifference(p.image, builtinProbe(name, height, 4).image), 0);
        }
    }
    EXPECT_EQ(builtinProbe("builtin:sky").image.width, 1024);
}

TEST(Builtin, FurnaceIsOne) {
    for (float v : builtinProbe("builtin:furnace", 16).image.pixels)
        ASSERT_EQ(v, 1.0f);
}

// The sun's energy does not depend on the resolution, nor does its place.
TEST(Builtin, SkyHasOneSunAtAnyResolution) {
    const double disc = 2 * kPi * (1 - std::cos(0.2666 * kPi / 180)) * 27500;
    const V3d sun(std::cos(40 * kPi / 180) * 0.5, std::sin(40 * kPi / 180),
                  std::cos(40 * kPi / 180) * std::sqrt(0.75));
    for (int height : {64, 512, 2048}) {
        const Panorama p = builtinProbe("builtin:sky", height);
        double energy = 0;
        float brightest = 0;
        V3d at(0);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < 2 * height; ++x) {
                const float green = p.image.at(x, y)[1];
                if (green > 10) energy += green * latlongPixelSolidAngle(2 * height, height, y);
                if (green <= brightest) continue;
                brightest = green;
                at = *texelDirection(Layout::latlong, 2 * height, height, x + 0.5, y + 0.5);
            }
        }
        EXPECT_NEAR(energy / disc, 1, 0.01) << height;
        EXPECT_LT((at - sun).length(), 3.0 / height + 0.005) << height;
        if (height == 2048) {
            EXPECT_NEAR(brightest / 27500, 1, 0.03); // a pixel inside the disc
        }
    }
}

TEST(Builtin, CompassColoursAndLettersAreWhereTheyBelong) {
    const Panorama p = builtinProbe("builtin:compass", 512);
    // Beside the letters, off the grid: the colour of the direction.
    EXPECT_GT(radianceAt(p, {1, 0.6, 0.1}).x, 0.8);  // +X red
    EXPECT_GT(radianceAt(p, {0.1, 1, 0.6}).y, 0.7);  // +Y green
    EXPECT_GT(radianceAt(p, {0.1, 0.6, 1}).z, 0.9);  // +Z blue
    EXPECT_LT(radianceAt(p, {-1, 0.6, 0.1}).x, 0.2); // the opposites
    EXPECT_LT(radianceAt(p, {0.1, -1, 0.6}).y, 0.2);
    EXPECT_LT(radianceAt(p, {0.1, 0.6, -1}).z, 0.2);

    // In a horizontal cross each cell reads from left to right: the sign's bar, then the letter.
    const Panorama cross = resample(p, Layout::hcross, 100);
    const auto ink = [&](int column, int row, double a, double b) {
        const int x = static_cast<int>((column + 0.5 * (a + 1)) * 100);
        const int y = static_cast<int>((row + 0.5 * (1 - b)) * 100);
        return cross.image.at(x, y)[0] > 2;
    };
    constexpr std::array<std::array<int, 2>, 6> kCells{
        {{0, 1}, {2, 1}, {1, 0}, {1, 2}, {1, 1}, {3, 1}}};
    for (std::size_t face = 0; face < 6; ++face) {
        const int column = kCells[face][0], row = kCells[face][1];
        EXPECT_TRUE(ink(column, row, -0.46, 0.0)) << face;               // left arm of the sign
        EXPECT_EQ(ink(column, row, -0.31, 0.15), face % 2 == 0) << face; // upright of a plus
        EXPECT_TRUE(ink(column, row, 0.3, 0.0)) << face;                 // middle of the letter
        EXPECT_TRUE(ink(column, row, 0.49, 0.3)) << face;                // its upper right
        // Z has a bar above, X and Y do not; X has feet, Y does not.
        EXPECT_EQ(ink(column, row, 0.3, 0.3), face / 2 == 2) << face;
        EXPECT_EQ(ink(column, row, 0.1, -0.3), face / 2 != 1) << face;
        // Z's stroke falls to the left: nothing at the middle right below.
        EXPECT_EQ(ink(column, row, 0.5, -0.2), face / 2 == 0) << face;
    }
}

} // namespace
} // namespace ibl
