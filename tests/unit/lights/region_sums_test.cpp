#include "lights/cut_tree.h"

#include "unit/lights/light_probes.h"

#include <gtest/gtest.h>

namespace ibl {
namespace {

/// Pixel by pixel, each integrated by 16 x 16 points.
RegionSums bruteSums(const Image& image, const PixelRegion& r) {
    constexpr int kPoints = 16;
    RegionSums sums;
    for (int j = r.y; j < r.y + r.height; ++j) {
        for (int k = r.x; k < r.x + r.width; ++k) {
            const int i = k % image.width;
            const float* rgb = image.at(i, j);
            const double omega = latlongPixelSolidAngle(image.width, image.height, j);
            sums.solid_angle += omega;
            sums.energy += litLuminance(rgb) * omega;
            sums.irradiance += V3d(rgb[0], rgb[1], rgb[2]) * omega;
            V3d mean(0);
            double weight = 0;
            for (int p = 0; p < kPoints * kPoints; ++p) {
                const double v = (j + (p / kPoints + 0.5) / kPoints) / image.height;
                const double u = (i + (p % kPoints + 0.5) / kPoints) / image.width;
                mean += latlongDirection(u, v) * std::sin(kPi * v);
                weight += std::sin(kPi * v);
            }
            sums.moment += mean / weight * (litLuminance(rgb) * omega);
        }
    }
    return sums;
}

TEST(RegionSums, AreTheirPixelsWhateverTheWidth) {
    Image image = noise(45, 70, 81); // more rows than a band has
    setPixel(image, 7, 20, -3.f, 1.f, -2.f);
    std::vector<PixelRegion> regions{
        {0, 0, 45, 70}, {40, 30, 12, 5}, {44, 69, 1, 1}, {30, 31, 45, 2}, {3, 0, 3, 70}};
    for (int width = 1; width <= 9; ++width) {
        for (const int x : {0, 2, 40 - width, 45 - width, 42})
            regions.push_back({x, 17, width, 30});
    }
    const std::vector<RegionSums> sums = regionSums(image, regions, 3);
    ASSERT_EQ(sums.size(), regions.size());
    for (std::size_t i = 0; i < regions.size(); ++i) {
        const RegionSums expected = bruteSums(image, regions[i]);
        EXPECT_NEAR(sums[i].solid_angle, expected.solid_angle, 1e-12 * expected.solid_angle);
        EXPECT_NEAR(sums[i].energy, expected.energy, 1e-12 * expected.energy);
        EXPECT_LT((sums[i].irradiance - expected.irradiance).length(),
                  1e-12 * expected.irradiance.length())
            << i;
        EXPECT_LT((sums[i].moment - expected.moment).length(), 1e-4 * expected.energy) << i;
    }
}

} // namespace
} // namespace ibl
