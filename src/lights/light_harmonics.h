// Spherical harmonics of probes and lights, up to a low degree, for the lights' irradiance error.
#pragma once

#include "image/image.h"
#include "lights/light.h"

#include <array>
#include <cstddef>
#include <vector>

namespace ibl {

/// Coefficients of an RGB measure on the sphere for l = 1 and every even l up to `degree` (even):
/// those that Lambert's kernel keeps. Orthonormal Y_lm = P_lm(cos theta) exp(i m psi), m >= 0,
/// psi = 2 pi u; re r, im r, re g, im g, re b, im b, of sum E conj(Y_lm).
struct LightHarmonics {
    using Parts = std::array<double, 6>;

    int degree = 0;
    std::vector<Parts> even;      ///< m-major: l = m or m + 1, whichever is even, to degree in twos
    std::array<Parts, 2> first{}; ///< l = 1, m = 0 and 1

    explicit LightHarmonics(int d = 0)
        : degree(d), even(static_cast<std::size_t>(d / 2 + 1) * (d / 2 + 1)) {}

    /// Where column m of `even` begins: the columns 0 .. m - 1 have d/2 + 1 - ceil(k/2) entries.
    std::size_t column(int m) const {
        const int half = m / 2, n = degree / 2 + 1;
        return static_cast<std::size_t>(m * n - half * half - (m % 2 ? half : 0));
    }
    LightHarmonics& operator-=(const LightHarmonics& other);
    LightHarmonics& operator+=(const LightHarmonics& other);
};

/// Degree to which `count` lights are compared with their probe: about as fine as the regions are;
/// what lies beyond is modelled (irradiance_error.h).
int harmonicDegree(int count);

/// Of a lat-long probe (three channels, finite), pixels as areas. The probe is gathered on a grid
/// of 8 degree x 4 degree points by the adjoint of cubic interpolation, so the cost is a few
/// operations a pixel. Relative error of a coefficient at most 0.02 (2 pi l / (8 degree))^4, i.e.
/// 1e-8 at l = 2 and 1e-2 at l = degree = 64, where Lambert's kernel has fallen to 1e-4; floats add
/// 2e-8 of all irradiance.
LightHarmonics probeHarmonics(const Image& latlong, int degree, int threads);

/// Of lights, as points; exact but for rounding.
LightHarmonics lightHarmonics(const std::vector<Light>& lights, int degree, int threads);

} // namespace ibl
