// Short pieces of curves on the sphere: parallels, meridians, texels' sides.
#pragma once

#include "panorama/conventions.h"

#include <array>
#include <utility>

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

/// A quadrature point on a curve: where, and the line element times its weight.
struct ArcPoint {
    V3d at, along;
};

/// Gauss points, off the sphere by the quadratic's own error.
std::array<ArcPoint, 2> twoPoints(const Arc& arc);
std::array<ArcPoint, 3> threePoints(const Arc& arc);

} // namespace ibl
