// The directions that an output's texels look along.
#pragma once

#include "convolve/lobe.h"
#include "convolve/prefilter.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"

#include <array>
#include <vector>

namespace ibl {

/// Points within each texel at which a field is read: samples x samples, spread over the texel
/// shrunk to `scale` of its extent about its centre. One sample is the centre.
struct Footprint {
    double scale = 0;
    int samples = 1;
    double texel = 0;         ///< what it is for: the extent of a texel, radians,
    double lobe_diameter = 0; ///< of the lobe,
    int degree = 0;           ///< and the field's degree
};

/// The degree of a field that has none: only the lobe limits what is to be seen.
inline constexpr int kAnyDegree = 1 << 20;

/// The angle that a texel of the map covers, about.
double texelAngle(const PrefilterRequest& request);
/// The same of a probe's pixels.
double pixelAngle(const Panorama& probe);

/// Where a lobe's diameter (that of half its mass) is two texels or more, a texel is its centre's
/// value; where it is one texel or less, the mean over the footprint; in between, the mean over the
/// footprint shrunk in proportion. Points stand so close that neither the lobe nor a wave of the
/// field's highest degree falls between them.
Footprint footprintOf(const Lobe& lobe, double texel, int degree);

/// Whether texels are so large, beside the lobe's width too, that a horizon crossing them asks for
/// more points than are worth evaluating peaks at.
bool isCrossedByHorizons(const Lobe& lobe, const Footprint& of_map);

/// Footprints shrunk below this of the texel's extent are taken at points, not by their outlines:
/// of an outline's sums less would be left. Charlie's ring along the horizon needs more points, and
/// a step there (endsInStep) too.
double leastOutline(const Lobe& lobe);

/// Relative RMSE that a footprint's points leave, as measured for all layouts, 1 to 47 texels and
/// lobes with horizons and without; of a texel ten times as much.
inline constexpr double kFootprintError = 5e-7;

/// The same of a lone bright pixel in a ball map or an octahedral map whose texels are so large,
/// radians: 1.6e-5 was measured, of a mirror ball of 2 x 2.
inline constexpr double kPeakInSquareTexel = 2e-5, kFewTexels = 0.3;

/// The footprint of one texel: the map's, but for ball maps, whose texels are the longer the nearer
/// they are to the rim.
Footprint footprintOfTexel(const Footprint& of_map, Layout layout, int size, int x, int y);

/// The number of texels of the map that have a direction.
double texelCount(const PrefilterRequest& request);

/// The texels that look along the equator or at a pole: their horizons run along the edges of a
/// lat-long's pixels, and lobes with a step or a ring there have their greatest errors.
struct TexelsAlongEdges {
    std::vector<V2i> at;
    double share; ///< of the map's solid angle
};
TexelsAlongEdges texelsAlongEdges(const PrefilterRequest& request, int threads);

/// The texels of one row of a map that have a direction, and their points.
struct RowPoints {
    std::vector<int> column;         ///< of each texel
    std::vector<double> solid_angle; ///< of each texel
    std::vector<std::size_t> first;  ///< of each texel's points, and one beyond all
    std::vector<double> u;           ///< lat-long points
    std::vector<double> v;
    std::vector<V3d> direction; ///< the same as polar directions (peaks.h)
    std::vector<double> share;  ///< of each point in its texel's mean; they sum to 1
};

/// Row y of a map of that layout and extent.
RowPoints rowPoints(Layout layout, int width, int height, int y, const Footprint& footprint);

/// What of a texel belongs to it, in texels from its centre: those at the poles and at the faces'
/// edges of OpenEXR's layouts end at their centres (and are merged afterwards, mergeBorder). Not
/// for ball maps (cut_texels.h).
struct TexelPart {
    V2d low, high;
};
TexelPart ownPart(Layout layout, int width, int height, int x, int y);

/// Where along a row or a column of the image, `place` texels from its first edge, directions have
/// a kink: on the edges of the octahedral map's octahedron, X = c, Y = c and |X - c| + |Y - c| = c,
/// c the map's middle.
std::vector<double> kinksAlong(Layout layout, int width, double place);

/// Where the parts end, in order, that those of `kinks` between `from` and `to` leave of the line
/// between them, which is [0, 1]. The last one is 1.
std::vector<double> partsBetween(double from, double to, const std::vector<double>& kinks);

/// Solid angle of that part: texelSolidAngle, but for OpenEXR's lat-long, where the first and the
/// last texel of a row are one, and each counts as half of it. Any layout.
double partSolidAngle(Layout layout, int width, int height, int x, int y);

/// A map's image.
struct MapExtent {
    Layout layout;
    int width;
    int height;
    double texel; ///< texelAngle
};

/// Polar direction (peaks.h) of a place in texel (x, y), `offset` texels from its centre; beyond a
/// ball map's rim that of the rim.
V3d texelPlace(const MapExtent& map, int x, int y, V2d offset);

/// The points of one texel.
RowPoints texelPoints(const MapExtent& map, int x, int y, const Footprint& footprint);

} // namespace ibl
