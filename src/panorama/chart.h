// A probe's image as flat pieces of the sphere, into which polygons are carried.
#pragma once

#include "panorama/conventions.h"
#include "panorama/panorama.h"

#include <vector>

namespace ibl {

/// A polygon on the sphere: directions joined by great circles; it may touch itself.
using SpherePolygon = std::vector<V3d>;

/// What belongs to the square of that size at (x, y) of a lat-long's, of faces' or of a square
/// map's image, without what lies outside a ball map's disc: appended to `outline`. Sides are
/// followed to `tolerance` radians and their areas kept; squares that share one share its vertices.
/// A ball map's whole rim is the one vertex -Z. Nothing for a square outside the disc; not for one
/// that holds the whole disc.
void appendCell(const Panorama& panorama, double x, double y, double size, double tolerance,
                SpherePolygon& outline);

/// A part of the sphere that the image shows without a fold or a seam, and what its rim needs.
struct Sector {
    std::vector<V3d> normals; ///< d . normal >= 0 for all
    V3d signs{0, 0, 0};       ///< of the components, where the sides are the planes of axes
    int face = -1;            ///< of faces
};

/// The sectors of a lat-long (quarters, in which the poles are corners), of a ball map (the same
/// about Z), an octahedral map (octants) or of faces.
std::vector<Sector> sectorsOf(Layout layout);

/// The polygon's part in a sector.
void clipTo(const Sector& sector, const SpherePolygon& polygon, SpherePolygon& part);

/// Carries a polygon within a sector into the chart, where its sides are followed to `kBend` pixels
/// and their areas kept. Charts are images in pixels, but for a lat-long's y, which is -cos(theta):
/// there area is solid angle.
void carry(const Panorama& panorama, const Sector& sector, const SpherePolygon& part,
           std::vector<V2d>& flat);

/// Solid angle to a unit of area at a point of the chart, but for a constant factor, and its
/// second derivatives by the chart's coordinates.
struct ChartDensity {
    double value;
    double xx, xy, yy;
};

ChartDensity chartDensity(const Panorama& panorama, const V2d& p);

} // namespace ibl
