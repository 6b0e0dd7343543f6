#include "lights/cut_lights.h"
#include "lights/lights_json.h"

#include "unit/lights/light_probes.h"

#include <gtest/gtest.h>

namespace ibl {
namespace {

std::vector<Light> medianLights(const Image& image, int count, int threads = 2) {
    LightRequest request;
    request.count = count;
    return cutLights(image, request, threads).lights;
}

std::vector<PixelRegion> medianRegions(const SummedAreaTable& table, int count) {
    const CutTree tree = medianCut(table, count, 2);
    std::vector<PixelRegion> regions;
    for (const int node : leavesOf(tree, tree.cut.size()))
        regions.push_back(tree.nodes[node]);
    return regions;
}

void expectEnergyKept(const Image& image, int count) {
    const std::vector<Light> lights = medianLights(image, count);
    const V3d total = totalIrradiance(lights);
    const auto expected = integral(image);
    double solid_angle = 0;
    for (const Light& light : lights) {
        EXPECT_NEAR(light.direction.length(), 1, 1e-12);
        solid_angle += light.solid_angle;
    }
    for (int c = 0; c < 3; ++c) {
        EXPECT_NEAR(total[c], static_cast<double>(expected[c]),
                    1e-12 * std::abs(static_cast<double>(expected[c])))
            << "count " << count;
    }
    EXPECT_LE(solid_angle, 4 * kPi * (1 + 1e-12));
}

TEST(SummedArea, RectanglesAreTheirPixelsSums) {
    const Image image = noise(37, 19, 1);
    const auto sumOver = [&](const PixelRegion& r) {
        double sum = 0;
        for (int j = r.y; j < r.y + r.height; ++j) {
            for (int i = r.x; i < r.x + r.width; ++i) {
                const float* rgb = image.at(i % 37, j);
                sum += (0.2125 * rgb[0] + 0.7154 * rgb[1] + 0.0721 * rgb[2]) *
                       latlongPixelSolidAngle(37, 19, j);
            }
        }
        return sum;
    };
    const auto expectSums = [&](const SummedAreaTable& table,
                                std::initializer_list<PixelRegion> regions) {
        for (const PixelRegion& r : regions) {
            const double sum = sumOver(table.pixels(r));
            EXPECT_NEAR(static_cast<double>(table.energy(r)) / table.unitsPerEnergy(), sum,
                        1e-12 * sum);
        }
    };
    expectSums(SummedAreaTable(image, 0, 2),
               {PixelRegion{0, 0, 37, 19}, PixelRegion{5, 3, 7, 9}, PixelRegion{30, 0, 20, 19},
                PixelRegion{36, 18, 1, 1}});
    // Blocks of 2 x 2 pixels, of which the last column and row have one.
    expectSums(SummedAreaTable(image, 1, 2),
               {PixelRegion{0, 0, 19, 10}, PixelRegion{3, 2, 7, 5}, PixelRegion{15, 0, 10, 10},
                PixelRegion{18, 9, 1, 1}});
}

TEST(SummedArea, DimRegionBesideASunIsNotLost) {
    Image image = filled(256, 128, 1e-3f);
    setPixel(image, 10, 5, 1e9f, 1e9f, 1e9f);
    const SummedAreaTable table(image, 0, 2);
    // Right of and below the sun, so that every table entry used contains it.
    const PixelRegion dim{200, 60, 3, 2};
    const double expected =
        1e-3 * 3 * (latlongPixelSolidAngle(256, 128, 60) + latlongPixelSolidAngle(256, 128, 61));
    EXPECT_NEAR(static_cast<double>(table.energy(dim)) / table.unitsPerEnergy(), expected,
                1e-4 * expected);
}

TEST(MedianCut, KeepsEnergyForEveryCount) {
    for (const int count : {1, 2, 3, 7, 64, 100, 1024}) {
        expectEnergyKept(noise(64, 32, 7), count);
    }
    expectEnergyKept(noise(101, 53, 8), 50);
    expectEnergyKept(noise(3, 2, 9), 50);
    expectEnergyKept(noise(1, 1, 10), 4);
}

TEST(MedianCut, KeepsEnergyBesideASun) {
    Image image = filled(128, 64, 1e-3f);
    setPixel(image, 0, 0, 1e9f, 5e8f, 1e8f);
    expectEnergyKept(image, 64);
}

TEST(MedianCut, NegativePixelsCountInTheColours) {
    Image image = filled(64, 32, 1.f);
    setPixel(image, 20, 16, -100.f, -50.f, -10.f);
    expectEnergyKept(image, 16);
}

TEST(MedianCut, GivesTheCountAsked) {
    const Image image = noise(64, 32, 3);
    for (const int count : {1, 2, 5, 16, 33, 512}) {
        EXPECT_EQ(medianLights(image, count).size(), static_cast<std::size_t>(count));
    }
}

/// Large probes are cut in blocks of 2 x 2 pixels, unless these are too few.
TEST(MedianCut, LargeProbesKeepEnergyAndCountAndAreCutWithinAPixel) {
    Image image = filled(1536, 768, 1);
    for (const Light& light : medianLights(image, 64)) {
        // A pixel more or less along one side of a region of 192 x 96.
        EXPECT_NEAR(light.solid_angle, 4 * kPi / 64, 4 * kPi / 64 / 16);
    }
    expectEnergyKept(image, 100);
    std::ranges::fill(image.pixels, 0.0f);
    for (int k = 0; k < 4; ++k)
        setPixel(image, 700 + k % 2, 300 + k / 2, 1e9f, 1e9f, 1e9f);
    EXPECT_EQ(medianLights(image, 4).size(), 4u); // all within one block
}

TEST(MedianCut, UniformProbeGivesRegionsOfEqualSolidAngle) {
    const Image image = filled(512, 256, 0.7f);
    for (const int count : {2, 4, 16, 64, 256, 1024}) {
        for (const Light& light : medianLights(image, count)) {
            // Within one row and one column of the region's own pixels.
            const double width =
                (light.region->longitude[1] - light.region->longitude[0]) / 360 * 512;
            const double height =
                (light.region->latitude[1] - light.region->latitude[0]) / 180 * 256;
            const double pixel = light.solid_angle / std::lround(width) / std::lround(height);
            EXPECT_NEAR(light.solid_angle, 4 * kPi / count, (width + height) * pixel) << count;
        }
    }
}

TEST(MedianCut, FewerCutsAreAPrefixOfMore) {
    const SummedAreaTable table(noise(64, 32, 21), 0, 2);
    const CutTree few = medianCut(table, 37, 1), many = medianCut(table, 200, 2);
    ASSERT_LT(few.cut.size(), many.cut.size());
    EXPECT_TRUE(std::equal(few.cut.begin(), few.cut.end(), many.cut.begin()));
}

TEST(MedianCut, BetweenPowersOfTwoTheHeaviestAreCut) {
    const SummedAreaTable table(noise(64, 32, 22), 0, 2);
    std::vector<std::int64_t> four, six;
    for (const PixelRegion& r : medianRegions(table, 4))
        four.push_back(table.energy(r));
    for (const PixelRegion& r : medianRegions(table, 6))
        six.push_back(table.energy(r));
    std::sort(four.rbegin(), four.rend());
    // The two lightest of four are there still, the two heaviest are not.
    for (int i = 0; i < 4; ++i)
        EXPECT_EQ(std::count(six.begin(), six.end(), four[i]), i < 2 ? 0 : 1) << i;
}

TEST(MedianCut, CutsAreAsEvenAsPixelsAllow) {
    const Image image = noise(256, 128, 4);
    const SummedAreaTable table(image, 0, 1);
    const auto regions = medianRegions(table, 16);
    const double share = static_cast<double>(table.energy({0, 0, 256, 128})) / 16;
    for (const PixelRegion& r : regions) {
        EXPECT_NEAR(static_cast<double>(table.energy(r)), share, 0.2 * share);
    }
}

TEST(MedianCut, TheLongerSideIsMeasuredWhereTheLightIs) {
    // All light in a band of rows: as long as its energy's parallel, 2 pi cos(latitude), against
    // the height pi. At 70 degrees it is the shorter side, at 40 the longer, whatever the middle
    // latitude of the region, 0, says.
    for (const auto& [row, across] : {std::pair{14, false}, {36, true}}) {
        Image image = filled(256, 128, 0.f);
        for (int y = row - 1; y <= row + 1; ++y) {
            for (int x = 0; x < 256; ++x)
                setPixel(image, x, y, 1.f, 1.f, 1.f);
        }
        const auto regions = medianRegions(SummedAreaTable(image, 0, 1), 2);
        EXPECT_EQ(regions[0].height == 128, across) << row;
    }
}

TEST(MedianCut, OneLampIsFoundAtItsPixelsCentroid) {
    for (const auto& [x, y] : {std::pair{100, 40}, {0, 40}, {255, 127}, {7, 0}}) {
        Image image = filled(256, 128, 0.f);
        setPixel(image, x, y, 10.f, 20.f, 30.f);
        const std::vector<Light> lights = medianLights(image, 16);
        ASSERT_EQ(lights.size(), 1u);
        const V3d expected = latlongDirection((x + 0.5) / 256, (y + 0.5) / 128);
        EXPECT_GT(lights[0].direction.dot(expected), 1 - 1e-5);
        const double omega = latlongPixelSolidAngle(256, 128, y);
        EXPECT_NEAR(lights[0].irradiance.x, 10 * omega, 1e-12);
        EXPECT_NEAR(lights[0].solid_angle, omega, 1e-12);
    }
}

TEST(MedianCut, ASunAcrossTheSeamStaysWhole) {
    Image image = filled(64, 32, 1e-3f);
    for (const int x : {62, 63, 0, 1})
        setPixel(image, x, 16, 1000.f, 1000.f, 1000.f);
    // One light: its centroid is the sun's middle, on the -Z side, not the image's middle.
    const std::vector<Light> lights = medianLights(image, 1, 1);
    ASSERT_EQ(lights.size(), 1u);
    EXPECT_LT(lights[0].direction.z, -0.99);
    // And the circle is opened elsewhere than through the sun.
    const auto regions = medianRegions(SummedAreaTable(image, 0, 1), 1);
    EXPECT_EQ(regions[0].x, 2);
}

TEST(MedianCut, BlackProbeHasNoLights) {
    EXPECT_TRUE(medianLights(filled(64, 32, 0.f), 16).empty());
}

TEST(MedianCut, SameLightsForAnyThreadCount) {
    const Image image = noise(301, 150, 5);
    LightSet one, five;
    one.lights = medianLights(image, 77, 1);
    five.lights = medianLights(image, 77, 5);
    EXPECT_EQ(lightsJson(one, 1), lightsJson(five, 5));
}

TEST(MedianCut, DirectionsLieInTheirRegions) {
    for (const Light& light : medianLights(noise(256, 128, 6), 256)) {
        const double latitude = std::asin(light.direction.y) * 180 / kPi;
        double longitude = std::atan2(light.direction.x, light.direction.z) * 180 / kPi;
        if (longitude < light.region->longitude[0]) longitude += 360;
        EXPECT_GE(longitude, light.region->longitude[0] - 1e-9);
        EXPECT_LE(longitude, light.region->longitude[1] + 1e-9);
        // The centroid of a wide region bulges towards the nearer pole, by less than 20 degrees.
        EXPECT_GE(latitude, light.region->latitude[0] - 20);
        EXPECT_LE(latitude, light.region->latitude[1] + 20);
    }
}

} // namespace
} // namespace ibl
