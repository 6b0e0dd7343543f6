// Zonal coefficients: in closed form for powers of the cosine, by quadrature for all other lobes.
//
// The quadrature is Gauss's over panels in t that end at the horizon, where every kernel has its
// kink. Nodes enter as delta = 1 - cos t = 2 sin^2(t/2), which keeps its precision at the axis, and
// the Legendre polynomials come from Bonnet's recurrence in its difference form: with
// E_l = l (P_l - P_(l-1)),
//
//     E_(l+1) = E_l - (2l + 1) delta P_l,   P_(l+1) = P_l + E_(l+1) / (l + 1).
//
// The usual form loses l^2 / 2 units in the last place near t = 0 (a mirror's lobe of roughness
// 1e-4 lies within 1e-8 of its axis, where cos t is 1 in double precision); this one does not.
#include "convolve/gauss.h"
#include "convolve/lobe.h"
#include "convolve/simd.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr int kPoints = 32;
constexpr double kHorizon = 0.5 * std::numbers::pi;

/// Radians of P_l's phase that a panel holds. On an ellipse of semi-axes' sum rho about the panel,
/// P_l grows as exp(25 (rho - 1/rho) / 2), and 32 points leave rho^-64 of what the integrand is
/// there: 1e-16 at rho = 3, within which panelWidth() keeps the kernels smooth.
constexpr double kPanelPhase = 50;

/// A kernel along its radius: where it begins and ends to within 1e-17 of its integral, the widest
/// panel that starts at t, and its value times the solid angle's sin t, up to a factor.
struct RadialLobe {
    Kernel kernel;
    double alpha = 0;    ///< ggx
    double exponent = 0; ///< blinn-phong: n; charlie: q = 1 / (2 alpha)
    double begin = 0;
    double end = kHorizon;
};

RadialLobe radialLobe(const Lobe& lobe) {
    RadialLobe radial{lobe.kernel};
    const double alpha = lobe.parameter * lobe.parameter;
    radial.end = lobeReach(lobe);
    if (lobe.kernel == Kernel::ggx) {
        radial.alpha = alpha;
    } else if (lobe.kernel == Kernel::blinnPhong) {
        radial.exponent = lobe.parameter;
    } else {
        radial.exponent = 0.5 / alpha;
        // The mass within is below (q + 2) y^(q+1), y = 1 - cos t.
        const double q = radial.exponent;
        radial.begin = std::acos(1 - std::exp(-(40 + std::log(q + 2)) / (q + 1)));
    }
    return radial;
}

/// Widths at which the kernel's singularities, or its growth, are as far off as kPanelPhase wants:
/// GGX has poles at t = +-2i alpha; Blinn-Phong is about exp(-n t^2 / 8); Charlie is t^(2q) near 0
/// and changes by exp(q cot(t/2) dt).
double panelWidth(const RadialLobe& lobe, double t) {
    switch (lobe.kernel) {
    case Kernel::ggx:
        return 2 * (t + lobe.alpha);
    case Kernel::blinnPhong:
        return lobe.exponent > 0 ? 8 / std::sqrt(lobe.exponent) : kHorizon;
    default:
        return std::min(2 * t, 6 * std::tan(0.5 * t) / lobe.exponent);
    }
}

double radialDensity(const RadialLobe& lobe, double t) {
    const double s = std::sin(0.5 * t), area = std::sin(t) * std::cos(t);
    switch (lobe.kernel) {
    case Kernel::ggx: {
        const double d = lobe.alpha * lobe.alpha + (1 - lobe.alpha * lobe.alpha) * s * s;
        return area / (d * d);
    }
    case Kernel::blinnPhong:
        return area * std::exp(0.5 * lobe.exponent * std::log1p(-s * s));
    default:
        return area * std::pow(2 * s * s, lobe.exponent);
    }
}

/// Four doubles: what AVX2 holds in a register. (Of wider vectors GCC 12 keeps the recurrence's
/// state in memory there, at four times the cost.)
typedef double Quad __attribute__((vector_size(4 * sizeof(double))));
constexpr std::size_t kQuad = 4;

