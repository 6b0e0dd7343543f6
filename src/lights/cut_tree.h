// A probe cut into rectangles, one cut after the other.
//
// Two ways to choose the cuts:
//   median    Debevec 2005, "A median cut algorithm for light probe sampling"
//   variance  Viriyothai and Debevec 2009, "Variance minimization light probe sampling"
#pragma once

#include "image/image.h"
#include "lights/light.h"
#include "lights/moment_table.h"
#include "lights/summed_area.h"

#include <cstddef>
#include <vector>

namespace ibl {

/// Node 0 is the whole sphere. Cut k divides node `cut[k]` into the nodes 2k + 1 and 2k + 2. The
/// first k cuts of a tree are those of a smaller one, so that fewer lights are a prefix.
struct CutTree {
    std::vector<PixelRegion> nodes;
    std::vector<int> cut;
};

/// The nodes that the first `cuts` cuts leave undivided; they tile the sphere. In node order.
std::vector<int> leavesOf(const CutTree& tree, std::size_t cuts);

/// Cuts until `count` regions have energy, or none with energy has more than one pixel. The sphere
/// is opened at the meridian of least energy, so that no source is cut by the image's border. In
/// each round every region with energy is cut, the heaviest first, across its longer side
/// (longitude scaled by the cosine of latitude of the region's longest lit parallel) where the
/// energy on both sides is most nearly equal. The last round ends when the count is reached.
CutTree medianCut(const SummedAreaTable& table, int count, int threads);

/// The same, but a cut is along either side, so that the larger variance of the two parts is least:
/// the variance of a region is the luminance-weighted sum of squared distances, on the unit sphere,
/// from its centroid. The region cut next is that of the greatest energy times radius, the root of
/// energy times variance: by measurement better than the greatest variance.
CutTree varianceCut(const MomentTable& table, int count);

/// What a region holds; adds up over regions.
struct RegionSums {
    V3d irradiance{0};      ///< RGB radiance times solid angle
    V3d moment{0};          ///< integral of direction times luminance (negative ones as 0)
    double energy = 0;      ///< integral of that luminance
    double solid_angle = 0; ///< steradians

    RegionSums& operator+=(const RegionSums& other);
};

/// Sums over each region of `latlong` (three channels, finite), exact but for double rounding.
std::vector<RegionSums> regionSums(const Image& latlong, const std::vector<PixelRegion>& regions,
                                   int threads);

/// The middle of a region's rectangle is where Debevec 2005 has its light; `matched` begins at the
/// energy's centroid (matched_places.h).
enum class LightPlacement { centroid, centre, matched };

/// The light of a region of a width x height lat-long, at its centroid or centre.
Light lightOf(const RegionSums& sums, const PixelRegion& region, int width, int height,
              LightPlacement placement);

/// A light for each region that has energy (`is_lit`). What colour a region without luminance has
/// all the same (negative pixels, radiance below the table's resolution) goes to the nearest light,
/// so that the lights add up to the probe. From brightest to dimmest, ids in that order.
std::vector<Light> lightsOf(const std::vector<RegionSums>& sums,
                            const std::vector<PixelRegion>& regions,
                            const std::vector<bool>& is_lit, int width, int height,
                            LightPlacement placement);

/// The rectangle's longitudes and latitudes.
AngularRegion angularRegion(const PixelRegion& region, int width, int height);

/// The pixels whose centres lie in the rectangle; what `angularRegion` gave comes back.
PixelRegion pixelRegion(const AngularRegion& region, int width, int height);

} // namespace ibl
