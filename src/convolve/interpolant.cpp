#include "convolve/interpolant.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kTaps = Interpolant::kTaps;
constexpr int kTerms = Interpolant::kTerms;

/// Measured to have the least largest error.
constexpr double kBeta = 0.98 * kPi * kTaps * (1 - 0.5 / kOversampling);

using Weights = std::array<double, kTaps>;

Weights windowAt(double t) {
    Weights weights;
    double sum = 0;
    for (int j = 0; j < kTaps; ++j) {
        const double x = (j - (kTaps / 2 - 1) - t) / (kTaps / 2);
        weights[j] = std::cyl_bessel_i(0.0, kBeta * std::sqrt(std::max(0.0, 1 - x * x)));
        sum += weights[j];
    }
    for (double& weight : weights)
        weight /= sum;
    return weights;
}

/// Powers of 2 t - 1, highest first, of the polynomials through the window at Chebyshev's nodes.
std::array<Weights, kTerms> fitWindow() {
    std::array<Weights, kTerms> chebyshev{}, powers{};
    for (int i = 0; i < kTerms; ++i) {
        const double angle = kPi * (i + 0.5) / kTerms;
        const Weights weights = windowAt(0.5 + 0.5 * std::cos(angle));
        for (int n = 0; n < kTerms; ++n) {
            for (int j = 0; j < kTaps; ++j)
                chebyshev[n][j] += (n == 0 ? 1.0 : 2.0) / kTerms * std::cos(n * angle) * weights[j];
        }
    }
    // T_n by powers, T_(n+1) = 2 s T_n - T_(n-1).
    std::array<double, kTerms> previous{}, current{};
    current[0] = 1;
    for (int n = 0; n < kTerms; ++n) {
        for (int power = 0; power <= n; ++power) {
            for (int j = 0; j < kTaps; ++j)
                powers[kTerms - 1 - power][j] += current[power] * chebyshev[n][j];
        }
        std::array<double, kTerms> next{};
        for (int power = 0; power < kTerms; ++power) {
            next[power] = (power > 0 ? (n == 0 ? 1 : 2) * current[power - 1] : 0) -
                          (n == 0 ? 0 : previous[power]);
        }
        previous = current;
        current = next;
    }
    return powers;
}

/// |sum_j w_j(t) exp(2 pi i k (j - t)) / phi^(k) - 1|, the most over t.
double errorAt(const Interpolant& interpolant, double k) {
    constexpr int kPlaces = 32;
    double worst = 0;
    for (int place = 0; place <= kPlaces; ++place) {
        const double t = static_cast<double>(place) / kPlaces;
        std::complex<double> sum = 0;
        for (int j = 0; j < kTaps; ++j) {
            double weight = 0;
            for (int n = 0; n < kTerms; ++n)
                weight = weight * (2 * t - 1) + interpolant.terms[n][j];
            sum += std::polar(weight, 2 * kPi * k * (j - (kTaps / 2 - 1) - t));
        }
        worst = std::max(worst, std::abs(sum / windowTransform(k) - 1.0));
    }
    return worst;
}

Interpolant makeInterpolant() {
    Interpolant result{};
    const auto powers = fitWindow();
    for (int n = 0; n < kTerms; ++n)
        std::ranges::copy(powers[n], result.terms[n].begin());
    double worst = 0;
    for (int i = 0; i <= Interpolant::kSteps; ++i) {
        worst = std::max(worst, errorAt(result, i * 0.5 / kOversampling / Interpolant::kSteps));
        result.error[i] = worst;
    }
    return result;
}

} // namespace

const Interpolant& interpolant() {
    static const Interpolant result = makeInterpolant();
    return result;
}

double windowTransform(double k) {
    const double r = std::sqrt(kBeta * kBeta - std::pow(kPi * kTaps * k, 2));
    return std::sinh(r) / r * kBeta / std::sinh(kBeta);
}

} // namespace ibl
