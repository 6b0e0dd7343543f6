#include "convolve/sh_window.h"

#include "core/error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ibl {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Radiance coefficients of point lights: Y(l, m) at each, and a constant.
ShCoefficients lights(int order, const std::vector<V3d>& directions, double constant = 0) {
    ShCoefficients sh{ShConvention::radiance, order, {}};
    sh.values.resize(static_cast<std::size_t>(order) * order);
    std::vector<double> basis(sh.values.size());
    for (std::size_t k = 0; k < directions.size(); ++k) {
        shBasis(order, directions[k].normalized(), basis);
        for (std::size_t i = 0; i < basis.size(); ++i) {
            for (int c = 0; c < 3; ++c)
                sh.values[i][c] += basis[i] * (c == 2 && k == 1 ? 3 : 1);
        }
    }
    for (double& v : sh.values[0])
        v += constant * std::sqrt(4 * kPi);
    return sh;
}

/// Least and largest value on a grid of its own.
std::pair<double, double> range(const ShCoefficients& sh) {
    double least = 1e300, most = -1e300;
    for (int j = 0; j <= 180; ++j) {
        for (int i = 0; i < 360; ++i) {
            const double t = kPi * j / 180, p = kPi * i / 180;
            for (const double v : evaluateSh(
                     sh, {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)})) {
                least = std::min(least, v);
                most = std::max(most, v);
            }
        }
    }
    return {least, most};
}

double leastOf(const ShCoefficients& sh) {
    return std::ranges::min(leastOverSphere(sh));
}

void expectLeastDamping(const ShCoefficients& sh) {
    const double lambda = leastDamping(sh);
    ASSERT_GT(lambda, 0);
    const auto [least, most] = range(damp(sh, lambda));
    EXPECT_GE(least, -1e-7 * most);
    EXPECT_GE(leastOf(damp(sh, lambda)), -1e-7 * most);
    EXPECT_LT(leastOf(damp(sh, 0.98 * lambda)), -1e-7 * most);
}

TEST(ShWindow, LeastValueIsTheClosedOne) {
    // A sun's 3 bands along t = cos: (1 + 3 t + 5/2 (3 t^2 - 1)) / (4 pi), least at t = -1/5.
    const V3d sun(0.3, 0.5, -0.7);
    EXPECT_NEAR(leastOf(lights(3, {sun})), (1 - 2.5 - 0.3) / (4 * kPi), 1e-11);
    const ShCoefficients high = lights(20, {sun, V3d(-1, 0.2, 0.1)});
    const double least = leastOf(high), grid = range(high).first;
    EXPECT_LE(least, grid);
    EXPECT_NEAR(least, grid, 2e-2 * std::abs(grid));
}

TEST(ShWindow, SunsAreDampedNoMoreThanTheyMustBe) {
    const V3d a(0.3, 0.5, -0.7), b(-1, 0.2, 0.1);
    for (const int order : {2, 3, 6}) {
        expectLeastDamping(lights(order, {a}));
        expectLeastDamping(lights(order, {a, b}));
    }
    expectLeastDamping(toConvention(lights(3, {a}), ShConvention::irradiance));
    expectLeastDamping(toConvention(lights(3, {a, b}), ShConvention::filament));
}

TEST(ShWindow, TwoBandsOfASunAreDampedToAThird) {
    // 1 + 3 w t is not negative from w = 1/3 = 1 / (1 + 4 lambda) on.
    EXPECT_NEAR(leastDamping(lights(2, {V3d(0, 1, 0)})), 0.5, 1e-3);
}

TEST(ShWindow, WhatIsNotNegativeStaysBitForBit) {
    const ShCoefficients bright = lights(3, {V3d(1, 2, 3)}, 5);
    EXPECT_EQ(leastDamping(bright), 0);
    EXPECT_EQ(damp(bright, 0).values, bright.values);
    EXPECT_EQ(leastDamping(lights(3, {}, 1)), 0);
    EXPECT_EQ(leastDamping(lights(3, {}, 0)), 0);
}

TEST(ShWindow, NegativePixelsAreDampedAndNegativeMeansRefused) {
    ShCoefficients dark = lights(3, {V3d(1, 2, 3)}, -0.01);
    expectLeastDamping(dark);
    EXPECT_THROW(leastDamping(lights(3, {V3d(1, 2, 3)}, -1)), Error);
}

} // namespace
} // namespace ibl
