#include "convolve/direct.h"
#include "convolve/near_weights.h"
#include "convolve/peaks.h"
#include "convolve/prefilter.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"
#include "panorama/square_maps.h"
#include "support/oracle.h"
#include "unit/panorama/probes.h"

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
    {0.5, 0.0},      {0.123, 1.0},  {0.25, 0.5},      {0.0, 0.25},     {1.0, 0.501}, {0.3751, 0.3},
    {0.6249, 0.001}, {0.7, 0.9999}, {0.50001, 0.437}, {0.811, 0.0625}, {0.0, 0.0},   {1.0, 1.0}};

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
    const Image area =
        resample({Layout::latlong, probe}, Layout::faces, request.size, 0, Enlarging::hold).image;
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
        EXPECT_NEAR(energy / total, 1, 1e-5) << roughness;
        EXPECT_GT(least, 0.1)
            << roughness; // means of noise from 0 to 1: a ring would be clamped to 0
        EXPECT_LT(footprintError(probe, request, map, 48), 1e-2) << roughness;
    }
}

// Where its texels are smaller than pixels too, as means over them: no energy is lost.
TEST(Narrow, GoesOverIntoTheAreaFilteredProbe) {
    const Image probe = noise(32, 16);
    for (const int size : {2, 16}) {
        const Panorama area =
            resample({Layout::latlong, probe}, Layout::faces, size, 0, Enlarging::hold);
        double last = 1;
        for (const double roughness : {0.03, 0.01, 0.001, 0.0}) {
            const PrefilterRequest request{{Kernel::ggx, roughness}, Layout::faces, size};
            const PrefilterResult result =
                prefilter({Layout::latlong, probe}, std::span(&request, 1), {})[0];
            double sum = 0;
            for (std::size_t i = 0; i < area.image.pixels.size(); ++i) {
                sum += std::pow(result.map.image.pixels[i] - area.image.pixels[i], 2);
            }
            const double difference = std::sqrt(sum / double(area.image.pixels.size()));
            EXPECT_TRUE(difference < last || difference == 0) << size << " " << roughness;
            last = difference;
            if (roughness == 0) {
                EXPECT_EQ(difference, 0);
                const V3d before = test::energy({Layout::latlong, probe});
                const V3d after = test::energy(result.map);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(after[c] / before[c], 1, 1e-7) << size;
            } else {
                EXPECT_LT(difference, 0.7 * roughness) << size;
            }
        }
    }
}

/// The kernel's mean over a texel and a pixel that do not touch, by n^2 points in each, times the
/// pixel's solid angle.
double meanOfKernel(const NearKernel& kernel, const RowPoints& texel, int width, int height,
                    int column, int row, int n) {
    const oracle::Rule rule = oracle::gauss(n);
    double sum = 0, total = 0;
    for (int a = 0; a < n; ++a) {
        for (int b = 0; b < n; ++b) {
            const double theta = kPi * (row + rule.x[a]) / height;
            const V3d d = polarDirection(theta, 2 * kPi * (column + rule.x[b]) / width);
            const double w = rule.w[a] * rule.w[b] * std::sin(theta);
            for (std::size_t t = 0; t < texel.u.size(); ++t) {
                const V3d x = polarDirection(kPi * texel.v[t], 2 * kPi * texel.u[t]);
                sum += w * texel.share[t] * kernel.value(0.25 * (d - x).length2());
            }
            total += w;
        }
    }
    return sum / total * latlongPixelSolidAngle(width, height, row);
}

