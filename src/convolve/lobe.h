// Reflection lobes: zonal kernels about the lobe axis (N = V = R) and their spherical-harmonic
// coefficients.
//
//     Lambert  K(t) = cos t
//     GGX      K(t) = D(t/2) cos t,  D(h) = alpha^2 / (pi ((alpha^2 - 1) cos^2 h + 1)^2),
//              alpha = roughness^2 (Walter et al. 2007; t = 2 h since V = N)
//     Phong    K(t) = cos^n t
//
// all zero beyond 90 degrees. In h = sin^2(t/2) every one of them, and its integral over a cap, has
// a closed form, and h keeps its precision where t is small.
#pragma once

#include <vector>

namespace ibl {

enum class Kernel { lambert, ggx, phong };

struct Lobe {
    Kernel kernel = Kernel::lambert;
    double parameter = 0; ///< ggx: perceptual roughness in [0, 1]; phong: exponent in [0, 1e6]
};

/// Throws Error(usage) when the parameter is out of its range or not finite.
void checkLobe(const Lobe& lobe);

/// True for GGX of roughness 0, whose lobe is a delta: a mirror.
bool isMirror(const Lobe& lobe);

/// K(t), as above, at the angle whose cosine is `cos_t`. Not for mirrors.
double lobeValue(const Lobe& lobe, double cos_t);

/// The integral of K over the sphere.
double lobeIntegral(const Lobe& lobe);

/// The part of the integral of K, in [0, 1], that lies farther than t from the axis, where
/// h = sin^2(t/2). Mirrors: 0 for h > 0.
class LobeMassBeyond {
public:
    explicit LobeMassBeyond(const Lobe& lobe);
    double operator()(double h) const;

private:
    Kernel kernel_;
    double alpha_squared_ = 0;
    double exponent_ = 0;
    double scale_ = 1; ///< 1 / integral
};

/// Angle (radians) within which half of the lobe's integral lies: its width.
double lobeWidth(const Lobe& lobe);

/// Zonal coefficients k_0 .. k_(bands-1) of the lobe normalised to integral 1, so k_0 = 1 and
///
///     (K * f)_lm = k_l f_lm,  k_l = 2 pi int K(t) P_l(cos t) sin t dt / int K  (Funk-Hecke).
///
/// Absolute error at most 1e-10, by quadrature that adapts to the lobe's width and to l.
/// All ones for mirrors.
std::vector<double> zonalCoefficients(const Lobe& lobe, int bands);

} // namespace ibl
