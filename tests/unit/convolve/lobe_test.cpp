#include "convolve/lobe.h"

#include "core/error.h"
#include "support/oracle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ibl {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Every kernel from its narrowest to its widest.
const Lobe kLobes[] = {
    {Kernel::lambert, 0},      {Kernel::ggx, 1e-4},        {Kernel::ggx, 1e-3},
    {Kernel::ggx, 0.01},       {Kernel::ggx, 0.05},        {Kernel::ggx, 0.3},
    {Kernel::ggx, 0.84},       {Kernel::ggx, 1},           {Kernel::phong, 0},
    {Kernel::phong, 12.5},     {Kernel::phong, 1e4},       {Kernel::phong, 1e6},
    {Kernel::blinnPhong, 0},   {Kernel::blinnPhong, 0.37}, {Kernel::blinnPhong, 12.5},
    {Kernel::blinnPhong, 1e4}, {Kernel::blinnPhong, 1e6},  {Kernel::charlie, 0.05},
    {Kernel::charlie, 0.13},   {Kernel::charlie, 0.5},     {Kernel::charlie, 0.837},
    {Kernel::charlie, 1}};

std::string nameOf(const Lobe& lobe) {
    return std::string(kernelRow(lobe.kernel).name) + " " + std::to_string(lobe.parameter);
}

/// The kernels as the header states them, up to a factor, in h = sin^2(t/2).
long double valueAt(const Lobe& lobe, long double h) {
    const long double p = lobe.parameter, alpha = p * p, cos_t = 1 - 2 * h;
    switch (lobe.kernel) {
    case Kernel::ggx:
        return cos_t / std::pow(alpha * alpha + (1 - alpha * alpha) * h, 2.0L);
    case Kernel::phong:
        return std::exp(p * std::log1p(-2 * h));
    case Kernel::blinnPhong:
        return std::exp(0.5L * p * std::log1p(-h)) * cos_t;
    case Kernel::charlie:
        return std::exp(0.5L / alpha * std::log(2 * h)) * cos_t;
    default:
        return cos_t;
    }
}

/// Coefficients from their definition, in long double, at the degrees asked (ascending): Gauss
/// points in the logarithm of t, in panels of a few radians of the highest degree's phase.
std::vector<double> bruteForce(const Lobe& lobe, const std::vector<int>& degrees) {
    const oracle::Rule rule = oracle::gauss(20);
    const long double half_pi = 2 * std::atan(1.0L);
    std::vector<long double> sums(degrees.size(), 0);
    long double whole = 0;
    for (long double low = 1e-13L; low < half_pi;) {
        const long double high =
            std::min({half_pi, low * 1.3L, low + 16.0L / degrees.back(), low + 0.03L});
        for (std::size_t i = 0; i < rule.x.size(); ++i) {
            const long double span = std::log(high / low), t = low * std::exp(span * rule.x[i]);
            const long double s = std::sin(0.5L * t), h = s * s;
            const long double w = rule.w[i] * span * t * std::sin(t) * valueAt(lobe, h);
            whole += w;
            if (w < 1e-24L * whole) continue;
            // P_(l+1) - P_l keeps its precision where h is tiny.
            long double p = 1, step = 0;
            std::size_t next = 0;
            for (int l = 0; next < degrees.size(); ++l) {
                if (l == degrees[next]) sums[next++] += w * p;
                step = (l * step - (2 * l + 1) * 2 * h * p) / (l + 1);
                p += step;
            }
        }
        low = high;
    }
    std::vector<double> k;
    for (const long double sum : sums)
        k.push_back(static_cast<double>(sum / whole));
    return k;
}

void expectBruteForce(const Lobe& lobe, const std::vector<int>& degrees) {
    const std::vector<double> k = zonalCoefficients(lobe, degrees.back() + 1);
    const std::vector<double> expected = bruteForce(lobe, degrees);
    ASSERT_EQ(k.size(), static_cast<std::size_t>(degrees.back()) + 1);
    EXPECT_EQ(k[0], 1);
    for (std::size_t i = 0; i < degrees.size(); ++i)
        EXPECT_NEAR(k[degrees[i]], expected[i], 1e-10) << nameOf(lobe) << " l " << degrees[i];
}

TEST(Lobe, CoefficientsMatchBruteForce) {
    for (const Lobe& lobe : kLobes)
        expectBruteForce(lobe, {1, 2, 3, 10, 57, 300});
}

TEST(Lobe, CoefficientsMatchBruteForceAtTheHighestDegrees) {
    for (const Lobe lobe :
         {Lobe{Kernel::ggx, 1e-4}, Lobe{Kernel::ggx, 0.05}, Lobe{Kernel::ggx, 0.3},
          Lobe{Kernel::ggx, 1}, Lobe{Kernel::phong, 12.5}, Lobe{Kernel::phong, 1e6},
          Lobe{Kernel::blinnPhong, 0.37}, Lobe{Kernel::blinnPhong, 1e6},
          Lobe{Kernel::charlie, 0.05}, Lobe{Kernel::charlie, 0.5}, Lobe{Kernel::charlie, 0.837}})
        expectBruteForce(lobe, {1000, 2047, 4095, 4096});
}

TEST(Lobe, CoefficientsDoNotDependOnHowManyAreAsked) {
    // The panels of the quadrature do; the integrals must not.
    for (const Lobe& lobe : kLobes) {
        const std::vector<double> few = zonalCoefficients(lobe, 50);
        const std::vector<double> many = zonalCoefficients(lobe, 1200);
        for (int l = 0; l < 50; ++l)
            EXPECT_NEAR(few[l], many[l], 1e-12) << nameOf(lobe) << " " << l;
        EXPECT_EQ(zonalCoefficients(lobe, 1), std::vector<double>{1});
    }
}

