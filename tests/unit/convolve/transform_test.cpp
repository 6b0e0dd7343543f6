#include "convolve/analysis.h"
#include "convolve/fft.h"
#include "convolve/synthesis.h"

#include "support/oracle.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

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

TEST(Synthesis, InvertsAnalysisOfHighDegrees) {
    // Random coefficients to a degree at which P_mm underflows near the poles; the field is sampled
    // and compared with the sum of harmonics.
    const int degree = 300;
    Harmonics f(degree);
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int m : {0, 1, 2, 150, 299, 300}) {
        for (int l = std::max(m, degree - 20); l <= degree; ++l) {
            for (double& part : f.at(l, m))
                part = uniform(random);
            if (m == 0) f.at(l, 0)[1] = f.at(l, 0)[3] = f.at(l, 0)[5] = 0;
        }
    }
    const SmoothField field = synthesise(f, std::vector<double>(degree + 1, 1.0), degree, 0);
    double worst = 0, size = 0;
    // At grid nodes, so that interpolation has no part in it; the first ring is 0.15 degrees from
    // the pole.
    for (const int ring : {0, 1, 17, field.rings / 2, field.rings - 1}) {
        for (const int column : {0, 1, 5, field.columns - 1}) {
            const double u = static_cast<double>(column) / field.columns;
            const double v = (ring + 0.5) / field.rings;
            float value[3];
            sampleField(field, &u, &v, 1, value);
            double sum = 0;
            for (int m : {0, 1, 2, 150, 299, 300}) {
                for (int l = std::max(m, degree - 20); l <= degree; ++l) {
                    const double p =
                        std::sph_legendre(l, m, kPi * v) * (m % 2 ? -1.0 : 1.0) * (m == 0 ? 1 : 2);
                    const double psi = 2 * kPi * u;
                    sum +=
                        p * (f.at(l, m)[0] * std::cos(m * psi) - f.at(l, m)[1] * std::sin(m * psi));
                }
            }
            worst = std::max(worst, std::min(std::abs(value[0] - sum), 1e9));
            size = std::max(size, std::abs(sum));
        }
    }
    EXPECT_LT(worst, 2e-6 * size);
}

} // namespace
} // namespace ibl
