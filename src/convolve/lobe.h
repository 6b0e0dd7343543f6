// Reflection lobes: zonal kernels about the lobe axis (N = V = R) and their spherical-harmonic
// coefficients.
//
//     Lambert      K(t) = cos t
//     GGX          K(t) = D(t/2) cos t,  D(h) = alpha^2 / (pi ((alpha^2 - 1) cos^2 h + 1)^2),
//                  alpha = roughness^2 (Walter et al. 2007; t = 2 h since V = N)
//     Phong        K(t) = cos^n t
//     Blinn-Phong  K(t) = cos^n(t/2) cos t (Blinn 1977)
//     Charlie      K(t) = sin^(1/alpha)(t/2) cos t, alpha = roughness^2 (Estevez and Kulla 2017)
//
// all zero beyond 90 degrees. In h = sin^2(t/2) every one of them, and its integral over a cap, has
// a closed form, and h keeps its precision where t is small. Charlie is a ring, dark on its axis
// and largest at cos t = 1 / (1 + 1 / (2 alpha)): the smoother, the thinner and the nearer to the
// horizon, about 2 alpha from it.
#pragma once

#include <array>
#include <optional>
#include <string_view>
#include <vector>

namespace ibl {

enum class Kernel { lambert, ggx, phong, blinnPhong, charlie };

enum class KernelParameter { none, roughness, exponent };

/// What a kernel is called and takes; `--kernel`, its help and the refusals are made from these
/// rows.
struct KernelRow {
    Kernel kernel;
    std::string_view name;
    KernelParameter parameter;
    double least, most; ///< of the parameter
    std::string_view summary;
};

/// Charlie below a roughness of 0.05 is a ring thinner than 0.3 degrees along the horizon, which
/// neither harmonics nor the pixels of a probe hold, and at 0 it has no lobe.
inline constexpr std::array<KernelRow, 5> kKernels{{
    {Kernel::ggx, "ggx", KernelParameter::roughness, 0, 1, "microfacets"},
    {Kernel::phong, "phong", KernelParameter::exponent, 0, 1e6, "cos^n t"},
    {Kernel::blinnPhong, "blinn-phong", KernelParameter::exponent, 0, 1e6, "cos^n(t/2) cos t"},
    {Kernel::charlie, "charlie", KernelParameter::roughness, 0.05, 1, "sheen of cloth"},
    {Kernel::lambert, "lambert", KernelParameter::none, 0, 0, "cos t, as diffuse"},
}};

constexpr const KernelRow& kernelRow(Kernel kernel) {
    for (const KernelRow& row : kKernels)
        if (row.kernel == kernel) return row;
    return kKernels[0];
}

struct Lobe {
    Kernel kernel = Kernel::lambert;
    double parameter = 0; ///< perceptual roughness or exponent, as the kernel's row says
};

/// Throws Error(usage) when the parameter is out of its kernel's range or not finite.
void checkLobe(const Lobe& lobe);

/// True for GGX of roughness 0, whose lobe is a delta: a mirror.
bool isMirror(const Lobe& lobe);

/// K(t), as above, at the angle whose cosine is `cos_t`; Charlie's is 2^(1/(2 alpha)) times that,
/// (1 - cos t)^(1/(2 alpha)) cos t, which does not underflow. Not for mirrors.
double lobeValue(const Lobe& lobe, double cos_t);

/// The integral of that over the sphere.
double lobeIntegral(const Lobe& lobe);

/// The part of the integral of K, in [0, 1], that lies farther than t from the axis, where
/// h = sin^2(t/2). Mirrors: 0 for h > 0.
class LobeMassBeyond {
public:
    explicit LobeMassBeyond(const Lobe& lobe);
    double operator()(double h) const;

private:
    Kernel kernel_;
    double alpha_squared_ = 0; ///< ggx
    double exponent_ = 0;      ///< of cos t, of cos^2(t/2) or of 1 - cos t
    double scale_ = 1;         ///< ggx: 1 / integral
};

/// Angle (radians) within which half of the lobe's integral lies: its width.
double lobeWidth(const Lobe& lobe);

/// Angle (radians) over which the lobe, of that width, changes by its own size at t from its axis:
/// as far as its horizon or its poles in the complex plane.
double lobeScaleAt(const Lobe& lobe, double width, double t);

/// Angle (radians) from which on that is `scale` or more, but for the horizon; infinite where it
/// never is. Not for Charlie.
double lobeScaleFrom(const Lobe& lobe, double width, double scale);

/// Lambert's and GGX's lobe in c = cos t >= 0: K(t) = factor c / (a2 + (1 - a2) (1 - c) / 2)^2.
struct RationalLobe {
    double factor;
    double a2;
};

/// Nothing for the other kernels.
std::optional<RationalLobe> rationalLobe(const Lobe& lobe);

/// Whether the lobe ends at its horizon in a step, or in one that is as steep there: Phong of an
/// exponent below 1.
bool endsInStep(const Lobe& lobe);

/// Angle (radians) within which lies less than 1e-17 of the integral: 0 but for Charlie, a ring.
double lobeBegin(const Lobe& lobe);

/// Angle (radians) beyond which lies less than 1e-17 of the integral: at most pi / 2.
double lobeReach(const Lobe& lobe);

/// Angle (radians) over which the lobe's mass may be taken as smooth, where that is not in
/// proportion to the distance from the axis: 0.2 or less.
double lobeVariation(const Lobe& lobe);

/// Zonal coefficients k_0 .. k_(bands-1) of the lobe normalised to integral 1, so k_0 = 1 and
///
///     (K * f)_lm = k_l f_lm,  k_l = 2 pi int K(t) P_l(cos t) sin t dt / int K  (Funk-Hecke).
///
/// Absolute error at most 1e-10 for up to 4097 bands, by quadrature that adapts to the lobe's width
/// and to l (zonal.cpp). All ones for mirrors.
std::vector<double> zonalCoefficients(const Lobe& lobe, int bands);

} // namespace ibl
