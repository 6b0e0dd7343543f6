#include "convolve/sh_coefficients.h"

#include "core/error.h"
#include "support/oracle.h"

#include <gtest/gtest.h>

#include <cmath>

namespace ibl {
namespace {

constexpr double kPi = 3.14159265358979323846;

Image pattern(int width, int height) {
    Image probe(width, height);
    for (std::size_t i = 0; i < probe.pixels.size(); ++i) {
        probe.pixels[i] = static_cast<float>(0.1 + std::fmod(0.37 * double(i * i), 1.0));
    }
    return probe;
}

/// The nine functions as three.js spells them, SphericalHarmonics3.getBasisAt.
std::array<double, 9> polynomials(double x, double y, double z) {
    return {0.5 * std::sqrt(1 / kPi),
            std::sqrt(3 / (4 * kPi)) * y,
            std::sqrt(3 / (4 * kPi)) * z,
            std::sqrt(3 / (4 * kPi)) * x,
            std::sqrt(15 / (4 * kPi)) * x * y,
            std::sqrt(15 / (4 * kPi)) * y * z,
            std::sqrt(5 / (16 * kPi)) * (3 * z * z - 1),
            std::sqrt(15 / (4 * kPi)) * x * z,
            std::sqrt(15 / (16 * kPi)) * (x * x - y * y)};
}

/// Gauss points (5) in theta and phi, `n` cells a pixel each way.
std::vector<std::array<double, 3>> project(const Image& probe, int n) {
    const double nodes[] = {-0.906179845938664, -0.538469310105683, 0, 0.538469310105683,
                            0.906179845938664};
    const double weights[] = {0.236926885056189, 0.478628670499366, 0.568888888888889,
                              0.478628670499366, 0.236926885056189};
    std::vector<std::array<double, 3>> sums(9);
    const int rows = probe.height * n, columns = probe.width * n;
    for (int p = 0; p < rows * columns * 25; ++p) {
        const int j = p / 25 / columns, i = p / 25 % columns, a = p % 5, b = p / 5 % 5;
        const double theta = kPi * (j + 0.5 + nodes[a] / 2) / rows;
        const double phi = 2 * kPi * (0.5 - (i + 0.5 + nodes[b] / 2) / columns);
        const double weight =
            weights[a] * weights[b] / 4 * kPi / rows * 2 * kPi / columns * std::sin(theta);
        const auto y = polynomials(std::sin(theta) * std::sin(phi), std::cos(theta),
                                   std::sin(theta) * std::cos(phi));
        for (int k = 0; k < 9; ++k) {
            for (int c = 0; c < 3; ++c)
                sums[k][c] += weight * y[k] * probe.at(i / n, j / n)[c];
        }
    }
    return sums;
}

void expectProjected(const Image& probe, int cells) {
    const auto sums = project(probe, cells);
    const ShCoefficients sh = projectProbe(probe, 3, 2);
    double size = 0;
    for (const auto& rgb : sums)
        for (const double value : rgb)
            size = std::max(size, std::abs(value));
    ASSERT_GT(size, 0);
    for (int k = 0; k < 9; ++k) {
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(sh.values[k][c] / size, sums[k][c] / size, 1e-10) << k << " " << c;
    }
}

TEST(ShCoefficients, AreTheIntegralsOverThePixels) {
    expectProjected(pattern(5, 3), 12);
    expectProjected(pattern(16, 8), 4);
    expectProjected(pattern(1, 1), 40);
    Image sun = pattern(17, 8);
    for (int c = 0; c < 3; ++c)
        sun.at(3, 2)[c] = 1e9f;
    expectProjected(sun, 4);
    Image denormal(4, 2);
    denormal.at(1, 0)[0] = 1e-44f;
    denormal.at(2, 1)[2] = 3e-44f;
    expectProjected(denormal, 16);
}

TEST(ShCoefficients, BasisIsOrthonormalAndSpelledAsInThreeJs) {
    const V3d d = V3d(0.3, -0.5, 0.7).normalized();
    std::vector<double> basis(400);
    shBasis(20, d, basis);
    const auto expected = polynomials(d.x, d.y, d.z);
    for (int k = 0; k < 9; ++k)
        EXPECT_NEAR(basis[k], expected[k], 1e-14) << k;
    // Addition theorem: the squares of a degree sum to (2 l + 1) / (4 pi).
    for (int l = 0; l < 20; ++l) {
        double sum = 0;
        for (int i = l * l; i < (l + 1) * (l + 1); ++i)
            sum += basis[i] * basis[i];
        EXPECT_NEAR(sum, (2 * l + 1) / (4 * kPi), 1e-12) << l;
    }
}

TEST(ShCoefficients, HighDegreesRebuildIrradiance) {
    // Beyond 20 bands the clamped cosine has A_l^2 (2 l + 1) left: 1e-3 of the largest is ample.
    const Image probe = pattern(16, 8);
    const ShCoefficients sh = toConvention(projectProbe(probe, 20, 1), ShConvention::irradiance);
    const std::vector<oracle::Direction> normals{{0, 0, 1},  {1, 0, 0},      {0, 1, 0},
                                                 {0, -1, 0}, {0.6, 0, -0.8}, {-0.48, 0.6, 0.64}};
    const auto exact = oracle::convolve(probe, oracle::lambert(), normals);
    for (std::size_t i = 0; i < normals.size(); ++i) {
        const auto e = evaluateSh(sh, {normals[i].x, normals[i].y, normals[i].z});
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(e[c] / kPi, exact[i][c], 1e-3);
    }
}

/// A probe that is all but 0.3 + 0.2 x + 0.1 y - 0.15 z, and its irradiance (Lambert's A_0, A_1).
Image linearProbe() {
    Image probe(512, 256);
    for (int j = 0; j < 256; ++j) {
        for (int i = 0; i < 512; ++i) {
            const double theta = kPi * (j + 0.5) / 256, phi = 2 * kPi * (0.5 - (i + 0.5) / 512);
            const double value = 0.3 + 0.2 * std::sin(theta) * std::sin(phi) +
                                 0.1 * std::cos(theta) - 0.15 * std::sin(theta) * std::cos(phi);
            for (int c = 0; c < 3; ++c)
                probe.at(i, j)[c] = static_cast<float>((c + 1) * value);
        }
    }
    return probe;
}

TEST(ShCoefficients, EachConventionIsWhatItsEngineTakes) {
    const ShCoefficients raw = projectProbe(linearProbe(), 3, 1);
    const auto& r = raw.values;
    const auto f = toConvention(raw, ShConvention::filament).values;
    const ShCoefficients irradiance = toConvention(raw, ShConvention::irradiance);
    for (const V3d& way : {V3d(1, 0, 0), V3d(0, 1, 0), V3d(0, 0, 1), V3d(-1, 2, -0.5)}) {
        const V3d n = way.normalized();
        const double x = n.x, y = n.y, z = n.z;
        const double e = kPi * 0.3 + 2 * kPi / 3 * (0.2 * x + 0.1 * y - 0.15 * z);
        for (int c = 0; c < 3; ++c) {
            // three.js, src/math/SphericalHarmonics3.js, getIrradianceAt: six digits.
            const double three =
                0.886227 * r[0][c] + 1.023328 * (r[1][c] * y + r[2][c] * z + r[3][c] * x) +
                0.858086 * (r[4][c] * x * y + r[5][c] * y * z + r[7][c] * x * z) +
                r[6][c] * (0.743125 * z * z - 0.247708) + 0.429043 * r[8][c] * (x * x - y * y);
            EXPECT_NEAR(three, (c + 1) * e, 2e-5 * (c + 1));
            // Filament, libs/ibl/src/CubemapSH.cpp, renderPreScaledSH3Bands: E / pi.
            const double filament = f[0][c] + f[1][c] * y + f[2][c] * z + f[3][c] * x +
                                    f[4][c] * y * x + f[5][c] * y * z + f[6][c] * (3 * z * z - 1) +
                                    f[7][c] * z * x + f[8][c] * (x * x - y * y);
            EXPECT_NEAR(filament, (c + 1) * e / kPi, 1e-5 * (c + 1));
            EXPECT_NEAR(evaluateSh(irradiance, n)[c], (c + 1) * e, 2e-5 * (c + 1));
        }
    }
}

TEST(ShCoefficients, Band2IsPreScaledAsFilamentDoes) {
    // computeIrradianceSH3Bands: c_2 = pi / 4 and the factors of its A[4], A[6] and A[8].
    ShCoefficients raw{ShConvention::radiance, 3, {}};
    raw.values.assign(9, {1, 1, 1});
    const auto f = toConvention(raw, ShConvention::filament).values;
    EXPECT_NEAR(f[4][0], 15 / (4 * kPi * kPi) * kPi / 4 / std::sqrt(15 / (4 * kPi)), 1e-14);
    EXPECT_NEAR(f[6][0], 5 / (16 * kPi * kPi) * kPi / 4 / std::sqrt(5 / (16 * kPi)), 1e-14);
    EXPECT_NEAR(f[8][0], 15 / (16 * kPi * kPi) * kPi / 4 / std::sqrt(15 / (16 * kPi)), 1e-14);
}

TEST(ShCoefficients, RefusesWhatItCannotDo) {
    EXPECT_THROW(projectProbe(pattern(2, 1), 0, 1), Error);
    EXPECT_THROW(projectProbe(pattern(2, 1), 21, 1), Error);
    EXPECT_THROW(toConvention(projectProbe(pattern(2, 1), 4, 1), ShConvention::filament), Error);
}

} // namespace
} // namespace ibl
