// Least squares: with b_k the harmonics, weighted by Lambert's kernel A_l so that squares add up to
// the irradiance's squared error, the residual of row (k, channel c) is
//
//     r_kc = probe_kc - sum_i E_ic b_k(d_i),
//
// and moving light i by v_i, tangent to the sphere, takes v_i . J_i,kc = E_ic v_i . grad b_k from
// it. Minimising |r - J v|^2 / lambda + sum_i |v_i|^2 / radius_i^2 gives
//
//     v_i = radius_i^2 J_i y,   (lambda I + sum_i radius_i^2 J_i^T J_i) y = r.
#include "lights/matched_places.h"

#include "core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <utility>

namespace ibl {
namespace {

using Complex = std::complex<double>;

constexpr int kDegree = 4;
constexpr std::size_t kFunctions = 17; ///< real ones of degree 1, 2 and 4
constexpr std::size_t kRows = 3 * kFunctions;
/// Of the system's trace. From 1e-5 to 1e-2 the errors differ by a tenth.
constexpr double kLambda = 1e-3;
constexpr double kReach = 0.5; ///< of a light's radius
constexpr int kRounds = 3;

/// A_l, times the root of 2 for m > 0, whose parts stand for -m as well.
double weightOf(int l, int m) {
    constexpr double kKernel[kDegree + 1] = {kPi, 2 * kPi / 3, kPi / 4, 0, -kPi / 24};
    return kKernel[l] * (m > 0 ? std::sqrt(2.0) : 1);
}

struct Sample {
    std::array<double, kFunctions> value;
    std::array<V3d, kFunctions> gradient; ///< tangent to the sphere
};

/// The weighted harmonics' real and imaginary parts at d, by m, then l. P_lm exp(-i m psi) is
/// Q_lm(y) q^m with q = -z - i x = sin theta exp(-i psi) and Q_lm polynomials, smooth at the poles.
Sample harmonicsAt(const V3d& d) {
    Sample sample;
    std::size_t k = 0;
    const auto put = [&](double value, const V3d& gradient) {
        sample.value[k] = value;
        sample.gradient[k++] = gradient - gradient.dot(d) * d;
    };
    const Complex q(-d.z, -d.x);
    Complex power = 1, lower = 0; // q^m and q^(m-1)
    double sectoral = std::sqrt(1 / (4 * kPi));
    for (int m = 0; m <= kDegree; ++m) {
        double now = sectoral, before = 0, slope = 0, slope_before = 0, b = 0;
        for (int l = m; l <= kDegree; ++l) {
            if (l == 1 || l == 2 || l == kDegree) {
                const double w = weightOf(l, m);
                const Complex value = w * now * power, along_q = w * now * m * lower,
                              along_y = w * slope * power;
                const Complex along_x = along_q * Complex(0, -1);
                put(value.real(), {along_x.real(), along_y.real(), -along_q.real()});
                if (m > 0) put(value.imag(), {along_x.imag(), along_y.imag(), -along_q.imag()});
            }
            // As in harmonic_sums.cpp, and its derivative.
            const double n = l + 1.0;
            const double a = std::sqrt((4 * n * n - 1) / (n * n - double{1} * m * m));
            const double next = a * (d.y * now - b * before);
            const double slope_next = a * (now + d.y * slope - b * slope_before);
            before = std::exchange(now, next);
            slope_before = std::exchange(slope, slope_next);
            b = 1 / a;
        }
        lower = power;
        power *= q;
        sectoral *= std::sqrt((2.0 * m + 3) / (2.0 * m + 2));
    }
    return sample;
}

/// The probe's coefficients in the order of harmonicsAt(), three channels each.
std::array<double, kRows> weightedHarmonics(const LightHarmonics& probe) {
    std::array<double, kRows> rows;
    std::size_t row = 0;
    for (int m = 0; m <= kDegree; ++m) {
        for (const int l : {1, 2, kDegree}) {
            if (l < m) continue;
            const std::size_t place = static_cast<std::size_t>(l - m - m % 2) / 2;
            const LightHarmonics::Parts& parts = l == 1 ? probe.first[static_cast<std::size_t>(m)]
                                                        : probe.even[probe.column(m) + place];
            for (std::size_t part = 0; part < (m > 0 ? 2u : 1u); ++part) {
                for (std::size_t c = 0; c < 3; ++c)
                    rows[row++] = weightOf(l, m) * parts[2 * c + part];
            }
        }
    }
    return rows;
}

/// The matrix and right side above, without lambda.
struct System {
    std::vector<double> matrix = std::vector<double>(kRows * kRows, 0.0);
    std::array<double, kRows> right{};
};

void addLight(const Light& light, System& system) {
    const Sample sample = harmonicsAt(light.direction);
    const double freedom = light.radius * light.radius;
    for (std::size_t k = 0; k < kFunctions; ++k) {
        for (std::size_t c = 0; c < 3; ++c)
            system.right[3 * k + c] -= sample.value[k] * light.irradiance[static_cast<int>(c)];
        for (std::size_t j = 0; j < kFunctions; ++j) {
            const V3d scaled =
                freedom * sample.gradient[k].dot(sample.gradient[j]) * light.irradiance;
            for (std::size_t c = 0; c < 3; ++c) {
                double* row = &system.matrix[(3 * k + c) * kRows + 3 * j];
                for (int e = 0; e < 3; ++e)
                    row[e] += scaled[static_cast<int>(c)] * light.irradiance[e];
            }
        }
    }
}

/// Solves a symmetric positive system by Cholesky's decomposition; `m` is overwritten.
void solve(std::vector<double>& m, std::array<double, kRows>& y) {
    const auto at = [&](std::size_t i, std::size_t j) -> double& { return m[i * kRows + j]; };
    for (std::size_t i = 0; i < kRows; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            for (std::size_t k = 0; k < j; ++k)
                at(i, j) -= at(i, k) * at(j, k);
            at(i, j) = i == j ? std::sqrt(at(i, i)) : at(i, j) / at(j, j);
        }
        for (std::size_t k = 0; k < i; ++k)
            y[i] -= at(i, k) * y[k];
        y[i] /= at(i, i);
    }
    for (std::size_t i = kRows; i-- > 0;) {
        for (std::size_t k = i + 1; k < kRows; ++k)
            y[i] -= at(k, i) * y[k];
        y[i] /= at(i, i);
    }
}

/// The light's direction after its move, less than kReach of its radius from `start`.
V3d moved(const Light& light, const V3d& start, const std::array<double, kRows>& y) {
    if (light.radius <= 0) return start;
    const Sample sample = harmonicsAt(light.direction);
    V3d move(0);
    for (std::size_t k = 0; k < kFunctions; ++k) {
        const double by_colour = y[3 * k] * light.irradiance.x + y[3 * k + 1] * light.irradiance.y +
                                 y[3 * k + 2] * light.irradiance.z;
        move += by_colour * sample.gradient[k];
    }
    const V3d place = light.direction + light.radius * light.radius * move;
    const V3d off = place - place.dot(start) * start;
    const double reach = kReach * light.radius;
    return (start + off / std::sqrt(1 + off.length2() / (reach * reach))).normalized();
}

} // namespace

