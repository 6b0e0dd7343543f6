#include "convolve/lobe.h"

#include "convolve/gauss.h"
#include "core/error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;

double alphaOf(const Lobe& lobe) {
    return lobe.parameter * lobe.parameter;
}

/// GGX in h = sin^2(t/2): cos^2(t/2) = 1 - h, so D = alpha^2 / (pi (alpha^2 + beta h)^2) with
/// beta = 1 - alpha^2, cos t = 1 - 2h and 2 pi sin t dt = 4 pi dh. The integral of K over the cap
/// h < c is 4 alpha^2 J(c),
///
///     J(c) = int_0^c (1 - 2h) / (alpha^2 + beta h)^2 dh = [(1 + 2 alpha^2/beta) c / (alpha^2 s)]
///            - (2 / beta^2) log(s / alpha^2),   s = alpha^2 + beta c,
///
/// and for beta -> 0 that cancels; there (alpha near 1) the integrand is smooth and sixteen Gauss
/// points are exact to rounding.
double ggxCapIntegral(double a2, double from, double to) {
    const double beta = 1 - a2;
    if (beta < 0.5) {
        const GaussRule& rule = gaussRule(16);
        double sum = 0;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double h = 0.5 * (from + to) + 0.5 * (to - from) * rule.nodes[i];
            const double s = a2 + beta * h;
            sum += rule.weights[i] * (1 - 2 * h) / (s * s);
        }
        return 4 * a2 * sum * 0.5 * (to - from);
    }
    const double s0 = a2 + beta * from, s1 = a2 + beta * to;
    const double rational = (1 + 2 * a2 / beta) * (to - from) / (s0 * s1);
    return 4 * a2 * (rational - 2 / (beta * beta) * std::log1p(beta * (to - from) / s0));
}

/// Blinn-Phong in u = 1 - h = cos^2(t/2), m = n/2: K = u^m (2u - 1), and
///
///     int u^m (2u - 1) du = u^(m+1) (m - 2h (m + 1)) / ((m + 1) (m + 2)),
///
/// which at the horizon is -2^-(m+1) / ((m + 1) (m + 2)). Times (m + 1) (m + 2), the integral from
/// h to the horizon is this.
double blinnPhongBeyond(double m, double h) {
    return std::exp((m + 1) * std::log1p(-h)) * (m - 2 * h * (m + 1)) + std::exp2(-(m + 1));
}

/// Charlie in y = 2h = 1 - cos t, q = 1 / (2 alpha): K = y^q (1 - y), and
///
///     int_0^y y^q (1 - y) dy = y^(q+1) (q + 2 - (q + 1) y) / ((q + 1) (q + 2)).
///
/// The part of it beyond y is one minus this over its value at 1.
double charlieBeyond(double q, double h) {
    const double y = 2 * h;
    return 1 - std::pow(y, q + 1) * (q + 2 - (q + 1) * y);
}

/// The exponent of cos t, of cos^2(t/2) and of 1 - cos t.
double exponentOf(const Lobe& lobe) {
    switch (lobe.kernel) {
    case Kernel::phong:
        return lobe.parameter;
    case Kernel::blinnPhong:
        return 0.5 * lobe.parameter;
    case Kernel::charlie:
        return 0.5 / alphaOf(lobe);
    default:
        return 1;
    }
}

} // namespace

void checkLobe(const Lobe& lobe) {
    const KernelRow& row = kernelRow(lobe.kernel);
    if (row.parameter == KernelParameter::none) return;
    if (lobe.parameter >= row.least && lobe.parameter <= row.most) return;
    char text[160];
    std::snprintf(text, sizeof text, "--%s %g is not in [%g, %g], which %s takes; give one in it",
                  row.parameter == KernelParameter::roughness ? "roughness" : "exponent",
                  lobe.parameter, row.least, row.most, std::string(row.name).c_str());
    throw Error(ExitCode::usage, text);
}

bool isMirror(const Lobe& lobe) {
    return lobe.kernel == Kernel::ggx && lobe.parameter < 1e-5;
}

double lobeValue(const Lobe& lobe, double cos_t) {
    if (cos_t <= 0) return 0;
    switch (lobe.kernel) {
    case Kernel::ggx: {
        const double a2 = alphaOf(lobe) * alphaOf(lobe);
        const double d = a2 + (1 - a2) * 0.5 * (1 - cos_t);
        return a2 / (kPi * d * d) * cos_t;
    }
    case Kernel::blinnPhong:
        return std::pow(0.5 + 0.5 * cos_t, exponentOf(lobe)) * cos_t;
    case Kernel::charlie:
        return std::pow(std::max(0.0, 1 - cos_t), exponentOf(lobe)) * cos_t;
    case Kernel::phong:
        return std::pow(cos_t, lobe.parameter);
    case Kernel::lambert:
        break;
    }
    return cos_t;
}

