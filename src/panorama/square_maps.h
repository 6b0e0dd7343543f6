// The layouts that show the whole sphere in one square: angular map, mirror ball, octahedral.
//
// With a to the right and b up in [-1, 1] and rho = hypot(a, b):
// - angular map, seen from inside: (-a s, b s, cos(pi rho)), s = sin(pi rho) / rho. Solid angle per
//   area pi sin(pi rho) / rho.
// - mirror ball, a photograph of one, so mirrored: c = sqrt(1 - rho^2), (2ca, 2cb, 2c^2 - 1). It
//   keeps areas: 4 steradians per area. Its whole rim shows -Z, where pixels are stretched
//   without limit around the rim: it is singular there.
// - octahedral: p = d / |d|_1, unfolded about -Y; solid angle per area of (px, pz) 1 / |p|^3.
//
// A ball map's texel whose centre is outside the disc has no direction and is written as 0. What
// little of the disc lies in such a texel belongs to the nearest texel towards the middle that has
// one (`owningTexel`), so that solid angles sum to 4 pi.
#pragma once

#include "panorama/panorama.h"

#include <Imath/ImathVec.h>

#include <optional>

namespace ibl {

/// Whether the layout is one of these.
bool isSquareMap(Layout layout);
/// Whether it is the angular map or the mirror ball, which fill a disc only.
bool isBallMap(Layout layout);

/// Unit direction of a point, u to the right and v down in [0, 1]; nothing outside a ball map's
/// disc.
std::optional<Imath::V3d> squareMapDirection(Layout layout, double u, double v);

/// Point (u, v) of a direction of any length but 0. A ball map's -Z lies all around its rim; the
/// point at b = 0, a = 1 is given.
Imath::V2d squareMapPoint(Layout layout, const Imath::V3d& direction);

/// The t at which from + t (to - from), in [-1, 1] with the disc of radius 1, crosses a ball map's
/// rim, the lesser first; nothing for a line that misses or only touches it.
std::optional<Imath::V2d> rimCrossings(const Imath::V2d& from, const Imath::V2d& to);

/// The texel that the points of texel (x, y) of an n x n map belong to: itself, unless its centre
/// is outside the disc. Nothing where the texel has no part in the disc.
std::optional<Imath::V2i> owningTexel(Layout layout, int n, int x, int y);

/// Solid angle of what belongs to texel (x, y) of an n x n map, steradians, to rounding; 0 where
/// its centre is outside the disc. They sum to 4 pi.
double squareMapSolidAngle(Layout layout, int n, int x, int y);

} // namespace ibl
