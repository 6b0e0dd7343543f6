#include "convolve/split_sum.h"

#include "support/oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace ibl {
namespace {

constexpr double kPi = 3.14159265358979323846;

/// Integral of f over a rectangle, which is halved both ways until 6 x 6 Gauss points agree with
/// those of its quarters.
double adaptive(const std::function<double(double, double)>& f, double x0, double x1, double y0,
                double y1, double tolerance, int depth = 0) {
    static const oracle::Rule rule = oracle::gauss(6);
    const auto at = [&](double a0, double a1, double b0, double b1) {
        double sum = 0;
        for (std::size_t i = 0; i < rule.x.size(); ++i) {
            for (std::size_t j = 0; j < rule.x.size(); ++j)
                sum += rule.w[i] * rule.w[j] *
                       f(a0 + (a1 - a0) * rule.x[i], b0 + (b1 - b0) * rule.x[j]);
        }
        return sum * (a1 - a0) * (b1 - b0);
    };
    const double xm = 0.5 * (x0 + x1), ym = 0.5 * (y0 + y1);
    const double whole = at(x0, x1, y0, y1);
    const double parts =
        at(x0, xm, y0, ym) + at(xm, x1, y0, ym) + at(x0, xm, ym, y1) + at(xm, x1, ym, y1);
    if (std::abs(whole - parts) < tolerance || depth > 30) return parts;
    return adaptive(f, x0, xm, y0, ym, 0.5 * tolerance, depth + 1) +
           adaptive(f, xm, x1, y0, ym, 0.5 * tolerance, depth + 1) +
           adaptive(f, x0, xm, ym, y1, 0.5 * tolerance, depth + 1) +
           adaptive(f, xm, x1, ym, y1, 0.5 * tolerance, depth + 1);
}

/// f(l) integrated over the directions l above the horizon, in (colatitude, azimuth) about the
/// normal, both as sinh of the distance from the mirror direction in units of `width`.
double overLight(double mu, double width, double tolerance,
                 const std::function<double(double n_dot_l, double n_dot_h, double v_dot_h)>& f) {
    const double view = std::acos(mu), sin_v = std::sin(view);
    const auto integrand = [&](double a, double b) {
        const double theta = view + width * std::sinh(a), phi = width * std::sinh(b);
        // v at azimuth pi, the mirror direction at 0
        const double lx = std::sin(theta) * std::cos(phi), ly = std::sin(theta) * std::sin(phi),
                     lz = std::cos(theta);
        const double hx = lx - sin_v, hz = lz + mu, length = std::sqrt(hx * hx + ly * ly + hz * hz);
        return f(lz, hz / length, 0.5 * length) * std::sin(theta) * width * std::cosh(a) * width *
               std::cosh(b);
    };
    const double low = std::asinh(-view / width), high = std::asinh((0.5 * kPi - view) / width),
                 round = std::asinh(kPi / width);
    return 2 * (adaptive(integrand, low, 0, 0, round, tolerance) +
                adaptive(integrand, 0, high, 0, round, tolerance));
}

SplitSum ggxBruteForce(double mu, double roughness) {
    const double a = roughness * roughness, a2 = a * a;
    const auto brdf = [&](double l, double nh, double) {
        const double s2 = std::max(0.0, (1 - nh) * (1 + nh)), d = s2 + a2 * nh * nh;
        const double lambda_v = l * std::sqrt(mu * mu + a2 * (1 - mu * mu));
        const double lambda_l = mu * std::sqrt(l * l + a2 * (1 - l * l));
        return a2 / (kPi * d * d) * 0.5 / (lambda_v + lambda_l) * l;
    };
    const auto bias = [&](double l, double nh, double vh) {
        return brdf(l, nh, vh) * std::pow(1 - vh, 5);
    };
    return {overLight(mu, a, 2e-7, bias), overLight(mu, a, 2e-7, brdf)};
}

double clothBruteForce(double mu, double roughness) {
    const double p = 1 / (roughness * roughness);
    return overLight(mu, 1, 2e-7, [&](double l, double nh, double) {
        const double sine = std::sqrt(std::max(0.0, 1 - nh * nh));
        return (2 + p) * std::pow(sine, p) / (2 * kPi) / (4 * (l + mu - l * mu)) * l;
    });
}

const double kCosines[] = {0.5 / 128, 0.05, 0.3, 0.7, 127.5 / 128};

TEST(SplitSum, IsBruteForce) {
    for (const double roughness : {0.5 / 128, 0.06, 0.2, 0.5, 0.8, 1.0}) {
        for (const double mu : kCosines) {
            const SplitSum sum = ggxSplitSum(mu, roughness),
                           expected = ggxBruteForce(mu, roughness);
            EXPECT_NEAR(sum.bias, expected.bias, 1e-5) << mu << " " << roughness;
            EXPECT_NEAR(sum.total, expected.total, 1e-5) << mu << " " << roughness;
        }
    }
}

TEST(SplitSum, ClothIsBruteForce) {
    for (const double roughness : {0.5 / 128, 0.06, 0.2, 0.5, 1.0}) {
        for (const double mu : kCosines) {
            const double expected = clothBruteForce(mu, roughness);
            EXPECT_NEAR(clothSplitSum(mu, roughness), expected, 1e-5 * std::max(1.0, expected))
                << mu << " " << roughness;
        }
    }
}

TEST(SplitSum, AMirrorReflectsAllAndFresnelsTermOfTheView) {
    // Roughness to 0: the total goes to 1 and the bias to (1 - n.v)^5.
    for (const double mu : {0.05, 0.3, 0.7, 0.99}) {
        const SplitSum sum = ggxSplitSum(mu, 1e-3);
        EXPECT_NEAR(sum.total, 1, 1e-5) << mu;
        EXPECT_NEAR(sum.bias, std::pow(1 - mu, 5), 2e-5) << mu;
    }
}

TEST(SplitSum, TableIsItsTexelsAndKeepsEnergy) {
    const SplitSumTable plain = splitSumTable({32, false, false, 0});
    const SplitSumTable scattered = splitSumTable({32, true, true, 1});
    EXPECT_LT(plain.error_estimate, 2e-6);
    EXPECT_LT(scattered.error_estimate, 2e-6);
    for (int j = 0; j < 32; ++j) {
        for (int i = 0; i < 32; ++i) {
            const float *p = plain.image.at(i, j), *s = scattered.image.at(i, j);
            const SplitSum sum = ggxSplitSum((i + 0.5) / 32, (j + 0.5) / 32);
            EXPECT_NEAR(p[0], sum.total - sum.bias, 1e-7);
            EXPECT_NEAR(p[1], sum.bias, 1e-7);
            EXPECT_EQ(p[2], 0);
            EXPECT_EQ(s[0], p[1]);
            EXPECT_NEAR(s[1], p[0] + p[1], 2e-7);
            EXPECT_FLOAT_EQ(s[2], float(clothSplitSum((i + 0.5) / 32, (j + 0.5) / 32)));
            EXPECT_TRUE(p[0] >= 0 && p[1] >= 0 && p[0] + p[1] <= 1 + 1e-6f) << i << " " << j;
        }
    }
}

} // namespace
} // namespace ibl