double lobeIntegral(const Lobe& lobe) {
    const double e = exponentOf(lobe);
    switch (lobe.kernel) {
    case Kernel::ggx:
        return ggxCapIntegral(alphaOf(lobe) * alphaOf(lobe), 0, 0.5);
    case Kernel::blinnPhong:
        return 4 * kPi * blinnPhongBeyond(e, 0) / ((e + 1) * (e + 2));
    case Kernel::charlie:
        return 2 * kPi / ((e + 1) * (e + 2));
    default:
        return 2 * kPi / (e + 1);
    }
}

LobeMassBeyond::LobeMassBeyond(const Lobe& lobe)
    : kernel_(lobe.kernel), exponent_(exponentOf(lobe)) {
    if (kernel_ == Kernel::blinnPhong) scale_ = 1 / blinnPhongBeyond(exponent_, 0);
    if (kernel_ == Kernel::ggx) {
        alpha_squared_ = alphaOf(lobe) * alphaOf(lobe);
        scale_ = isMirror(lobe) ? 1 : 1 / lobeIntegral(lobe);
    }
}

double LobeMassBeyond::operator()(double h) const {
    if (h >= 0.5) return 0;
    switch (kernel_) {
    case Kernel::ggx:
        if (alpha_squared_ < 1e-20) return h > 0 ? 0 : 1;
        return scale_ * ggxCapIntegral(alpha_squared_, h, 0.5);
    case Kernel::blinnPhong:
        return scale_ * blinnPhongBeyond(exponent_, h);
    case Kernel::charlie:
        return charlieBeyond(exponent_, h);
    default: // of cos^n t: cos^(n+1) t
        return std::exp((exponent_ + 1) * std::log1p(-2 * h));
    }
}

double lobeWidth(const Lobe& lobe) {
    if (isMirror(lobe)) return 0;
    const LobeMassBeyond mass_beyond(lobe);
    double low = -80, high = -1; // log2 h; the mass beyond falls from 1 to 0 between them
    for (int i = 0; i < 60; ++i) {
        const double mid = 0.5 * (low + high);
        (mass_beyond(std::exp2(mid)) > 0.5 ? low : high) = mid;
    }
    return 2 * std::asin(std::sqrt(std::exp2(low)));
}

double lobeScaleAt(const Lobe& lobe, double width, double t) {
    const double to_horizon = std::abs(0.5 * kPi - t);
    double smooth = width;
    if (lobe.kernel == Kernel::ggx) smooth = std::max(width, 0.5 * t);
    // (1 - cos t)^q cos t has its singularity on the axis and grows by q cot(t/2) dt.
    if (lobe.kernel == Kernel::charlie)
        smooth = std::min(0.5 * t, 2 * lobe.parameter * lobe.parameter * std::tan(0.5 * t));
    return std::min(smooth, to_horizon);
}

double lobeScaleFrom(const Lobe& lobe, double width, double scale) {
    if (width >= scale) return 0;
    return lobe.kernel == Kernel::ggx ? 2 * scale : std::numeric_limits<double>::infinity();
}

std::optional<RationalLobe> rationalLobe(const Lobe& lobe) {
    if (lobe.kernel == Kernel::lambert) return RationalLobe{1, 1};
    if (lobe.kernel != Kernel::ggx) return std::nullopt;
    const double a2 = alphaOf(lobe) * alphaOf(lobe);
    return RationalLobe{a2 / kPi, a2};
}

bool endsInStep(const Lobe& lobe) {
    return lobe.kernel == Kernel::phong && lobe.parameter < 1;
}

double lobeBegin(const Lobe& lobe) {
    if (lobe.kernel != Kernel::charlie) return 0;
    // Within t lies x^(q + 1) (q + 2 - (q + 1) x) of it, x = 1 - cos t.
    const double q = exponentOf(lobe);
    return std::acos(1 - std::pow(1e-17 / (q + 2), 1 / (q + 1)));
}

double lobeReach(const Lobe& lobe) {
    // What lies beyond t is below 2 cos^n t of Phong's integral, below 2 cos^n(t/2) of Blinn's.
    const double n = lobe.parameter, half_pi = 0.5 * kPi;
    if (lobe.kernel == Kernel::phong && n > 0) return std::acos(std::exp(-40 / n));
    if (lobe.kernel == Kernel::blinnPhong && n > 0)
        return std::min(half_pi, 2 * std::acos(std::exp(-40 / n)));
    return half_pi;
}

double lobeVariation(const Lobe& lobe) {
    constexpr double kMost = 0.2;
    switch (lobe.kernel) {
    case Kernel::phong: // about exp(-n t^2 / 2): two standard deviations
        return std::min(kMost, 2 / std::sqrt(lobe.parameter + 1));
    case Kernel::blinnPhong: // exp(-n t^2 / 8)
        return std::min(kMost, 4 / std::sqrt(lobe.parameter + 1));
    case Kernel::charlie: // near the horizon exp(q t)
        return std::min(kMost, 4 / exponentOf(lobe));
    default:
        return kMost;
    }
}

} // namespace ibl
