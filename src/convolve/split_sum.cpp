// The integrals are over the half vector h at (theta, phi) about the normal, with the view at
// theta_v, mu = n.v = cos theta_v. With NoH = cos theta,
//
//     n.l = sin theta_v sin 2theta cos phi + mu cos 2theta,   v.h = (n.l + mu) / (2 NoH),
//
// so l is above the horizon for all phi where theta < theta_1 = pi/4 - theta_v/2, for none where
// theta > theta_2 = pi/4 + theta_v/2, and in between for phi < phi_0, where n.l is 0.
//
// Over phi: in s = sin(phi/2) / sin(phi_0/2) (phi_0 = pi where all is above the horizon), with
// kappa = sin^2(phi_0/2) and m = 1 - s^2,
//
//     n.l = floor + 2 a kappa m,   dphi = 2 sqrt(kappa) ds / sqrt(1 - kappa + kappa m),
//
// a = sin theta_v sin 2theta, floor = n.l at phi_0: no cancellation and no trigonometry. The
// visibility turns within n.l ~ alpha or mu of phi_0, so s = 1 - z^4, Gauss points in z.
//
// Over theta the pieces end at theta_1 and theta_2, where the integrand behaves as a square root;
// there the points run with the square of the distance.
#include "convolve/split_sum.h"

#include "convolve/gauss.h"
#include "convolve/simd.h"
#include "core/parallel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kOuterPoints = 16;
constexpr int kInnerPoints = 24;
constexpr int kMostInner = 64;

/// Points over phi, the same for every theta.
struct InnerRule {
    int count = 0;
    std::array<double, kMostInner> m, weight;
};

InnerRule innerRule(int refinement) {
    InnerRule rule;
    const GaussRule& gauss = gaussRule(std::min(32, kInnerPoints * refinement));
    const int parts = (kInnerPoints * refinement + 31) / 32;
    for (int part = 0; part < std::min(parts, 2); ++part) {
        for (std::size_t i = 0; i < gauss.nodes.size(); ++i) {
            const double z = (part + 0.5 + 0.5 * gauss.nodes[i]) / parts, z4 = z * z * z * z;
            rule.m[rule.count] = z4 * (2 - z4);
            rule.weight[rule.count++] = 0.5 * gauss.weights[i] / parts * 4 * z * z * z;
        }
    }
    return rule;
}

/// The half vectors of one theta.
struct Ring {
    double mu;
    double cos_h; ///< n.h
    double floor; ///< n.l at phi_0
    double reach; ///< 2 a kappa
    double kappa;
};

Ring ringAt(double mu, double tan_h) {
    const double c2 = 1 / (1 + tan_h * tan_h), sin_v = std::sqrt((1 - mu) * (1 + mu));
    const double a = sin_v * 2 * tan_h * c2, b = mu * (1 - tan_h) * (1 + tan_h) * c2;
    // cos phi_0 = -b / a
    const double kappa = b >= a ? 1 : std::max(0.0, 0.5 * (a + b) / a);
    return {mu, std::sqrt(c2), std::max(0.0, b - a), 2 * a * kappa, kappa};
}

/// (1/pi) int over phi in [0, phi_0] of 4 V (n.l) (v.h) / (n.h), without and with (1 - v.h)^5.
/// With lambda(c) = sqrt(c^2 (1 - a2) + a2), V is 1 / (2 (l lambda(mu) + mu lambda(l))) of
/// correlated masking and 1 / ((l + lambda(l)) (mu + lambda(mu))) of separable.
IBL_MULTIVERSION SplitSum ggxRing(const Ring& ring, double alpha, const InnerRule& rule,
                                  Masking masking) {
    const double a2 = alpha * alpha, mu = ring.mu, mu_root = std::sqrt(mu * mu * (1 - a2) + a2);
    const bool separable = masking == Masking::separable;
    const double to_h = 0.5 / ring.cos_h;
    std::array<double, kMostInner> bias, total;
    for (int k = 0; k < rule.count; ++k) {
        const double l = ring.floor + ring.reach * rule.m[k];
        const double v_dot_h = (l + mu) * to_h, rest = 1 - v_dot_h;
        const double l_root = std::sqrt(l * l * (1 - a2) + a2);
        const double visibility =
            separable ? 1 / ((l + l_root) * (mu + mu_root)) : 0.5 / (l * mu_root + mu * l_root);
        const double f = rule.weight[k] * visibility * l * v_dot_h /
                         std::sqrt(1 - ring.kappa + ring.kappa * rule.m[k]);
        total[k] = f;
        bias[k] = f * (rest * rest) * (rest * rest) * rest;
    }
    SplitSum sum{0, 0};
    for (int k = 0; k < rule.count; ++k) {
        sum.bias += bias[k];
        sum.total += total[k];
    }
    const double factor = 8 * std::sqrt(ring.kappa) / (ring.cos_h * kPi);
    return {factor * sum.bias, factor * sum.total};
}

/// 2 int over phi in [0, phi_0] of 4 V (n.l) (v.h).
IBL_MULTIVERSION double clothRing(const Ring& ring, const InnerRule& rule) {
    std::array<double, kMostInner> total;
    for (int k = 0; k < rule.count; ++k) {
        const double l = ring.floor + ring.reach * rule.m[k];
        total[k] = rule.weight[k] * l * (l + ring.mu) / (l + ring.mu - l * ring.mu) /
                   std::sqrt(1 - ring.kappa + ring.kappa * rule.m[k]);
    }
    double sum = 0;
    for (int k = 0; k < rule.count; ++k)
        sum += total[k];
    return 2 * std::sqrt(ring.kappa) * sum / ring.cos_h;
}

