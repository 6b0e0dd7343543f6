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

namespace ibl {

/// Relative RMSE over all normals and channels of an irradiance whose difference from the probe's
/// has the coefficients `difference`, up to the same degree. Beyond that degree a difference of
/// points has a flat spectrum, so |D_l|^2 / (2l + 1) is taken as its mean over the upper quarter;
/// A_l^2 (2l + 1) falls as l^-4, and the rest is small. 0 for a probe without irradiance.
double irradianceError(const LightHarmonics& probe, const LightHarmonics& difference);

} // namespace ibl