TEST(Narrow, WeightsOfPixelsAreTheKernelsMeans) {
    constexpr int kWidth = 256, kHeight = 128;
    for (const double roughness : {0.02, 0.05}) {
        const Lobe lobe{Kernel::ggx, roughness};
        const std::vector<double> k = zonalCoefficients(lobe, 576);
        const LobeSplit split = splitLobe(lobe, k, 512, 1e-5);
        const NearField field = makeNearField(split.near, nearRules(1e-5), kWidth, kHeight, 1);
        for (const int size : {64, 256}) { // footprints whole, and for 0.05 at 256 shrunk
            const MapExtent map{Layout::faces, size, 6 * size, 0.5 * kPi / size};
            const Footprint footprint = footprintOf(lobe, map.texel, kAnyDegree);
            for (const int y : {size / 3, 2 * size + size / 2, 5 * size - 1}) {
                const int x = size / 4;
                const NearWeights weights = nearWeights(field, map, x, y, footprint);
                const RowPoints points = texelPoints(map, x, y, {footprint.scale, 8});
                const V3d centre = texelPlace(map, x, y, V2d(0));
                double sum = weights.area;
                for (std::size_t i = 0; i < weights.weight.size(); ++i) {
                    sum += weights.weight[i];
                    const int row = weights.row + static_cast<int>(i) / weights.columns;
                    const int column = weights.column + static_cast<int>(i) % weights.columns;
                    const V3d pixel = polarDirection(kPi * (row + 0.5) / kHeight,
                                                     2 * kPi * (column + 0.5) / kWidth);
                    const double distance = (pixel - centre).length();
                    if (distance < 0.75 * (map.texel + kPi / kHeight) || distance > 0.06) continue;
                    const double expected =
                        meanOfKernel(split.near, points, kWidth, kHeight, column, row, 8);
                    EXPECT_NEAR(weights.weight[i], expected, 5e-7 + 2e-5 * expected)
                        << roughness << " " << size << " " << y << " at " << distance;
                }
                EXPECT_NEAR(sum, split.near.mass, 1e-12);
            }
        }
    }
}

/// Where a lone sun of 1e9 in black is awkward: at a pole, at the seam, at an edge and a corner of
/// faces.
TEST(Narrow, LoneSunsKeepTheirEnergyAndNothingIsNegative) {
    for (const auto& [column, row] : {std::pair{3, 0}, {0, 50}, {96, 64}, {31, 45}, {127, 127}}) {
        Image probe(128, 128);
        std::fill(probe.pixels.begin(), probe.pixels.end(), 0.0f);
        for (int c = 0; c < 3; ++c)
            probe.at(column, row)[c] = 1e9f;
        const double total = 1e9 * latlongPixelSolidAngle(128, 128, row);
        for (const double roughness : {0.03, 0.055}) {
            const PrefilterRequest request{{Kernel::ggx, roughness}, Layout::faces, 32};
            const Image map =
                prefilter({Layout::latlong, probe}, std::span(&request, 1), {})[0].map.image;
            double energy = 0;
            for (int y = 0; y < map.height; ++y) {
                for (int x = 0; x < map.width; ++x) {
                    energy += map.at(x, y)[1] * cubeTexelSolidAngle(x, y % 32, 32);
                    EXPECT_GE(map.at(x, y)[1], 0);
                }
            }
            EXPECT_NEAR(energy / total, 1, 1e-4) << column << " " << row << " " << roughness;
        }
    }
}

/// Turns and reflections that save weights must not be seen: a width of 25 has none but the
/// reflections; dividing its pixels by four makes it a width with all of them.
TEST(Narrow, WeightsAreSharedOnlyAmongTexelsThatAreAlike) {
    const Image coarse = noise(25, 16);
    Image fine(100, 16);
    for (int j = 0; j < 16; ++j) {
        for (int i = 0; i < 100; ++i)
            std::copy_n(coarse.at(i / 4, j), 3, fine.at(i, j));
    }
    for (const Layout layout : {Layout::faces, Layout::latlong, Layout::vcross, Layout::angular,
                                Layout::mirrorBall, Layout::octahedral}) {
        const PrefilterRequest request{{Kernel::ggx, 0.04}, layout, 10};
        const auto map = [&](const Image& probe) {
            return prefilter({Layout::latlong, probe}, std::span(&request, 1), {})[0].map.image;
        };
        const Image a = map(coarse), b = map(fine);
        for (std::size_t i = 0; i < a.pixels.size(); ++i)
            ASSERT_NEAR(a.pixels[i], b.pixels[i], isSquareMap(layout) ? 4e-4 : 2e-5)
                << static_cast<int>(layout) << " " << i;
    }
}

} // namespace
} // namespace ibl
