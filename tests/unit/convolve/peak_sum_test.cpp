#include "convolve/peak_sum.h"
#include "support/oracle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ibl {
namespace {

/// A pixel's part of the lobe's mass by its edges, which is exact beside all of the mass.
double byEdges(const Peak& peak, int width, int height, const Lobe& lobe, double u, double v) {
    const LobeMassBeyond mass_beyond(lobe);
    const auto q = [&](double h) { return -mass_beyond(h); };
    const Rectangle edges{kPi * peak.row / height, kPi * (peak.row + 1) / height,
                          2 * kPi * peak.column / width, 2 * kPi * (peak.column + 1) / width};
    return rectangleMass(q, 1, {lobeReach(lobe), lobeVariation(lobe)}, makeAxis(u, v), edges);
}

/// By 24 x 24 points, which is exact beside the pixel's part if that is small beside the lobe.
double byPoints(const Peak& peak, int width, int height, const Lobe& lobe, double u, double v) {
    constexpr int kParts = 4;
    const oracle::Rule rule = oracle::gauss(6);
    const V3d x = polarDirection(kPi * v, 2 * kPi * u);
    double mass = 0;
    for (int k = 0; k < kParts * kParts; ++k) {
        for (std::size_t a = 0; a < rule.x.size(); ++a) {
            for (std::size_t b = 0; b < rule.x.size(); ++b) {
                const double row = peak.row + (k / kParts + rule.x[a]) / kParts;
                const double column = peak.column + (k % kParts + rule.x[b]) / kParts;
                const double theta = kPi * row / height;
                const V3d d = polarDirection(theta, 2 * kPi * column / width);
                mass += rule.w[a] * rule.w[b] * std::sin(theta) * lobeValue(lobe, d.dot(x));
            }
        }
    }
    return mass / (kParts * kParts) * (kPi / height) * (2 * kPi / width) / lobeIntegral(lobe);
}

// Near a peak, far from it and across its horizon, of large pixels and small ones.
TEST(PeakSum, IsTheMassOverThePixels) {
    for (const int height : {8, 200, 512}) {
        const int width = 2 * height;
        const std::vector<Peak> peaks{{0, 0, {1, 0, 2}},
                                      {width / 3, height / 3, {0, 3, 0}},
                                      {width - 1, height / 2, {1, 1, 0}},
                                      {width / 2, height - 1, {0, 0, 5}}};
        for (const Lobe lobe :
             {Lobe{Kernel::lambert, 0}, Lobe{Kernel::ggx, 0.125}, Lobe{Kernel::ggx, 0.25},
              Lobe{Kernel::ggx, 0.5}, Lobe{Kernel::ggx, 1}, Lobe{Kernel::phong, 30},
              Lobe{Kernel::charlie, 0.5}}) {
            const PeakSum sum = makePeakSum(peaks, width, height, lobe);
            double error = 0, norm = 0;
            for (int y = 0; y < 6 * 14; ++y) {
                const RowPoints points = rowPoints(Layout::faces, 14, 6 * 14, y, {0, 1});
                std::vector<double> values(3 * points.u.size(), 0.0);
                addPeaks(sum, points, values.data());
                for (std::size_t i = 0; i < points.u.size(); ++i) {
                    V3d expected(0);
                    for (const Peak& peak : peaks) {
                        expected += V3d(peak.excess[0], peak.excess[1], peak.excess[2]) *
                                    (height == 8 ? byEdges : byPoints)(peak, width, height, lobe,
                                                                       points.u[i], points.v[i]);
                    }
                    for (int c = 0; c < 3; ++c) {
                        error += std::pow(values[3 * i + c] - expected[c], 2);
                        norm += std::pow(expected[c], 2);
                    }
                }
            }
            EXPECT_LT(std::sqrt(error / norm), 6e-7)
                << "height " << height << " kernel " << static_cast<int>(lobe.kernel) << " "
                << lobe.parameter;
        }
    }
}

} // namespace
} // namespace ibl
