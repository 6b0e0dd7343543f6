// Short pieces of curves on the sphere: parallels, meridians, texels' sides.
#pragma once

#include "panorama/conventions.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace ibl {

/// The quadratic through three directions, at s = -1, 0 and 1, drawn onto the sphere. Of a turn of
/// w radians it is off by w^3 / 125 along itself, which does not matter, and by w^4 / 400 across.
struct Arc {
    V3d a, m, b;

    V3d at(double s) const {
        const V3d q = m + ((b - a) * 0.5 + ((a + b) * 0.5 - m) * s) * s;
        return q * (1 / q.length());
    }
    double length() const { return (m - a).length() + (b - m).length(); }
    /// Distance of the middle from the chord.
    double sagitta() const { return ((a + b) * 0.5 - m).length(); }
    std::pair<Arc, Arc> halves() const { return {{a, at(-0.5), m}, {m, at(0.5), b}}; }
};

/// Appends the smooth curve place(t), t from `from` to `to`, in `least` pieces or more, each at
/// most `longest` radians long and turning by no more.
template <class Place>
void addCurve(const Place& place, double from, double to, int least, double longest,
              std::vector<Arc>& outline) {
    V3d a = place(from);
    const Arc whole{a, place(0.5 * (from + to)), place(to)};
    const double length = whole.length(), turn = length > 0 ? 8 * whole.sagitta() / length : 0;
    const int pieces =
        std::max(least, static_cast<int>(std::ceil(std::max(length, turn) / longest)));
    if (pieces == 1) {
        outline.push_back(whole);
        return;
    }
    const double piece = (to - from) / pieces;
    for (int k = 0; k < pieces; ++k) {
        const V3d b = place(from + (k + 1) * piece);
        outline.push_back({a, place(from + (k + 0.5) * piece), b});
        a = b;
    }
}

/// A quadrature point on a curve: where, and the line element times its weight.
struct ArcPoint {
    V3d at, along;
};

/// Gauss points, off the sphere by the quadratic's own error.
std::array<ArcPoint, 2> twoPoints(const Arc& arc);
std::array<ArcPoint, 3> threePoints(const Arc& arc);

} // namespace ibl
