#include "convolve/prefilter.h"
#include "panorama/resample.h"
#include "support/contour_oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace ibl {
namespace {

constexpr int kEdge = 6;

struct NarrowLobe {
    Lobe lobe;
    std::function<double(double h)> function;
};

NarrowLobe ggx(double roughness) {
    const double a2 = std::pow(roughness, 4);
    return {{Kernel::ggx, roughness}, [a2](double h) {
                return std::max(0.0, 1 - 2 * h) * a2 / std::pow(a2 + (1 - a2) * h, 2);
            }};
}

NarrowLobe phong(double n) {
    return {{Kernel::phong, n}, [n](double h) { return std::exp(n * std::log1p(-2 * h)); }};
}

NarrowLobe blinnPhong(double n) {
    return {{Kernel::blinnPhong, n}, [n](double h) {
                return std::max(0.0, 1 - 2 * h) * std::exp(0.5 * n * std::log1p(-h));
            }};
}

/// Uneven between 0.1 and 1, with a sun at (7, 3).
Image probeWithSun(float sun) {
    Image probe(20, 10);
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(0.1f, 1);
    for (float& p : probe.pixels)
        p = uniform(random);
    for (int c = 0; c < 3; ++c)
        probe.at(7, 3)[c] = sun;
    return probe;
}

struct Difference {
    double rmse, worst;
};

/// Against the contour oracle at the brightest texels and at some others.
Difference difference(const Image& probe, const NarrowLobe& narrow, Quality quality) {
    const PrefilterRequest request{narrow.lobe, Layout::faces, kEdge};
    const PrefilterResult result =
        prefilter({Layout::latlong, probe}, std::span(&request, 1), optionsFor(quality))[0];
    const Image& map = result.map.image;
    const Image area =
        resample({Layout::latlong, probe}, Layout::faces, kEdge, 0, Enlarging::hold).image;
    std::vector<int> texels(static_cast<std::size_t>(map.height) * kEdge);
    for (std::size_t t = 0; t < texels.size(); ++t)
        texels[t] = static_cast<int>(t);
    std::ranges::sort(texels, std::greater(), [&](int t) { return map.pixels[3 * t]; });
    double mean = 0;
    for (const float p : map.pixels)
        mean += p / double(map.pixels.size());
    const oracle::Potential potential = oracle::makePotential(narrow.function);
    double error = 0, norm = 0, worst = 0;
    for (const std::size_t rank : {0u, 1u, 60u, 177u}) {
        const int x = texels[rank] % kEdge, row = texels[rank] / kEdge;
        const auto change =
            oracle::contourChange(probe, potential, row / kEdge, x, row % kEdge, kEdge);
        for (int c = 0; c < 3; ++c) {
            const double expected = area.at(x, row)[c] + change[c];
            const double off = map.at(x, row)[c] - expected;
            error += off * off;
            norm += expected * expected;
            worst = std::max(worst, std::abs(off) / std::max(expected, mean));
        }
    }
    EXPECT_LE(std::sqrt(error / norm), result.error_bound) << narrow.lobe.parameter;
    return {std::sqrt(error / norm), worst};
}

TEST(NarrowTruth, MeansOverTexelsKeepTheAskedError) {
    const Image plain = probeWithSun(1), sunny = probeWithSun(1e5f);
    const std::pair<const Image&, NarrowLobe> cases[] = {
        {plain, ggx(1e-4)}, {plain, ggx(0.01)}, {plain, phong(1e5)},      {sunny, ggx(1e-3)},
        {sunny, ggx(0.03)}, {sunny, ggx(0.08)}, {sunny, blinnPhong(1e6)},
    };
    for (const auto& [probe, lobe] : cases) {
        const Difference standard = difference(probe, lobe, Quality::standard);
        EXPECT_LE(standard.rmse, 1e-4) << lobe.lobe.parameter;
        EXPECT_LE(standard.worst, 1e-3) << lobe.lobe.parameter;
    }
}

TEST(NarrowTruth, HighIsTenTimesMoreExact) {
    for (const float sun : {1.0f, 1e5f, 1e9f}) {
        for (const double roughness : {0.003, 0.03, 0.06})
            EXPECT_LE(difference(probeWithSun(sun), ggx(roughness), Quality::high).rmse, 1e-6)
                << sun << " " << roughness;
    }
}

TEST(NarrowTruth, ReferenceSumsOverOutlines) {
    for (const float sun : {1.0f, 1e9f}) {
        for (const NarrowLobe& lobe : {ggx(0.02), phong(200)})
            EXPECT_LE(difference(probeWithSun(sun), lobe, Quality::reference).rmse, 2e-7)
                << lobe.lobe.parameter << " " << sun;
    }
}

/// Texels at a pole, beside it and farther away; at the seam and beside a sun.
TEST(NarrowTruth, TexelsOfLatLongMapsHaveCurvedSides) {
    const Image probe = probeWithSun(10);
    constexpr int kHeight = 12, kWidth = 24;
    for (const double roughness : {0.005, 0.04}) {
        const NarrowLobe narrow = ggx(roughness);
        const PrefilterRequest request{narrow.lobe, Layout::latlong, kHeight};
        const Panorama source{Layout::latlong, probe};
        const Image map =
            prefilter(source, std::span(&request, 1), optionsFor(Quality::high))[0].map.image;
        const Image area = resample(source, Layout::latlong, kHeight, 0, Enlarging::hold).image;
        const oracle::Potential potential = oracle::makePotential(narrow.function);
        for (const auto& [x, y] : {std::pair{5, 0}, {0, 1}, {8, 4}, {9, 3}, {23, 6}, {14, 11}}) {
            const auto change =
                oracle::latlongContourChange(probe, potential, x, y, kWidth, kHeight);
            for (int c = 0; c < 3; ++c) {
                const double expected = area.at(x, y)[c] + change[static_cast<std::size_t>(c)];
                EXPECT_NEAR(map.at(x, y)[c] / expected, 1, 2e-6)
                    << roughness << " at " << x << " " << y;
            }
        }
    }
}

} // namespace
} // namespace ibl
