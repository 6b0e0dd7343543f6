#include "convolve/analysis.h"
#include "convolve/evaluate.h"
#include "convolve/fft.h"
#include "convolve/synthesis.h"

#include "support/oracle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#if defined(__x86_64__)
#include <cpuid.h>
#endif

namespace ibl {
namespace {

constexpr double kPi = 3.14159265358979323846;

TEST(Fft, MatchesTheSumForEveryKindOfLength) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (const int n : {1, 2, 3, 4, 5, 6, 7, 8, 12, 30, 61, 64, 67, 97, 127, 134, 252, 509}) {
        const FftPlan plan = makeFftPlan(n);
        LaneVector<ComplexLanes> data(n), work(fftWorkspace(plan));
        for (ComplexLanes& x : data) {
            for (int lane = 0; lane < kLanes; ++lane) {
                x.re[lane] = uniform(random);
                x.im[lane] = uniform(random);
            }
        }
        const LaneVector<ComplexLanes> input = data;
        fft(plan, data.data(), work.data());
        for (int lane : {0, kLanes - 1}) {
            for (int k = 0; k < n; ++k) {
                std::complex<double> sum = 0;
                for (int j = 0; j < n; ++j) {
                    sum += std::complex<double>(input[j].re[lane], input[j].im[lane]) *
                           std::polar(1.0, -2 * kPi * (static_cast<long>(j) * k % n) / n);
                }
                EXPECT_NEAR(data[k].re[lane], sum.real(), 1e-12) << n << " " << k;
                EXPECT_NEAR(data[k].im[lane], sum.imag(), 1e-12) << n << " " << k;
            }
        }
    }
}

TEST(Analysis, CoefficientsAreTheIntegralsOverThePixels) {
    // A coarse probe against high degrees: rows and columns are much wider than the harmonics.
    Image probe(5, 3);
    for (std::size_t i = 0; i < probe.pixels.size(); ++i) {
        probe.pixels[i] = static_cast<float>(0.1 + std::fmod(0.37 * double(i * i), 1.0));
    }
    const int degree = 40;
    const Harmonics f = analyse(
        analyseRows(probe, 1, std::numeric_limits<double>::infinity(), degree, 1), degree, 1);
    for (const auto& [l, m] :
         {std::pair{0, 0}, {1, 0}, {1, 1}, {7, 3}, {40, 0}, {40, 5}, {40, 40}}) {
        double re = 0, im = 0;
        const int n = 4000; // midpoint rule a row
        for (int j = 0; j < 3; ++j) {
            double row = 0;
            for (int s = 0; s < n; ++s) {
                const double theta = kPi * (j + (s + 0.5) / n) / 3;
                const double sign = std::sph_legendre(l, m, theta) * (m % 2 ? -1 : 1);
                row += sign * std::sin(theta) * kPi / 3 / n;
            }
            for (int i = 0; i < 5; ++i) {
                // int over the pixel of exp(-i m psi), m = 0 apart.
                const double a = 2 * kPi * i / 5, b = 2 * kPi * (i + 1) / 5;
                const double c = m == 0 ? b - a : (std::sin(m * b) - std::sin(m * a)) / m;
                const double d = m == 0 ? 0 : (std::cos(m * b) - std::cos(m * a)) / m;
                re += probe.at(i, j)[1] * row * c;
                im += probe.at(i, j)[1] * row * d;
            }
        }
        // The transform has no Condon-Shortley sign, so it may differ by (-1)^m from std's.
        EXPECT_NEAR(std::abs(f.at(l, m)[2]), std::abs(re), 2e-6) << l << " " << m;
        EXPECT_NEAR(std::abs(f.at(l, m)[3]), std::abs(im), 2e-6) << l << " " << m;
    }
}

TEST(Analysis, EnergyAndMeanAreKept) {
    Image probe(64, 32);
    std::mt19937 random(2);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (float& p : probe.pixels)
        p = uniform(random);
    const Harmonics f =
        analyse(analyseRows(probe, 1, std::numeric_limits<double>::infinity(), 600, 0), 600, 0);
    double energy = 0, mean = 0;
    for (int j = 0; j < 32; ++j) {
        const double w = 2 * kPi / 64 * (std::cos(kPi * j / 32) - std::cos(kPi * (j + 1) / 32));
        for (int i = 0; i < 64; ++i) {
            for (int c = 0; c < 3; ++c)
                energy += w * probe.at(i, j)[c] * probe.at(i, j)[c];
            mean += w * probe.at(i, j)[0];
        }
    }
    EXPECT_NEAR(f.at(0, 0)[0], mean / std::sqrt(4 * kPi), 1e-12 * mean);
    double sum = 0;
    for (const double s : powerSpectrum(f))
        sum += s;
    EXPECT_LT(sum, energy * (1 + 1e-12)); // Parseval: never more, and steps have a long tail
    EXPECT_GT(sum, energy * 0.97);
}

TEST(Fft, PrunedTransformsAreTheWholeOnes) {
    std::mt19937 random(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    // Few outputs of many, all, and more than there are (they repeat).
    for (const auto& [n, most] :
         {std::pair{256, 5}, {96, 47}, {52, 3}, {67, 2}, {16, 40}, {1, 3}}) {
        const FftPlan whole = makeFftPlan(n);
        const PrunedFft pruned = makePrunedFft(n, most);
        LaneVector<ComplexLanes> data(n), slots(n), out(2 * most + 1),
            work(std::max(fftWorkspace(whole), fftWorkspace(pruned.part)));
        for (int i = 0; i < n; ++i) {
            for (int lane = 0; lane < kLanes; ++lane) {
                data[i].re[lane] = uniform(random);
                data[i].im[lane] = uniform(random);
            }
            slots[pruned.slot(i)] = data[i];
        }
        fft(whole, data.data(), work.data());
        prunedFft(pruned, slots.data(), work.data(), out.data());
        for (int k = -most; k <= most; ++k) {
            const ComplexLanes &a = out[k + most], &b = data[((k % n) + n) % n];
            for (int lane = 0; lane < kLanes; ++lane) {
                EXPECT_NEAR(a.re[lane], b.re[lane], 1e-13) << n << " " << k;
                EXPECT_NEAR(a.im[lane], b.im[lane], 1e-13) << n << " " << k;
            }
        }
    }
    EXPECT_GT(makePrunedFft(8192, 100).split, 8); // cost linear in the length
}

TEST(Analysis, SameBytesForAnyNumberOfThreads) {
    Image probe(100, 50);
    std::mt19937 random(5);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (float& p : probe.pixels)
        p = uniform(random);
    const auto run = [&](int threads) {
        const Harmonics f =
            analyse(analyseRows(probe, 1, std::numeric_limits<double>::infinity(), 70, threads), 70,
                    threads);
        const SmoothField field = synthesise(f, std::vector<double>(71, 1.0), 70, threads);
        return std::pair(f.coefficients, field.samples);
    };
    EXPECT_EQ(run(1), run(3));
}

/// Random coefficients of a few orders and the highest degrees, and the field's values by the
/// standard library's functions in long double.
class RandomField {
public:
    explicit RandomField(int degree) : harmonics(degree) {
        std::mt19937 random(3);
        std::uniform_real_distribution<double> uniform(-1, 1);
        for (const int m : orders()) {
            for (int l = std::max(m, degree - 20); l <= degree; ++l) {
                for (double& part : harmonics.at(l, m))
                    part = uniform(random);
                if (m == 0) {
                    for (const int part : {1, 3, 5})
                        harmonics.at(l, 0)[part] = 0;
                }
            }
        }
    }
    std::vector<int> orders() const {
        const int d = harmonics.degree;
        return {0, 1, 2, d / 2, d - 1, d};
    }
    double at(double u, double v, int channel) const {
        long double sum = 0;
        for (const int m : orders()) {
            for (int l = std::max(m, harmonics.degree - 20); l <= harmonics.degree; ++l) {
                const long double p = std::sph_legendre(l, m, std::numbers::pi_v<long double> * v) *
                                      (m % 2 ? -1 : 1) * (m == 0 ? 1 : 2);
                const long double psi = 2 * std::numbers::pi_v<long double> * u;
                const Parts& f = harmonics.at(l, m);
                sum += p * (f[2 * channel] * std::cos(m * psi) -
                            f[2 * channel + 1] * std::sin(m * psi));
            }
        }
        return static_cast<double>(sum);
    }

    Harmonics harmonics;
};

TEST(Synthesis, GridsAreTheSumsOfHarmonics) {
    // To a degree at which P_mm underflows near the poles; the first ring is 0.29 degrees from one.
    const int degree = 300, rings = 312, columns = 2 * rings;
    const RandomField field(degree);
    std::vector<double> grid(std::size_t{3} * rings * columns);
    synthesiseGrid(field.harmonics, std::vector<double>(degree + 1, 1.0), degree, rings, 0,
                   grid.data());
    double worst = 0, size = 0;
    for (const int ring : {0, 1, 17, rings / 2, rings - 1}) {
        for (const int column : {0, 1, 5, columns - 1}) {
            for (int channel = 0; channel < 3; ++channel) {
                const double exact =
                    field.at(static_cast<double>(column) / columns, (ring + 0.5) / rings, channel);
                const double value = grid[(channel * rings + ring) * columns + column];
                worst = std::max(worst, std::abs(value - exact));
                size = std::max(size, std::abs(exact));
            }
        }
    }
    EXPECT_LT(worst, 1e-12 * size);
}

TEST(Synthesis, PointsAreTheSumsOfHarmonics) {
    const int degree = 200;
    const RandomField field(degree);
    // The poles, the equator, the seam, points of one |cos theta| and one beside a pole.
    const std::vector<double> u{0, 0.3, 0.7, 1, 0.25, 0.11, 0.6, 0.5},
        v{0, 1, 0.5, 0.2, 0.8, 0.2, 1e-4, 0.013};
    std::vector<double> values(3 * u.size());
    evaluateField(field.harmonics, std::vector<double>(degree + 1, 1.0), degree, u.data(), v.data(),
                  u.size(), 0, values.data());
    double size = 0;
    for (std::size_t i = 0; i < u.size(); ++i)
        size = std::max(size, std::abs(field.at(u[i], v[i], 0)));
    for (std::size_t i = 0; i < values.size(); ++i) {
        const std::size_t p = i / 3;
        EXPECT_NEAR(values[i], field.at(u[p], v[p], static_cast<int>(i % 3)), 1e-12 * size) << i;
    }
}

TEST(Synthesis, InterpolationStaysWithinItsBound) {
    // Single degrees, random over the orders: root mean square error over random points.
    std::mt19937 random(6);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const int degree = 100;
    std::vector<double> u(500), v(500), exact(1500);
    for (std::size_t i = 0; i < u.size(); ++i) {
        u[i] = 0.5 + 0.5 * uniform(random);
        v[i] = 0.5 + 0.5 * uniform(random);
    }
    u[0] = 0, u[1] = 1, v[2] = 0, v[3] = 1;
    for (const int l : {0, 1, 10, 50, 90, 100}) {
        Harmonics f(degree);
        for (int m = 0; m <= l; ++m) {
            for (int part = 0; part < kParts; ++part)
                f.at(l, m)[part] = m == 0 && part % 2 == 1 ? 0 : uniform(random);
        }
        const std::vector<double> ones(degree + 1, 1.0);
        const SmoothField field = synthesise(f, ones, degree, 0);
        std::vector<float> sampled(1500);
        sampleField(field, u.data(), v.data(), 500, sampled.data());
        evaluateField(f, ones, degree, u.data(), v.data(), 500, 0, exact.data());
        double error = 0, norm = 0;
        for (std::size_t i = 0; i < exact.size(); ++i) {
            error += std::pow(sampled[i] - exact[i], 2);
            norm += exact[i] * exact[i];
        }
        // Rounding of samples whose highest waves stand amplified, and of weights.
        const double rounding = 3e-7, relative = std::sqrt(error / norm);
        EXPECT_LT(relative, interpolationError(l, degree) + rounding) << l;
        if (l == 0) {
            EXPECT_LT(relative, 2e-7);
        }
    }
    EXPECT_LT(interpolationError(degree, degree), 1e-5);
    EXPECT_LT(interpolationError(degree / 2, degree), 2e-6);
}

#if defined(__x86_64__)
/// Whether the processor holds something in the upper halves of its wide registers, which slows
/// baseline code down several times; nothing where it does not tell.
std::optional<bool> wideRegistersAreInUse() {
    unsigned a = 0, b = 0, c = 0, d = 0;
    if (!__builtin_cpu_is("intel") || !__get_cpuid_count(0xd, 1, &a, &b, &c, &d) || !(a & 4))
        return {};
    __asm__ volatile("xgetbv" : "=a"(a), "=d"(d) : "c"(1));
    return (a & 4) != 0;
}

TEST(Transforms, LeaveNoWideRegisterInUse) {
    if (wideRegistersAreInUse() != false)
        GTEST_SKIP() << "only Intel's processors tell what is in use (XGETBV with ECX = 1)";
    const int degree = 60;
    Image probe(256, 128);
    std::ranges::fill(probe.pixels, 1.0f);
    const auto clean = [] { return wideRegistersAreInUse() == false; };
    const RowSpectrum rows = analyseRows(probe, 1, 2, degree, 1);
    EXPECT_TRUE(clean()) << "rows";
    const Harmonics harmonics = analyse(rows, degree, 1);
    EXPECT_TRUE(clean()) << "analysis";
    const std::vector<double> ones(degree + 1, 1.0), at{0.1, 0.6};
    const SmoothField field = synthesise(harmonics, ones, degree, 1);
    EXPECT_TRUE(clean()) << "synthesis";
    std::vector<float> sampled(6);
    sampleField(field, at.data(), at.data(), 2, sampled.data());
    EXPECT_TRUE(clean()) << "sampling";
    std::vector<double> values(6);
    evaluateField(harmonics, ones, degree, at.data(), at.data(), 2, 1, values.data());
    EXPECT_TRUE(clean()) << "evaluation";
    std::vector<double> grid(std::size_t{3} * 64 * 128);
    synthesiseGrid(harmonics, ones, degree, 64, 1, grid.data());
    EXPECT_TRUE(clean()) << "grid";
}
#endif

} // namespace
} // namespace ibl
