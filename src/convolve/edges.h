// Exact integrals of zonal kernels over lat-long rectangles, by their edges.
//
// Let M(t) be the mass of a kernel within the angle t of its axis and Q = M - M(pi), which is 0
// from the kernel's horizon on. In polar coordinates (t, chi) about the axis the mass over a region
// is the integral of dM dchi / 2 pi, so by Green's theorem
//
//     int_region K = M(pi) [axis in region] + 1/(2 pi) oint Q(t) dchi   (counter-clockwise),
//
// and summed over the pixels of a piecewise-constant probe only the steps across edges remain:
//
//     (K * L)(x) = M(pi) L(x) + 1/(2 pi) sum over edges of (L_left - L_right) int Q dchi.
//
// It holds for any lobe, however much narrower than a pixel, where sampling inside of pixels fails.
// Along an edge at the distance d the angle chi runs like atan(s/d): the variable s = d sinh(tau)
// takes that in evenly at every scale, so few Gauss points suffice.
#pragma once

#include "convolve/gauss.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ibl {

/// A lobe axis on the sphere: colatitude theta and azimuth psi = 2 pi u.
struct Axis {
    double theta;
    double psi;
    double sin_theta;
    double cos_theta;
};

/// The axis at the lat-long point (u, v), moved off it by far less than any lobe's width: texel
/// centres often lie exactly on pixels' edges and corners, where the angle chi has no value.
inline Axis makeAxis(double u, double v) {
    const double theta = std::numbers::pi * v + (v < 0.5 ? 1.7e-10 : -1.7e-10);
    return {theta, 2 * std::numbers::pi * u + 1.3e-10, std::sin(theta), std::cos(theta)};
}

namespace edges {

/// Quadrature over s in [from, to] of an integrand that varies over s ~ scale about s = 0. Edges
/// longer than `longest` are taken in pieces.
template <class F>
double sinhQuadrature(double from, double to, double scale, double longest, const F& integrand) {
    if (to - from > 1.01 * longest) {
        const int pieces = static_cast<int>(std::ceil((to - from) / longest));
        double sum = 0;
        for (int i = 0; i < pieces; ++i) {
            sum += sinhQuadrature(from + (to - from) * i / pieces,
                                  from + (to - from) * (i + 1) / pieces, scale, longest, integrand);
        }
        return sum;
    }
    const double low = std::asinh(from / scale), high = std::asinh(to / scale);
    const int n =
        std::clamp(3 + static_cast<int>(2.5 * (high - low) + 4 * (to - from) / longest), 3, 32);
    const GaussRule& rule = gaussRule(n);
    const double half = 0.5 * (high - low), mid = 0.5 * (high + low);
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double tau = mid + half * rule.nodes[i];
        sum += rule.weights[i] * scale * std::cosh(tau) * integrand(scale * std::sinh(tau));
    }
    return half * sum;
}

} // namespace edges

/// int Q dchi along the parallel at colatitude theta, eastwards over azimuths from axis.psi + from
/// to axis.psi + to (within a turn). Q takes h = sin^2(t/2) and varies over `longest` radians or
/// more, or in proportion to t.
template <class Q>
double parallelIntegral(const Q& q, const Axis& axis, double theta, double from, double to,
                        double longest) {
    const double sin_e = std::sin(theta), cos_e = std::cos(theta);
    const double near = std::sin(0.5 * (theta - axis.theta)), h0 = near * near;
    const double s2 = sin_e * axis.sin_theta;
    if (sin_e < 1e-15) return 0; // a pole
    const double scale =
        std::clamp(2 * std::abs(near) / std::sqrt(std::max(s2, 1e-300)), 1e-14, 1e3);
    // x . (p x dp/dpsi) = sin e (sin e cos x - cos e sin x cos delta)
    //                   = sin e (sin(e - x) + 2 cos e sin x sin^2(delta/2))
    const double sin_gap = std::sin(theta - axis.theta);
    return edges::sinhQuadrature(
        from, to, scale, std::min(longest / sin_e, 0.6), [&](double delta) {
            const double half = std::sin(0.5 * delta), half2 = half * half;
            const double h = std::min(1.0, h0 + s2 * half2);
            const double numerator = sin_e * (sin_gap + 2 * cos_e * axis.sin_theta * half2);
            return q(h) * numerator / std::max(4 * h * (1 - h), 1e-300);
        });
}

/// int Q dchi along the meridian at azimuth axis.psi + offset, northwards from colatitude `bottom`
/// to `top` < bottom.
template <class Q>
double meridianIntegral(const Q& q, const Axis& axis, double offset, double top, double bottom,
                        double longest) {
    const double half = std::sin(0.5 * offset);
    const double distance = std::abs(axis.sin_theta * std::sin(offset));
    // The nearest point of the meridian's great circle is at tan e = tan x cos offset.
    const double nearest = std::atan2(axis.sin_theta * std::cos(offset), axis.cos_theta);
    const double numerator = axis.sin_theta * std::sin(offset);
    if (numerator == 0) return 0;
    const double scale = std::max(distance, 1e-14);
    return edges::sinhQuadrature(top - nearest, bottom - nearest, scale, longest, [&](double s) {
        const double theta = nearest + s;
        const double gap = std::sin(0.5 * (theta - axis.theta));
        const double h =
            std::clamp(gap * gap + std::sin(theta) * axis.sin_theta * half * half, 0.0, 1.0);
        return q(h) * numerator / std::max(4 * h * (1 - h), 1e-300);
    });
}

} // namespace ibl