/// Calls visit(x, weight) at Gauss points over [from, to], in pieces no longer than `longest`; an
/// end that is a square root's has its points run with the square of the distance.
template <class Visit>
void outerPoints(double from, double to, double longest, bool root_left, bool root_right,
                 int refinement, const Visit& visit) {
    if (!(to > from)) return;
    const int pieces = refinement * static_cast<int>(std::ceil((to - from) / longest));
    const GaussRule& rule = gaussRule(kOuterPoints);
    const double length = (to - from) / pieces;
    for (int p = 0; p < pieces; ++p) {
        const bool left = root_left && p == 0, right = root_right && p == pieces - 1;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double y = 0.5 + 0.5 * rule.nodes[i], w = 0.5 * rule.weights[i] * length;
            double at = y, slope = 1;
            if (left && right) {
                at = y * y * (3 - 2 * y);
                slope = 6 * y * (1 - y);
            } else if (left) {
                at = y * y;
                slope = 2 * y;
            } else if (right) {
                at = y * (2 - y);
                slope = 2 - 2 * y;
            }
            visit(from + length * (p + at), w * slope);
        }
    }
}

/// tan theta_1; theta_2's is its inverse.
double tanOfHorizon(double mu) {
    return mu / (1 + std::sqrt((1 - mu) * (1 + mu)));
}

} // namespace

// D (n.h) dh is du dphi / (2 pi) with tan^2 theta = alpha^2 u / (1 - u), and 1 - u = exp(-tau) has
// the long tail in even steps.
SplitSum ggxSplitSum(double n_dot_v, double roughness, int refinement, Masking masking) {
    const double mu = n_dot_v, alpha = roughness * roughness;
    const InnerRule rule = innerRule(refinement);
    const double first = tanOfHorizon(mu) / alpha, last = 1 / (tanOfHorizon(mu) * alpha);
    // The integrand is below 2 / mu.
    const double end = 30 + std::log(2 / mu);
    const double tau_1 = std::min(end, std::log1p(first * first));
    const double tau_2 = std::min(end, std::log1p(last * last));
    SplitSum sum{0, 0};
    const auto add = [&](double tau, double weight) {
        const double tan_h = alpha * std::sqrt(std::expm1(tau));
        const SplitSum ring = ggxRing(ringAt(mu, tan_h), alpha, rule, masking);
        sum.bias += weight * std::exp(-tau) * ring.bias;
        sum.total += weight * std::exp(-tau) * ring.total;
    };
    constexpr double kPiece = 4;
    outerPoints(0, tau_1, kPiece, false, true, refinement, add);
    outerPoints(tau_1, tau_2, kPiece, true, true, refinement, add);
    return sum;
}

// D = (2 + p) sin^p theta / (2 pi), p = 1 / alpha, and dh = dc dphi with c = n.h. In c, sin^p is
// (1 - c^2)^(p/2), largest at the horizon's c_2 = cos theta_2, and the rest of the integrand varies
// as c does, so the pieces are even in log c.
double clothSplitSum(double n_dot_v, double roughness, int refinement) {
    const double mu = n_dot_v, p = 1 / (roughness * roughness);
    const InnerRule rule = innerRule(refinement);
    const double t = tanOfHorizon(mu), c_1 = 1 / std::sqrt(1 + t * t), c_2 = t * c_1;
    double sum = 0;
    const auto add = [&](double log_c, double weight) {
        const double c = std::exp(log_c), tan_h = std::sqrt(std::max(0.0, (1 - c) * (1 + c))) / c;
        const double lobe = std::exp(0.5 * p * std::log1p(-c * c));
        sum += weight * c * lobe * clothRing(ringAt(mu, tan_h), rule);
    };
    // Beyond it the distribution is below exp(-40) of what it can be.
    const double end = 0.5 * std::log(-std::expm1(-80 / p));
    constexpr double kPiece = 0.6;
    outerPoints(std::log(c_2), std::min(std::log(c_1), end), kPiece, true, true, refinement, add);
    outerPoints(std::log(c_1), end, kPiece, true, true, refinement, add);
    return (2 + p) / (2 * kPi) * sum;
}

SplitSumTable splitSumTable(const SplitSumOptions& options) {
    const int n = options.size, rows = options.roughness ? 1 : n;
    SplitSumTable table{Image(n, rows), 0};
    const int step = std::max(1, n / 8); // texels looked at again, the smoothest and grazing among
                                         // them
    std::vector<double> moved(static_cast<std::size_t>(rows), 0.0);
    parallelFor(static_cast<std::size_t>(rows), options.threads, [&](std::size_t row) {
        const int j = static_cast<int>(row);
        const double roughness =
            options.roughness ? std::max(*options.roughness, 0.5 / n) : (j + 0.5) / n;
        for (int i = 0; i < n; ++i) {
            const double mu = (i + 0.5) / n;
            const SplitSum ggx = ggxSplitSum(mu, roughness, 1, options.masking);
            const double cloth = options.cloth ? clothSplitSum(mu, roughness) : 0;
            float* texel = table.image.at(i, j);
            texel[0] = static_cast<float>(options.multiscatter ? ggx.bias : ggx.total - ggx.bias);
            texel[1] = static_cast<float>(options.multiscatter ? ggx.total : ggx.bias);
            texel[2] = static_cast<float>(cloth);
            if (i % step != 0 || j % step != 0) continue;
            const SplitSum fine = ggxSplitSum(mu, roughness, 2, options.masking);
            moved[row] = std::max(
                {moved[row], std::abs(fine.total - ggx.total), std::abs(fine.bias - ggx.bias)});
            if (options.cloth)
                moved[row] =
                    std::max(moved[row], std::abs(clothSplitSum(mu, roughness, 2) - cloth));
        }
    });
    table.error_estimate = *std::ranges::max_element(moved);
    return table;
}

} // namespace ibl
