#include "convolve/lobe.h"

#include "core/error.h"
#include "support/oracle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ibl {
namespace {

oracle::LobeFunction functionOf(const Lobe& lobe) {
    if (lobe.kernel == Kernel::ggx) return oracle::ggx(lobe.parameter);
    return lobe.kernel == Kernel::phong ? oracle::phong(lobe.parameter) : oracle::lambert();
}

/// k_l straight from its definition.
double coefficient(const Lobe& lobe, int degree) {
    const auto f = functionOf(lobe);
    const auto product = [&](double c) { return f(c) * std::legendre(degree, c); };
    return oracle::integral(product) / oracle::integral(f);
}

TEST(Lobe, CoefficientsMatchBruteForce) {
    for (const Lobe lobe :
         {Lobe{Kernel::lambert, 0}, Lobe{Kernel::ggx, 0.05}, Lobe{Kernel::ggx, 0.3},
          Lobe{Kernel::ggx, 0.84}, Lobe{Kernel::ggx, 1}, Lobe{Kernel::phong, 0},
          Lobe{Kernel::phong, 12.5}, Lobe{Kernel::phong, 1e4}}) {
        const std::vector<double> k = zonalCoefficients(lobe, 301);
        ASSERT_EQ(k.size(), 301u);
        EXPECT_DOUBLE_EQ(k[0], 1);
        for (const int l : {1, 2, 3, 10, 57, 300}) {
            EXPECT_NEAR(k[l], coefficient(lobe, l), 1e-10)
                << "kernel " << int(lobe.kernel) << " " << lobe.parameter << " l " << l;
        }
    }
}

TEST(Lobe, CoefficientsDoNotDependOnHowManyAreAsked) {
    // The panels of the quadrature do; the integrals must not.
    for (const double roughness : {1e-3, 0.01, 0.05, 0.2, 0.6, 0.9, 1.0}) {
        const std::vector<double> few = zonalCoefficients({Kernel::ggx, roughness}, 50);
        const std::vector<double> many = zonalCoefficients({Kernel::ggx, roughness}, 1200);
        for (int l = 0; l < 50; ++l)
            EXPECT_NEAR(few[l], many[l], 1e-10) << roughness << " " << l;
    }
}

TEST(Lobe, LambertIsKnownInClosedForm) {
    const std::vector<double> k = zonalCoefficients({Kernel::lambert, 0}, 5);
    EXPECT_NEAR(k[1], 2.0 / 3, 1e-15);
    EXPECT_NEAR(k[2], 1.0 / 4, 1e-15);
    EXPECT_NEAR(k[3], 0, 1e-15);
    EXPECT_NEAR(k[4], -1.0 / 24, 1e-15);
}

TEST(Lobe, MassBeyondIsTheIntegral) {
    for (const Lobe lobe :
         {Lobe{Kernel::lambert, 0}, Lobe{Kernel::ggx, 0.01}, Lobe{Kernel::ggx, 0.1},
          Lobe{Kernel::ggx, 0.85}, Lobe{Kernel::ggx, 1}, Lobe{Kernel::phong, 1e6}}) {
        const auto f = functionOf(lobe);
        const double norm = oracle::integral(f);
        EXPECT_NEAR(lobeIntegral(lobe) / norm, 1, 1e-7);
        const LobeMassBeyond beyond(lobe);
        for (const double t : {1e-6, 1e-3, 0.1, 1.0}) {
            const auto cut = [&](double c) { return c > std::cos(t) ? 0 : f(c); };
            const double h = std::sin(t / 2) * std::sin(t / 2);
            EXPECT_NEAR(beyond(h), oracle::integral(cut) / norm, 0.03 * beyond(h) + 1e-9);
        }
        EXPECT_DOUBLE_EQ(beyond(0.5), 0);
        EXPECT_NEAR(beyond(0), 1, 1e-12);
        const double half = std::sin(lobeWidth(lobe) / 2);
        EXPECT_NEAR(beyond(half * half), 0.5, 1e-9);
    }
}

TEST(Lobe, RefusesParametersOutOfRange) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Lobe lobe :
         {Lobe{Kernel::ggx, -0.1}, Lobe{Kernel::ggx, 1.01}, Lobe{Kernel::ggx, nan},
          Lobe{Kernel::phong, -1}, Lobe{Kernel::phong, 1.1e6}, Lobe{Kernel::phong, nan}}) {
        EXPECT_THROW(checkLobe(lobe), Error);
    }
    EXPECT_NO_THROW(checkLobe({Kernel::phong, 1e6}));
}

} // namespace
} // namespace ibl