void matchPlaces(std::vector<Light>& lights, const LightHarmonics& probe, int threads) {
    const std::array<double, kRows> target = weightedHarmonics(probe);
    std::vector<V3d> starts;
    for (const Light& light : lights)
        starts.push_back(light.direction);
    constexpr std::size_t kRun = 512;
    for (int round = 0; round < kRounds; ++round) {
        std::vector<System> parts((lights.size() + kRun - 1) / kRun);
        parallelForRuns(lights.size(), kRun, threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                addLight(lights[i], parts[begin / kRun]);
        });
        System whole{.right = target};
        for (const System& part : parts) {
            for (std::size_t k = 0; k < kRows * kRows; ++k)
                whole.matrix[k] += part.matrix[k];
            for (std::size_t k = 0; k < kRows; ++k)
                whole.right[k] += part.right[k];
        }
        double trace = 0;
        for (std::size_t k = 0; k < kRows; ++k)
            trace += whole.matrix[k * (kRows + 1)];
        if (trace <= 0) return; // no light can move
        for (std::size_t k = 0; k < kRows; ++k)
            whole.matrix[k * (kRows + 1)] += kLambda * trace;
        solve(whole.matrix, whole.right);
        parallelForRuns(lights.size(), kRun, threads, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                lights[i].direction = moved(lights[i], starts[i], whole.right);
        });
    }
}

} // namespace ibl