TEST(Lobe, LambertIsKnownInClosedForm) {
    const std::vector<double> k = zonalCoefficients({Kernel::lambert, 0}, 5);
    EXPECT_NEAR(k[1], 2.0 / 3, 1e-15);
    EXPECT_NEAR(k[2], 1.0 / 4, 1e-15);
    EXPECT_NEAR(k[3], 0, 1e-15);
    EXPECT_NEAR(k[4], -1.0 / 24, 1e-15);
}

TEST(Lobe, KernelsThatAreOneAnotherAgree) {
    // GGX of roughness 1, Blinn-Phong and Phong of exponents 0 and 1, and Lambert are cos t.
    const std::vector<double> lambert = zonalCoefficients({Kernel::lambert, 0}, 600);
    for (const Lobe lobe :
         {Lobe{Kernel::ggx, 1}, Lobe{Kernel::blinnPhong, 0}, Lobe{Kernel::phong, 1}}) {
        const std::vector<double> k = zonalCoefficients(lobe, 600);
        for (int l = 0; l < 600; ++l)
            EXPECT_NEAR(k[l], lambert[l], 1e-13) << nameOf(lobe) << " l " << l;
        for (const double h : {0.0, 0.1, 0.3, 0.499})
            EXPECT_NEAR(LobeMassBeyond(lobe)(h), LobeMassBeyond({Kernel::lambert, 0})(h), 1e-14);
    }
}

TEST(Lobe, ValueAndMassBeyondAreTheKernel) {
    const oracle::Rule rule = oracle::gauss(20);
    for (const Lobe& lobe : kLobes) {
        const LobeMassBeyond beyond(lobe);
        const double integral = lobeIntegral(lobe);
        EXPECT_NEAR(beyond(0), 1, 1e-14) << nameOf(lobe);
        EXPECT_DOUBLE_EQ(beyond(0.5), 0);
        const double half = std::sin(lobeWidth(lobe) / 2);
        EXPECT_NEAR(beyond(half * half), 0.5, 1e-9) << nameOf(lobe);
        // From the horizon inwards, ring by ring; 4 pi dh is the solid angle.
        long double mass = 0;
        for (long double high = 0.5; high > 1e-30L; high /= 1.03L) {
            const long double low = high / 1.03L;
            for (std::size_t i = 0; i < rule.x.size(); ++i)
                mass += 4 * static_cast<long double>(kPi) * rule.w[i] * (high - low) *
                        valueAt(lobe, low + (high - low) * rule.x[i]);
            const double h = static_cast<double>(low);
            if (h > 1e-3 && beyond(h) > 1e-3) { // the cosine holds h there
                const double value = lobeValue(lobe, 1 - 2 * h) / integral;
                const double slope =
                    (beyond(h * (1 - 1e-4)) - beyond(h * (1 + 1e-4))) / (4 * kPi * h * 2e-4);
                EXPECT_NEAR(value, slope, 1e-4 * value + 1e-8) << nameOf(lobe) << " " << h;
            }
        }
        long double outer = 0;
        for (long double high = 0.5; high > 1e-30L; high /= 1.03L) {
            const long double low = high / 1.03L;
            for (std::size_t i = 0; i < rule.x.size(); ++i)
                outer += 4 * static_cast<long double>(kPi) * rule.w[i] * (high - low) *
                         valueAt(lobe, low + (high - low) * rule.x[i]);
            ASSERT_NEAR(beyond(static_cast<double>(low)), static_cast<double>(outer / mass), 1e-12)
                << nameOf(lobe) << " h " << static_cast<double>(low);
        }
    }
}

TEST(Lobe, CharlieIsARingThatGoesToTheHorizon) {
    for (const double roughness : {0.05, 0.3, 1.0}) {
        const Lobe lobe{Kernel::charlie, roughness};
        const double peak = 1 / (1 + 0.5 / (roughness * roughness)); // cosine
        EXPECT_EQ(lobeValue(lobe, 1), 0);
        EXPECT_GT(lobeValue(lobe, peak), lobeValue(lobe, peak * 0.98));
        EXPECT_GT(lobeValue(lobe, peak), lobeValue(lobe, peak * 1.02));
        EXPECT_GT(lobeWidth(lobe), 0.8);
    }
}

TEST(Lobe, RefusesParametersOutOfRange) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const Lobe lobe :
         {Lobe{Kernel::ggx, -0.1}, Lobe{Kernel::ggx, 1.01}, Lobe{Kernel::ggx, nan},
          Lobe{Kernel::phong, -1}, Lobe{Kernel::phong, 1.1e6}, Lobe{Kernel::phong, nan},
          Lobe{Kernel::blinnPhong, -1}, Lobe{Kernel::blinnPhong, 1.1e6}, Lobe{Kernel::charlie, 0},
          Lobe{Kernel::charlie, 0.049}, Lobe{Kernel::charlie, 1.1}, Lobe{Kernel::charlie, nan}}) {
        EXPECT_THROW(checkLobe(lobe), Error) << nameOf(lobe);
    }
    for (const Lobe& lobe : kLobes)
        EXPECT_NO_THROW(checkLobe(lobe)) << nameOf(lobe);
}

} // namespace
} // namespace ibl
