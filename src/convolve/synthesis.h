// From spherical-harmonic coefficients to texels.
#pragma once

#include "convolve/interpolant.h"
#include "convolve/legendre.h"

#include <cstddef>
#include <vector>

namespace ibl {

/// A smooth field on the sphere, sampled on a lat-long grid of kOversampling times the least number
/// of samples, to be read between them (interpolant.h; the window's transform is divided out, so
/// the samples are not the field's values). The grid goes on past the poles and the seam, so that
/// there is no border anywhere.
struct SmoothField {
    static constexpr int kMargin = Interpolant::kTaps / 2;

    int rings = 0;             ///< theta = pi (r + 0.5) / rings
    int columns = 0;           ///< psi = 2 pi i / columns
    LaneVector<float> samples; ///< [rings + 2 margin][columns + 2 margin][4]

    std::size_t rowFloats() const { return 4 * (static_cast<std::size_t>(columns) + 2 * kMargin); }
};

/// The field sum k_l f_lm Y_lm up to `degree` (<= harmonics.degree); `scale` holds k_l.
SmoothField synthesise(const Harmonics& harmonics, const std::vector<double>& scale, int degree,
                       int threads);

/// The largest relative error of the interpolation on a wave of degree l in a field made for
/// `degree`.
double interpolationError(int l, int degree);

/// Values of the field at n lat-long points (u, v) in [0, 1]: out[3 i + channel].
void sampleField(const SmoothField& field, const double* u, const double* v, int n, float* out);

/// Samples of the field on `rings` rings (a multiple of 2 kLanes, more than degree) at theta = pi
/// (r + 0.5) / rings and twice as many columns at psi = pi i / rings, in double, for tests and
/// benchmarks: out[channel][ring][column].
void synthesiseGrid(const Harmonics& harmonics, const std::vector<double>& scale, int degree,
                    int rings, int threads, double* out);

} // namespace ibl
