// Spherical-harmonic coefficients as engines take them.
//
// Basis: real, orthonormal over the sphere, in the program's axes (right-handed, +Y up), polar axis
// +Z, no Condon-Shortley sign:
//
//     Y(l, 0) = P_l0(z),  Y(l, m) = sqrt 2 P_lm(z) cos m alpha,  Y(l, -m) = sqrt 2 P_lm(z) sin m
//     alpha, d = (sin beta cos alpha, sin beta sin alpha, z),
//
// so Y(1, -1) = +0.4886 y, Y(1, 0) = 0.4886 z, Y(1, 1) = 0.4886 x, at index l^2 + l + m.
#pragma once

#include "image/image.h"

#include <Imath/ImathVec.h>

#include <array>
#include <span>
#include <vector>

namespace ibl {

using Imath::V3d;

inline constexpr int kMaxShOrder = 20;

enum class ShConvention {
    radiance,   ///< c_lm, the probe's own: three.js's LightProbe applies the cosine itself
    irradiance, ///< A_l c_lm, of the irradiance E; a constant probe of 1 has E = pi
    filament,   ///< E / pi, each times its basis function's constant; 3 bands or fewer
};

/// `order` bands, order^2 coefficients of R, G and B.
struct ShCoefficients {
    ShConvention convention = ShConvention::radiance;
    int order = 0;
    std::vector<std::array<double, 3>> values;
};

/// Y(l, m) at the unit vector `d` for l < order; `basis` holds order^2 values.
void shBasis(int order, const V3d& d, std::span<double> basis);

/// Coefficients of a lat-long probe (RGB), a pixel an area, exact but for rounding, in convention
/// radiance. `order` in [1, kMaxShOrder]. Throws Error (usage) for another order, and (input) on
/// values that are not finite.
ShCoefficients projectProbe(const Image& latlong, int order, int threads);

/// A_l: what the clamped cosine does to degree l (Ramamoorthi and Hanrahan 2001, eq. 7-9, without
/// their factor sqrt(4 pi / (2 l + 1))): pi, 2 pi / 3, pi / 4, 0, -pi / 24, 0 ...
double cosineFactor(int l);

/// Radiance coefficients in another convention. Throws Error (usage) for filament with more than 3
/// bands.
ShCoefficients toConvention(const ShCoefficients& radiance, ShConvention convention);

/// The function the coefficients stand for, at the unit vector `d`: radiance, E, or E / pi.
std::array<double, 3> evaluateSh(const ShCoefficients& coefficients, const V3d& d);

} // namespace ibl