/// Quadrature nodes, a multiple of kBlock vectors.
struct Nodes {
    std::vector<Quad, LaneAllocator<Quad>> delta;
    std::vector<Quad, LaneAllocator<Quad>> weight;
};

constexpr std::size_t kBlock = 4;

Nodes makeNodes(const RadialLobe& lobe, int bands) {
    const GaussRule& rule = gaussRule(kPoints);
    Nodes nodes;
    double t = lobe.begin;
    while (t < lobe.end) {
        const double rest = lobe.end - t;
        const double panels = std::ceil(rest / std::min(panelWidth(lobe, t), kPanelPhase / bands));
        const double half = 0.5 * rest / panels, middle = t + half;
        for (std::size_t i = 0; i < kPoints; ++i) {
            if (i % kQuad == 0) {
                nodes.delta.push_back(Quad{});
                nodes.weight.push_back(Quad{});
            }
            const double at = middle + half * rule.nodes[i], s = std::sin(0.5 * at);
            nodes.delta.back()[i % kQuad] = 2 * s * s;
            nodes.weight.back()[i % kQuad] = half * rule.weights[i] * radialDensity(lobe, at);
        }
        t = panels > 1 ? t + 2 * half : lobe.end;
    }
    return nodes;
}
static_assert(kPoints % (kBlock * kQuad) == 0);

/// sums[l] += weight * P_l(1 - delta), lane by lane, for l < bands.
IBL_MULTIVERSION void addLegendre(const Quad* delta, const Quad* weight, std::size_t vectors,
                                  const double* inverse, int bands, Quad* sums) {
    for (std::size_t first = 0; first < vectors; first += kBlock) {
        Quad p[kBlock], e[kBlock], d[kBlock], w[kBlock];
        for (std::size_t v = 0; v < kBlock; ++v) {
            p[v] = Quad{} + 1.0;
            e[v] = Quad{};
            d[v] = delta[first + v];
            w[v] = weight[first + v];
        }
        for (int l = 0; l < bands; ++l) {
            Quad sum = sums[l];
            const double odd = 2.0 * l + 1, next = inverse[l];
            for (std::size_t v = 0; v < kBlock; ++v) {
                sum += w[v] * p[v];
                e[v] -= odd * d[v] * p[v];
                p[v] += next * e[v];
            }
            sums[l] = sum;
        }
    }
}

std::vector<double> byQuadrature(const Lobe& lobe, int bands) {
    const Nodes nodes = makeNodes(radialLobe(lobe), bands);
    const std::size_t count = static_cast<std::size_t>(bands);
    std::vector<double> inverse(count), k(count);
    for (std::size_t l = 0; l < count; ++l)
        inverse[l] = 1 / (static_cast<double>(l) + 1);
    std::vector<Quad, LaneAllocator<Quad>> sums(count, Quad{});
    addLegendre(nodes.delta.data(), nodes.weight.data(), nodes.delta.size(), inverse.data(), bands,
                sums.data());
    for (std::size_t l = 0; l < count; ++l) {
        for (int lane = 0; lane < static_cast<int>(kQuad); ++lane)
            k[l] += sums[l][lane];
    }
    const double whole = k[0];
    for (double& v : k)
        v /= whole;
    return k;
}

/// For every real n >= 0 int_0^1 x^n P_l is sqrt(pi) 2^(-n-1) Gamma(n + 1) over
/// Gamma(1 + (n - l)/2) Gamma((n + l + 3)/2), so it is int_0^1 x^n P_(l-2) times
/// (n - l + 2) / (n + l + 1); Lambert is n = 1. These are products alone, none above 1: each step
/// adds a few units in the last place of the coefficient itself, whatever n and l.
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

} // namespace

std::vector<double> zonalCoefficients(const Lobe& lobe, int bands) {
    if (isMirror(lobe)) return std::vector<double>(static_cast<std::size_t>(bands), 1.0);
    if (lobe.kernel == Kernel::lambert) return cosinePowerCoefficients(1, bands);
    if (lobe.kernel == Kernel::phong) return cosinePowerCoefficients(lobe.parameter, bands);
    return byQuadrature(lobe, bands);
}

} // namespace ibl
