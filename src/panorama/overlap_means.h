// A cube's texels as means over the lat-long's pixels that they overlap.
#pragma once

#include "panorama/overlap.h"
#include "panorama/resample_parts.h"

namespace ibl {

/// Sets every texel of `image`, which holds the faces in those places, to the mean over its
/// overlaps with the pixels. Sums are double, a texel's parts in a fixed order.
void overlapMeans(const CubeLatlongOverlaps& overlaps, const LatlongPixels& pixels,
                  const CubePlacement& place, Image& image, int threads);

} // namespace ibl
