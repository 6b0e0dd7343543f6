// Directional lights from a probe by median cut.
#pragma once

#include "image/image.h"
#include "lights/summed_area.h"
#include "panorama/conventions.h"

#include <vector>

namespace ibl {

/// One light: all the radiance of a rectangle of directions, gathered into one direction.
struct Light {
    V3d direction;          ///< unit, from the object towards the light
    V3d irradiance;         ///< RGB: radiance times solid angle summed over the region, i.e. the
                            ///< irradiance on a surface that faces the light
    double solid_angle = 0; ///< of the region, steradians
    double longitude[2]{};  ///< of the region: atan2(x, z), degrees, ascending, in [-180, 540)
    double latitude[2]{};   ///< of the region: asin(y), degrees, ascending
};

/// Median cut (Debevec 2005, "A median cut algorithm for light probe sampling").
///
/// `latlong` has three channels and finite pixels. The sphere is one region at first, opened at the
/// meridian of least energy so that no source is cut by the image's border. In each round every
/// region is cut across its longer side (longitude scaled by the cosine of the region's middle
/// latitude) where the energy on both sides is most nearly equal. Past the last power of two below
/// `count` only the regions of most energy are cut, the heaviest first. Regions without energy are
/// no lights and do not count. The light stands at the region's energy centroid.
///
/// Returns at most `count` lights, from brightest to dimmest; fewer when there are fewer pixels
/// with energy, none for a black probe. Radiance is constant over a pixel's rectangle. The
/// irradiances add up to the probe's integral in each channel (negative pixels included).
std::vector<Light> medianCut(const Image& latlong, int count, int threads);

/// The regions alone, those without energy too, in the order in which the cuts made them; they tile
/// the sphere. At most `count` of them have energy.
std::vector<PixelRegion> medianCutRegions(const SummedAreaTable& table, int count);

/// The probe's integral over all directions in each channel: radiance times solid angle.
V3d totalIrradiance(const std::vector<Light>& lights);

} // namespace ibl
