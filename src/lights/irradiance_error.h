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
//
// Beyond the degree D of the coefficients the difference is modelled: to each light belongs the
// light of its region, spread by a root mean square distance r. As a normal distribution it has
// the transform exp(-l^2 r^2 / 4), and differences of different regions are not related, so that
//
//     sum_m |D_lm|^2 = (2l + 1) / (4 pi) sum_i |E_i|^2 (1 - exp(-l^2 r_i^2 / 4))^2.
//
// With A_l^2 (2l + 1) -> 16 pi / l^4 and x = l r / 2, summing the even l as half an integral gives
//
//     sum_i 2 |E_i|^2 (r_i / 2)^3 I((D + 1.5) r_i / 2),  I(a) = int_a^inf (1 - exp(-x^2))^2 / x^4
//     dx.
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
IrradianceWeights irradianceWeights(int degree);

/// Sum of the weights times |f_lm|^2, over all three channels.
double irradiancePower(const LightHarmonics& harmonics, const IrradianceWeights& weights);

/// The same of a few lights: by the addition theorem sum_m Y_lm(a) conj(Y_lm(b)) is
/// (2l + 1) / (4 pi) P_l(a . b), so it is a sum over pairs of lights.
double irradiancePower(std::span<const Light> lights, const IrradianceWeights& weights);

/// What the difference between a light and its region adds beyond the degree. A light without
/// Light::radius stands for a disc of its solid angle.
double powerBeyond(int degree, const Light& light);

/// Relative RMSE over all normals and channels of the irradiance of `lights`, whose difference from
/// the probe's has the coefficients `difference`, up to the same degree. 0 for a probe without
/// irradiance.
double irradianceError(const LightHarmonics& probe, const LightHarmonics& difference,
                       std::span<const Light> lights);

} // namespace ibl
