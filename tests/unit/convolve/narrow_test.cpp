#include "convolve/narrow.h"

#include "convolve/analysis.h"
#include "convolve/prefilter.h"
#include "convolve/synthesis.h"
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

TEST(Narrow, SmoothPartAndCoreAreTheLobe) {
    for (const auto& [width, height] : {std::pair{23, 10}}) {
        const Image probe = noise(width, height);
        const int degree = 96;
        const Harmonics f = analyse(
            analyseRows(probe, 1, std::numeric_limits<double>::infinity(), degree, 0), degree, 0);
        for (const NarrowCase& c : narrowCases()) {
            const std::vector<double> k = smoothCoefficients(c.lobe, degree);
            const LobeCore core = makeCore(c.lobe, k, 0, 1e-7);
            const SmoothField field = synthesise(f, k, degree, 0);
            for (const auto& [u, v] : kPlaces) {
                float smooth[3];
                sampleField(field, &u, &v, 1, smooth);
                double value[3] = {smooth[0], smooth[1], smooth[2]};
                addCore(core, probe, 1, makeAxis(u, v), value);
                const auto expected =
                    oracle::convolveNarrow(probe, c.function, c.width, directionAt(u, v));
                for (int ch = 0; ch < 3; ++ch) {
                    EXPECT_NEAR(value[ch], expected[ch], 2e-5)
                        << width << " " << c.lobe.parameter << " at " << u << " " << v;
                }
            }
        }
    }
}

TEST(Narrow, WholeCoreIsTheLobe) {
    const Image probe = noise(11, 6);
    std::vector<NarrowCase> cases = narrowCases();
    cases.push_back({{Kernel::lambert, 0}, oracle::lambert(), 0.1});
    cases.push_back({{Kernel::ggx, 0.5}, oracle::ggx(0.5), 0.1});
    cases.push_back({{Kernel::ggx, 1}, oracle::ggx(1), 0.1});
    for (const NarrowCase& c : cases) {
        const LobeCore core = makeWholeCore(c.lobe);
        for (const auto& [u, v] : kPlaces) {
            double value[3] = {};
            addCore(core, probe, 1, makeAxis(u, v), value);
            const auto expected =
                oracle::convolveNarrow(probe, c.function, c.width, directionAt(u, v));
            for (int ch = 0; ch < 3; ++ch) {
                EXPECT_NEAR(value[ch], expected[ch], 2e-5)
                    << c.lobe.parameter << " at " << u << " " << v;
            }
        }
    }
}

TEST(Narrow, TexelLargerThanTheLobeGetsTheMeanOverItsFootprint) {
    const Image probe = noise(16, 8);
    const int edge = 4, n = 16;
    for (const double roughness : {0.15}) {
        const PrefilterRequest request{{Kernel::ggx, roughness}, Layout::faces, edge};
        const PrefilterResult result = prefilter(probe, std::span(&request, 1), {})[0];
        for (const auto& [face, x, y] : {std::tuple{5, 1, 2}}) {
            std::array<double, 3> mean{};
            double total = 0;
            for (int a = 0; a < n * n; ++a) {
                const double i = x - 0.5 + (a % n + 0.5) / n, j = y - 0.5 + (a / n + 0.5) / n;
                const double w = oracle::cubeWeight(i, j, edge);
                const auto value = oracle::convolveNarrow(probe, oracle::ggx(roughness),
                                                          0.5 * roughness * roughness,
                                                          oracle::cubeDirection(face, i, j, edge));
                for (int c = 0; c < 3; ++c)
                    mean[c] += w * value[c];
                total += w;
            }
            for (int c = 0; c < 3; ++c) {
                EXPECT_NEAR(result.map.image.at(x, face * edge + y)[c], mean[c] / total, 4e-3)
                    << roughness << " face " << face;
            }
        }
    }
}

TEST(Narrow, GoesOverIntoTheAreaFilteredProbe) {
    const Image probe = noise(32, 16);
    const Panorama area = resample({Layout::latlong, probe}, Layout::faces, 2, 0);
    double last = 1;
    for (const double roughness : {0.03, 0.01, 0.001, 0.0}) {
        const PrefilterRequest request{{Kernel::ggx, roughness}, Layout::faces, 2};
        const PrefilterResult result = prefilter(probe, std::span(&request, 1), {})[0];
        double sum = 0;
        for (std::size_t i = 0; i < area.image.pixels.size(); ++i) {
            sum += std::pow(result.map.image.pixels[i] - area.image.pixels[i], 2);
        }
        const double difference = std::sqrt(sum / double(area.image.pixels.size()));
        EXPECT_LT(difference, last) << roughness;
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
