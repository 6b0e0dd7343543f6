#include "convolve/direct.h"
#include "convolve/prefilter.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"
#include "support/oracle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

namespace ibl {
namespace {

constexpr double kPi = 3.14159265358979323846;

Image noise(int width, int height) {
    Image probe(width, height);
    std::mt19937 random(4);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (float& p : probe.pixels)
        p = uniform(random);
    return probe;
}

oracle::Direction directionAt(double u, double v) {
    const double phi = 2 * kPi * (0.5 - u), theta = kPi * v;
    return {std::sin(theta) * std::sin(phi), std::cos(theta), std::sin(theta) * std::cos(phi)};
}

struct NarrowCase {
    Lobe lobe;
    oracle::LobeFunction function;
    double width;
};

std::vector<NarrowCase> narrowCases() {
    std::vector<NarrowCase> cases;
    for (const double r : {0.004, 0.05}) {
        cases.push_back({{Kernel::ggx, r}, oracle::ggx(r), 0.5 * r * r});
    }
    for (const double n : {1e6}) {
        cases.push_back({{Kernel::phong, n}, oracle::phong(n), 0.3 / std::sqrt(n)});
    }
    return cases;
}

/// Places where something may go wrong: poles, seam, pixel corners and edges, and anywhere.
const std::pair<double, double> kPlaces[] = {
    {0.5, 0.0},    {0.123, 1.0},    {0.25, 0.5},   {0.0, 0.25},      {1.0, 0.501},
    {0.3751, 0.3}, {0.6249, 0.001}, {0.7, 0.9999}, {0.50001, 0.437}, {0.811, 0.0625}};

TEST(Direct, SumIsTheLobesMean) {
    const Image probe = noise(11, 6);
    std::vector<NarrowCase> cases = narrowCases();
    cases.push_back({{Kernel::lambert, 0}, oracle::lambert(), 0.1});
    cases.push_back({{Kernel::ggx, 0.5}, oracle::ggx(0.5), 0.1});
    cases.push_back({{Kernel::ggx, 1}, oracle::ggx(1), 0.1});
    cases.push_back({{Kernel::blinnPhong, 12}, oracle::blinnPhong(12), 0.1});
    for (const double r : {0.05, 1.0})
        cases.push_back({{Kernel::charlie, r}, oracle::charlie(r), 0.1});
    for (const NarrowCase& c : cases) {
        const DirectSum direct = makeDirectSum(c.lobe, probe, 1);
        for (const auto& [u, v] : kPlaces) {
            double value[3] = {};
            addDirect(direct, makeAxis(u, v), value);
            const auto expected =
                oracle::convolveNarrow(probe, c.function, c.width, directionAt(u, v));
            for (int ch = 0; ch < 3; ++ch) {
                EXPECT_NEAR(value[ch], expected[ch], 2e-5)
                    << c.lobe.parameter << " at " << u << " " << v;
            }
        }
    }
}

/// Mean over a texel of the direct sum, at n x n points. A lobe narrower than their spacing sees
/// the pixels' edges as steps, which points meet badly: then only its difference from the probe
/// itself is taken at the points, and the mean of that is the area filter's.
V3d footprintMean(const Image& probe, const Image& area, const Lobe& lobe, int face, int x, int y,
                  int edge, int n) {
    const DirectSum direct = makeDirectSum(lobe, probe, 1);
    const bool steps = lobeWidth(lobe) < 0.5 * kPi / edge / n;
    V3d mean(0);
    double total = 0;
    for (int p = 0; p < n * n; ++p) {
        const double i = x - 0.5 + (p % n + 0.5) / n, j = y - 0.5 + (p / n + 0.5) / n;
        const oracle::Direction d = oracle::cubeDirection(face, i, j, edge);
        const V2d at = latlongPoint({d.x, d.y, d.z});
        double value[3] = {};
        addDirect(direct, makeAxis(at.x, at.y), value);
        const double w = oracle::cubeWeight(i, j, edge);
        V3d point(value[0], value[1], value[2]);
        if (steps) {
            const float* own = probe.at(std::min(int(at.x * probe.width), probe.width - 1),
                                        std::min(int(at.y * probe.height), probe.height - 1));
            point -= V3d(own[0], own[1], own[2]);
        }
        mean += point * w;
        total += w;
    }
    const float* own = area.at(x, face * edge + y);
    return mean / total + (steps ? V3d(own[0], own[1], own[2]) : V3d(0));
}

/// Relative RMSE of a map of faces against footprint means at texels a prime step apart.
double footprintError(const Image& probe, const PrefilterRequest& request, const Image& map,
                      int n) {
    const int texels = 6 * request.size * request.size, step = 23;
    const Image area = resample({Layout::latlong, probe}, Layout::faces, request.size, 0).image;
    double error = 0, norm = 0;
    for (int t = 3; t < texels; t += step) {
        const int x = t % request.size, row = t / request.size;
        const V3d expected = footprintMean(probe, area, request.lobe, row / request.size, x,
                                           row % request.size, request.size, n);
        for (int c = 0; c < 3; ++c) {
            error += std::pow(map.at(x, row)[c] - expected[c], 2);
            norm += expected[c] * expected[c];
        }
    }
    return std::sqrt(error / norm);
}

// Texels are larger than pixels here: where they are smaller, what the lobe leaves alone is
// interpolated, as roughness 0 is.
TEST(Narrow, TexelLargerThanTheLobeGetsTheMeanOverItsFootprint) {
    const Image probe = noise(24, 12);
    for (const double roughness : {0.05, 0.03, 0.01}) {
        const PrefilterRequest request{{Kernel::ggx, roughness}, Layout::faces, 4};
        const PrefilterResult result =
            prefilter({Layout::latlong, probe}, std::span(&request, 1), {})[0];
        // The points' own error, where pixels' edges pass between them, is 2e-3 to 5e-3.
        EXPECT_LT(footprintError(probe, request, result.map.image, 48), 6e-3 + result.error_bound)
            << roughness << " bound " << result.error_bound;
    }
}

TEST(Narrow, ASunLeavesNoRingAndKeepsItsEnergy) {
    Image probe = noise(24, 12);
    double total = 0;
    for (int c = 0; c < 3; ++c)
        probe.at(7, 4)[c] = 1e5f;
    for (int j = 0; j < 12; ++j) {
        for (int i = 0; i < 24; ++i)
            total += probe.at(i, j)[0] * latlongPixelSolidAngle(24, 12, j);
    }
    for (const double roughness : {0.05, 0.01}) {
        const PrefilterRequest request{{Kernel::ggx, roughness}, Layout::faces, 4};
        const PrefilterResult result =
            prefilter({Layout::latlong, probe}, std::span(&request, 1), {})[0];
        const Image& map = result.map.image;
        double energy = 0;
        float least = map.pixels[0];
        for (int row = 0; row < map.height; ++row) {
            for (int x = 0; x < 4; ++x) {
                energy += map.at(x, row)[0] * cubeTexelSolidAngle(x, row % 4, 4);
                least = std::min(least, map.at(x, row)[0]);
            }
        }
        EXPECT_GT(result.peaks_split, 0);
        EXPECT_NEAR(energy / total, 1, 1e-3) << roughness;
        EXPECT_GT(least, 0.1)
            << roughness; // means of noise from 0 to 1: a ring would be clamped to 0
        EXPECT_LT(footprintError(probe, request, map, 48), 1e-2) << roughness;
    }
}

TEST(Narrow, GoesOverIntoTheAreaFilteredProbe) {
    const Image probe = noise(32, 16);
    const Panorama area = resample({Layout::latlong, probe}, Layout::faces, 2, 0);
    double last = 1;
    for (const double roughness : {0.03, 0.01, 0.001, 0.0}) {
        const PrefilterRequest request{{Kernel::ggx, roughness}, Layout::faces, 2};
        const PrefilterResult result =
            prefilter({Layout::latlong, probe}, std::span(&request, 1), {})[0];
        double sum = 0;
        for (std::size_t i = 0; i < area.image.pixels.size(); ++i) {
            sum += std::pow(result.map.image.pixels[i] - area.image.pixels[i], 2);
        }
        const double difference = std::sqrt(sum / double(area.image.pixels.size()));
        EXPECT_TRUE(difference < last || difference == 0) << roughness;
        last = difference;
        if (roughness == 0) {
            EXPECT_EQ(difference, 0);
        } else {
            EXPECT_LT(difference, 0.7 * roughness);
        }
    }
}

} // namespace
} // namespace ibl
