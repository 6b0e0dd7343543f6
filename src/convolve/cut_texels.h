// What a ball map's disc leaves of the texels at its rim. Places in the map: x to the right and y
// down in [-1, 1], the disc of radius 1 about 0; the whole rim looks along -Z.
#pragma once

#include "convolve/arcs.h"
#include "convolve/gauss.h"
#include "panorama/panorama.h"

#include <vector>

namespace ibl {

/// A texel or a footprint within it.
struct MapRectangle {
    V2d low, high;
};

/// Of texel (x, y) of an n x n ball map, shrunk to `scale` about its centre; with scale 1 as well
/// those of the texels that it owns (square_maps.h).
std::vector<MapRectangle> ownRectangles(Layout layout, int n, int x, int y, double scale);

/// The direction of a place in a ball map, -Z on the rim and beyond.
V3d ballDirection(Layout layout, const V2d& place);

/// A quadrature point of an area of the map.
struct MapPoint {
    V2d at;
    double area;
};

/// Adds the points of a product of the rule with itself, stretched to the part within the disc.
void addCutPoints(Layout layout, const MapRectangle& rectangle, const GaussRule& rule,
                  std::vector<MapPoint>& points);

/// Adds what of the four sides lies within the disc, in pieces of about `longest` radians, as polar
/// directions (peaks.h). With the rim, which is one direction, they close.
void addCutOutline(Layout layout, const MapRectangle& rectangle, double longest,
                   std::vector<Arc>& outline);

} // namespace ibl
