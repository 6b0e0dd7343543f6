// Interpolation of band-limited fields from grids little finer than their band limit.
//
// Weights of the Kaiser-Bessel window phi(x) = I0(beta sqrt(1 - x^2)), |x| <= 1, over kTaps samples
// are the convolution of the samples with phi. That multiplies a wave of k cycles a sample by
// phi^(k), which is divided out before the samples are made, and lets in the images k + n weakened
// to phi^(k + n) / phi^(k), n != 0 (Barnett, Magland and af Klinteberg 2019, section 3; Kaiser's
// window has its transform in closed form: sinh(r) / r, r^2 = beta^2 - (pi kTaps k)^2). With
// kOversampling times the least number of samples beta is about pi kTaps (1 - 1 / (2
// kOversampling)). Lagrange's interpolation with as many taps needs twice the samples a direction
// for ten times the error.
#pragma once

#include <array>

namespace ibl {

struct Interpolant {
    static constexpr int kTaps = 8;
    static constexpr int kTerms = 11; ///< of the polynomials that stand for the window
    static constexpr int kSteps = 64;

    /// Weight of tap j at t in [0, 1), past sample kTaps / 2 - 1: a polynomial in 2 t - 1, highest
    /// power first. The weights sum to 1 for every t.
    std::array<std::array<float, kTaps>, kTerms> terms;
    /// Largest relative error on any wave of up to i / kSteps of the highest frequency,
    /// 1 / (2 kOversampling) cycles a sample, in one direction.
    std::array<double, kSteps + 1> error;
};

inline constexpr double kOversampling = 1.5;

/// Computed once a process.
const Interpolant& interpolant();

/// phi^(k) / phi^(0) for k in [0, 1 / (2 kOversampling)] cycles a sample.
double windowTransform(double k);

} // namespace ibl
