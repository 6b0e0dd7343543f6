#include "panorama/octant.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ibl {
namespace {

/// Of `area` below a line over a row from one longitude to another, in columns, where it is at
/// parts p and q of the row's height.
Mass belowLine(const Bands& bands, std::size_t row, double area, double from, double to, double p,
               double q, double middle) {
    if (!(p + q > 0)) return {area, area * (0.5 * (from + to) - middle), 0};
    const double x = from + (to - from) * (p + 2 * q) / (3 * (p + q));
    const double y = (p * p + p * q + q * q) / (3 * (p + q));
    return {area, area * (x - middle), area * bands.fromMiddle(row, y)};
}

} // namespace

double Curve::tangent(const Longitude& at) const {
    switch (kind) {
    case CurveKind::sideRow:
        return g * at.cosine;
    case CurveKind::poleAlong:
        return g / at.cosine;
    default:
        return g / at.sine;
    }
}

double Curve::height(double tangent) const {
    const double root = std::sqrt(1 + tangent * tangent);
    return kind == CurveKind::sideRow ? tangent / root : tangent * tangent / (root * (root + 1));
}

Longitude Curve::at(double tangent, double columns_per_radian) const {
    double cosine, sine;
    if (kind == CurveKind::poleAcross) {
        sine = std::min(1.0, g / tangent);
        cosine = std::sqrt(1 - sine * sine);
    } else {
        cosine = std::min(1.0, kind == CurveKind::sideRow ? tangent / g : g / tangent);
        sine = std::sqrt(1 - cosine * cosine);
    }
    return {std::atan2(sine, cosine) * columns_per_radian, sine, cosine};
}

double Curve::area(const Longitude& from, const Longitude& to) const {
    if (g == 0) return 0;
    if (kind == CurveKind::sideRow) {
        const double kappa = g / std::sqrt(1 + g * g);
        return std::abs(std::asin(kappa * to.sine) - std::asin(kappa * from.sine));
    }
    const bool along = kind == CurveKind::poleAlong;
    const double o0 = g * (along ? from.sine / from.cosine : from.cosine / from.sine);
    const double o1 = g * (along ? to.sine / to.cosine : to.cosine / to.sine);
    const double n0 = std::sqrt(1 + g * g + o0 * o0), n1 = std::sqrt(1 + g * g + o1 * o1);
    const double numerator = g * std::abs(o1 - o0);
    return 2 * std::atan2(numerator, n0 * n1 + 1 + g * g + o0 * o1 + n0 + n1);
}

Coverage& cover(const Octant& octant, const Curve& curve, const Longitude& a, const Longitude& b,
                double middle, Coverage& out) {
    out.masses.clear();
    out.first = 0;
    out.last = -1;
    if (curve.g == 0) return out;
    const std::vector<double>& tangent = octant.bands.tangent;
    const std::vector<double>& height = octant.bands.area;
    const double ta = curve.tangent(a), tb = curve.tangent(b);
    const Longitude low = ta <= tb ? a : b, high = ta <= tb ? b : a;
    const double highest = std::max(ta, tb);
    const auto above = std::upper_bound(tangent.begin() + 1, tangent.end() - 1, std::min(ta, tb));
    out.first = static_cast<int>(above - tangent.begin()) - 1;

    // Upwards along the curve from row to row. Past its crossing into the next row, all of a row
    // lies below the curve.
    const double radians = 1 / octant.columns_per_radian;
    const double total = std::abs(b.x - a.x) * radians;
    const auto part = [&](std::size_t row, double tangent_of_height) {
        const double z = curve.height(tangent_of_height);
        return std::clamp((z - height[row]) / octant.bands.height(row), 0.0, 1.0);
    };
    double done = 0;
    Longitude from = low;
    double from_part = part(static_cast<std::size_t>(out.first), std::min(ta, tb));
    for (int row = out.first;; ++row) {
        const auto k = static_cast<std::size_t>(row);
        const bool last = !(tangent[k + 1] < highest);
        const Longitude to = last ? high : curve.at(tangent[k + 1], octant.columns_per_radian);
        const double length = last ? total - done : std::abs(to.x - from.x) * radians;
        done += length;
        const double piece = std::max(0.0, curve.area(from, to) - length * height[k]);
        const Mass below = belowLine(octant.bands, k, piece, from.x, to.x, from_part,
                                     last ? part(k, highest) : 1, middle);
        out.masses.push_back(below + octant.full(k, to.x, high.x, middle));
        out.last = row;
        if (last) return out;
        from = to;
        from_part = 0;
    }
}

Bands sideBands(const LatlongGrid& grid) {
    Bands bands{{0}, {0}, grid.rows() % 2 == 1};
    for (int row = (grid.rows() - 1) / 2; row >= 0; --row) {
        const double theta = grid.theta[static_cast<std::size_t>(row)];
        bands.tangent.push_back(row == 0 ? std::numeric_limits<double>::infinity()
                                         : std::cos(theta) / std::sin(theta));
        bands.area.push_back(std::cos(theta));
    }
    return bands;
}

Bands poleBands(const LatlongGrid& grid) {
    Bands bands;
    for (double theta : grid.theta) {
        const double half = std::sin(0.5 * theta);
        bands.tangent.push_back(theta < 0.499 * kPi ? std::tan(theta)
                                                    : std::numeric_limits<double>::infinity());
        bands.area.push_back(2 * half * half);
    }
    return bands;
}

} // namespace ibl
