// From one layout or size to another, by area where it shrinks and by interpolation where it grows.
#pragma once

#include "panorama/panorama.h"

namespace ibl {

/// What a probe is between its pixels' centres where the new texels are smaller than its pixels.
enum class Enlarging {
    interpolate,
    hold, ///< constant over each pixel, as where it shrinks: energy is kept at any size
};

/// The probe in another layout, of face edge, lat-long height or edge of a square map `size`
/// >= 1.
///
/// Where the new texels are larger than the source's pixels, each is the exact mean of the source
/// over its solid angle (pixels are areas of constant radiance), so energy is kept to float
/// rounding. Where they are smaller, the source is interpolated between pixel centres
/// (`radianceAt`), unless it is to hold. Between the two, for texel pitches of 0.8 to 1 pixels,
/// there is a smooth blend. The same extent of the same layout, or the same face edge within the
/// cube family, gives the same bits. A constant probe stays constant and a non-negative one
/// non-negative. Cells of a cross outside its faces and
/// texels of a ball map outside its disc are 0. To and from square maps (square_maps.h) means are
/// by polygons whose corners are 1e-3 pixels from the sides that they follow, and that have their
/// area (chart.h).
///
/// `threads` 0: as many as the machine has; the result does not depend on it.
/// Throws Error (usage) when size < 1 or the image would have more than 65536 pixels an edge or
/// 2^30 in all.
Panorama resample(const Panorama& source, Layout to, int size, int threads = 0,
                  Enlarging enlarging = Enlarging::interpolate);

/// Gives the texels of an exr layout that look in one direction (its seam, poles, edges of faces)
/// one value, their mean; they cover equal areas, so that energy stays. Other layouts have none.
void mergeBorder(Panorama& panorama);

} // namespace ibl
