// How far the lights' irradiance is from the probe's, over all normals.
//
// Irradiance is radiance convolved with the clamped cosine, so its coefficients are A_l L_lm, with
// (Ramamoorthi and Hanrahan 2001)
//
//     A_0 = pi,  A_1 = 2 pi / 3,  A_l = 0 for other odd l,
//     A_l = 2 pi (-1)^(l/2-1) / ((l+2)(l-1)) * l! / (2^l ((l/2)!)^2) for even l:
//     A_(l+2) / A_l = -(l-1) / (l+4).
//
// By Parseval the squared error over all normals is sum A_l^2 |D_lm|^2, D = probe less lights.
#pragma once

#include "lights/light_harmonics.h"

#include <span>
#include <vector>

namespace ibl {

/// What |f_lm|^2 counts in the squared irradiance over all normals.
struct IrradianceWeights {
    int degree;
    double first;             ///< of l = 1
    std::vector<double> even; ///< of l = 0, 2, ... degree
};

/// A_l^2. `endless`: the upper quarter also stands for what lies beyond the degree, see
/// irradianceError().
IrradianceWeights irradianceWeights(int degree, bool endless);

/// Sum of the weights times |f_lm|^2, over all three channels.
double irradiancePower(const LightHarmonics& harmonics, const IrradianceWeights& weights);

/// The same of a few lights: by the addition theorem sum_m Y_lm(a) conj(Y_lm(b)) is
/// (2l + 1) / (4 pi) P_l(a . b), so it is a sum over pairs of lights.
double irradiancePower(std::span<const Light> lights, const IrradianceWeights& weights);

/// Relative RMSE over all normals and channels of an irradiance whose difference from the probe's
/// has the coefficients `difference`, up to the same degree. Beyond that degree a difference of
/// points has a flat spectrum, so |D_l|^2 / (2l + 1) is taken as its mean over the upper quarter;
/// A_l^2 (2l + 1) falls as l^-4, and the rest is small. 0 for a probe without irradiance.
double irradianceError(const LightHarmonics& probe, const LightHarmonics& difference);

} // namespace ibl
