#include "convolve/lobe.h"

#include "convolve/gauss.h"
#include "core/error.h"

#include <algorithm>
#include <cmath>
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
/// and for beta -> 0 that cancels; there (alpha near 1) the integrand is smooth and eight Gauss
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

/// Panels of 16 Gauss points in t over [0, pi/2]: none wider than its distance from the lobe's
/// poles at t = +-2i alpha (there the rule gains a digit a point) nor than 12 / bands (about two
/// periods of P_l).
std::vector<double> ggxPanels(double alpha, int bands) {
    std::vector<double> edges{0.0};
    const double half_pi = 0.5 * kPi;
    while (edges.back() < half_pi) {
        const double t = edges.back();
        const double width = std::min({t + alpha, 12.0 / bands, 0.4});
        edges.push_back(t + 1.3 * width > half_pi ? half_pi : t + width);
    }
    return edges;
}

std::vector<double> ggxCoefficients(const Lobe& lobe, int bands) {
    const double alpha = alphaOf(lobe);
    const GaussRule& rule = gaussRule(16);
    const std::vector<double> edges = ggxPanels(alpha, bands);
    std::vector<double> x, weight;
    for (std::size_t p = 0; p + 1 < edges.size(); ++p) {
        const double half = 0.5 * (edges[p + 1] - edges[p]), mid = 0.5 * (edges[p + 1] + edges[p]);
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double t = mid + half * rule.nodes[i];
            const double s = std::sin(0.5 * t);
            const double d = alpha * alpha + (1 - alpha * alpha) * s * s;
            x.push_back(std::cos(t));
            weight.push_back(rule.weights[i] * half * std::sin(t) * std::cos(t) / (d * d));
        }
    }
    // Bonnet's recurrence, all nodes at once.
    const std::size_t n = x.size();
    std::vector<double> previous(n, 0.0), current(n, 1.0), k(static_cast<std::size_t>(bands));
    for (int l = 0; l < bands; ++l) {
        const double a = (2.0 * l + 1) / (l + 1), b = static_cast<double>(l) / (l + 1);
        double sum = 0;
        for (std::size_t i = 0; i < n; ++i)
            sum += weight[i] * current[i];
        for (std::size_t i = 0; i < n; ++i) {
            const double next = a * x[i] * current[i] - b * previous[i];
            previous[i] = current[i];
            current[i] = next;
        }
        k[static_cast<std::size_t>(l)] = sum;
    }
    const double norm = 1 / k[0];
    for (double& v : k)
        v *= norm;
    return k;
}

/// int_0^1 x^n P_l = int_0^1 x^n P_(l-2) (n - l + 2) / (n + l + 1) (Gradshteyn and Ryzhik 7.231),
/// exact for every real n; Lambert is n = 1.
std::vector<double> cosinePowerCoefficients(double n, int bands) {
    std::vector<double> k(static_cast<std::size_t>(bands));
    for (int l = 0; l < bands; ++l) {
        const std::size_t i = static_cast<std::size_t>(l);
        if (l == 0)
            k[i] = 1;
        else if (l == 1)
            k[i] = (n + 1) / (n + 2);
        else
            k[i] = k[i - 2] * (n - l + 2) / (n + l + 1);
    }
    return k;
}

double exponentOf(const Lobe& lobe) {
    return lobe.kernel == Kernel::lambert ? 1 : lobe.parameter;
}

} // namespace

void checkLobe(const Lobe& lobe) {
    const double p = lobe.parameter;
    if (lobe.kernel == Kernel::ggx && !(p >= 0 && p <= 1)) {
        throw Error(ExitCode::usage, "roughness: not in [0, 1]; give a value from 0 to 1");
    }
    if (lobe.kernel == Kernel::phong && !(p >= 0 && p <= 1e6)) {
        throw Error(ExitCode::usage, "exponent: not in [0, 1e6]; give a value from 0 to 1000000");
    }
}

bool isMirror(const Lobe& lobe) {
    return lobe.kernel == Kernel::ggx && lobe.parameter < 1e-5;
}

double lobeValue(const Lobe& lobe, double cos_t) {
    if (cos_t <= 0) return 0;
    if (lobe.kernel == Kernel::ggx) {
        const double a2 = alphaOf(lobe) * alphaOf(lobe);
        const double d = a2 + (1 - a2) * 0.5 * (1 - cos_t);
        return a2 / (kPi * d * d) * cos_t;
    }
    return std::pow(cos_t, exponentOf(lobe));
}

double lobeIntegral(const Lobe& lobe) {
    if (lobe.kernel == Kernel::ggx) return ggxCapIntegral(alphaOf(lobe) * alphaOf(lobe), 0, 0.5);
    return 2 * kPi / (exponentOf(lobe) + 1);
}

LobeMassBeyond::LobeMassBeyond(const Lobe& lobe) : kernel_(lobe.kernel) {
    if (kernel_ == Kernel::ggx) {
        alpha_squared_ = alphaOf(lobe) * alphaOf(lobe);
        scale_ = isMirror(lobe) ? 1 : 1 / lobeIntegral(lobe);
    } else {
        exponent_ = exponentOf(lobe);
    }
}

double LobeMassBeyond::operator()(double h) const {
    if (h >= 0.5) return 0;
    if (kernel_ != Kernel::ggx) return std::exp((exponent_ + 1) * std::log1p(-2 * h));
    if (alpha_squared_ < 1e-20) return h > 0 ? 0 : 1;
    return scale_ * ggxCapIntegral(alpha_squared_, h, 0.5);
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

std::vector<double> zonalCoefficients(const Lobe& lobe, int bands) {
    if (isMirror(lobe)) return std::vector<double>(static_cast<std::size_t>(bands), 1.0);
    if (lobe.kernel == Kernel::ggx) return ggxCoefficients(lobe, bands);
    return cosinePowerCoefficients(exponentOf(lobe), bands);
}

} // namespace ibl
