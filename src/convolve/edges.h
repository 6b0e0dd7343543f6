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
/// centres often lie exactly on pixels' edges and corners, where the angle chi has no value. At the
/// poles, where all meridians meet, as far along the parallel, which is a large angle there.
inline Axis makeAxis(double u, double v) {
    const double theta = std::numbers::pi * v + (v < 0.5 ? 1.7e-10 : -1.7e-10);
    const double sin_theta = std::sin(theta);
    return {theta, 2 * std::numbers::pi * u + 1.3e-10 / sin_theta, sin_theta, std::cos(theta)};
}

namespace edges {

/// Quadrature over s in [from, to] of an integrand that varies over s ~ scale about s = 0, in
/// pieces that are at most `longest` long and of which Gauss points see at most the poles at tau =
/// +-i pi/2, half as far away as the piece is long or farther: 14 points then leave 1e-9.
template <class F>
double sinhQuadrature(double from, double to, double scale, double longest, const F& integrand) {
    const double end = std::asinh(to / scale);
    double sum = 0;
    for (double low = std::asinh(from / scale), s = from; low < end;) {
        const double high = std::min({low + 3, std::asinh((s + longest) / scale), end});
        const double next = high < end ? scale * std::sinh(high) : to;
        const int n = 4 + static_cast<int>(2.5 * (high - low) + 4 * (next - s) / longest);
        const GaussRule& rule = gaussRule(n);
        const double half = 0.5 * (high - low), mid = 0.5 * (high + low);
        for (int i = 0; i < n; ++i) {
            // scale * (sinh, cosh) of tau, from one exponential
            const double e = std::exp(mid + half * rule.nodes[i]), inverse = 1 / e;
            sum += half * rule.weights[i] * 0.5 * scale * (e + inverse) *
                   integrand(0.5 * scale * (e - inverse));
        }
        low = high;
        s = next;
    }
    return sum;
}

} // namespace edges

/// Where a kernel's Q is not 0, and how fast it varies there: over `variation` radians or more, or
/// in proportion to the distance from the axis. A horizon, where Q has a kink, is the disc's rim.
struct Disc {
    double radius; ///< at most pi / 2
    double variation;
};

/// int Q dchi along the parallel at colatitude theta, eastwards over azimuths from axis.psi + from
/// to axis.psi + to (at most a turn, within two of 0). Q takes h = sin^2(t/2).
template <class Q>
double parallelIntegral(const Q& q, const Disc& disc, const Axis& axis, double theta, double from,
                        double to) {
    const double sin_e = std::sin(theta), cos_e = std::cos(theta);
    const double near = std::sin(0.5 * (theta - axis.theta)), h0 = near * near;
    const double s2 = sin_e * axis.sin_theta, rim = std::sin(0.5 * disc.radius);
    const double room = rim * rim - h0; // of s2 sin^2(delta/2)
    if (sin_e < 1e-15 || room <= 0) return 0;
    const double reach = room >= s2 ? std::numbers::pi : 2 * std::asin(std::sqrt(room / s2));
    const double scale =
        std::clamp(2 * std::abs(near) / std::sqrt(std::max(s2, 1e-300)), 1e-14, 1e3);
    const double longest = std::min(disc.variation / sin_e, 0.6);
    // x . (p x dp/dpsi) = sin e (sin e cos x - cos e sin x cos delta)
    //                   = sin e (sin(e - x) + 2 cos e sin x sin^2(delta/2))
    const double sin_gap = std::sin(theta - axis.theta);
    const auto integrand = [&](double delta) {
        const double half = std::sin(0.5 * delta), half2 = half * half;
        const double h = std::min(1.0, h0 + s2 * half2);
        const double numerator = sin_e * (sin_gap + 2 * cos_e * axis.sin_theta * half2);
        return q(h) * numerator / std::max(4 * h * (1 - h), 1e-300);
    };
    double sum = 0;
    for (int turn = -1; turn <= 1; ++turn) {
        const double shift = 2 * std::numbers::pi * turn;
        const double low = std::max(from - shift, -reach), high = std::min(to - shift, reach);
        if (low < high) sum += edges::sinhQuadrature(low, high, scale, longest, integrand);
    }
    return sum;
}

/// int Q dchi along the meridian at azimuth axis.psi + offset, northwards from colatitude `bottom`
/// to `top` < bottom.
template <class Q>
double meridianIntegral(const Q& q, const Disc& disc, const Axis& axis, double offset, double top,
                        double bottom) {
    const double half = std::sin(0.5 * offset), numerator = axis.sin_theta * std::sin(offset);
    const double distance = std::asin(std::min(1.0, std::abs(numerator)));
    if (numerator == 0 || distance >= disc.radius) return 0;
    // The great circle is nearest at tan e = tan x cos offset, and leaves the disc after w:
    // cos radius = cos distance cos w.
    double nearest = std::atan2(axis.sin_theta * std::cos(offset), axis.cos_theta);
    if (nearest < -0.5 * std::numbers::pi) nearest += 2 * std::numbers::pi; // past the south pole
    const double w = std::acos(std::cos(disc.radius) / std::cos(distance));
    const double low = std::max(top - nearest, -w), high = std::min(bottom - nearest, w);
    if (low >= high) return 0;
    const double scale = std::max(distance, 1e-14);
    return edges::sinhQuadrature(low, high, scale, disc.variation, [&](double s) {
        const double theta = nearest + s;
        const double gap = std::sin(0.5 * (theta - axis.theta));
        const double h =
            std::clamp(gap * gap + std::sin(theta) * axis.sin_theta * half * half, 0.0, 1.0);
        return q(h) * numerator / std::max(4 * h * (1 - h), 1e-300);
    });
}

/// A lat-long rectangle: colatitudes and azimuths psi.
struct Rectangle {
    double top, bottom;
    double west, east;
};

/// Mass over the rectangle of a kernel of that total mass, Q(h) = mass within t less the total.
template <class Q>
double rectangleMass(const Q& q, double total, const Disc& disc, const Axis& axis,
                     const Rectangle& r) {
    // The rectangle's azimuths about the axis's, as near as can be.
    constexpr double kTurn = 2 * std::numbers::pi;
    const double turn = kTurn * std::round((0.5 * (r.west + r.east) - axis.psi) / kTurn);
    const double west = r.west - turn - axis.psi, east = r.east - turn - axis.psi;
    const bool inside = axis.theta > r.top && axis.theta < r.bottom && west < 0 && east > 0;
    const double ring = parallelIntegral(q, disc, axis, r.bottom, west, east) -
                        parallelIntegral(q, disc, axis, r.top, west, east);
    // Counter-clockwise: the east side northwards, the west side southwards.
    const double sides = meridianIntegral(q, disc, axis, east, r.top, r.bottom) -
                         meridianIntegral(q, disc, axis, west, r.top, r.bottom);
    return (inside ? total : 0) + (ring + sides) / kTurn;
}

} // namespace ibl
