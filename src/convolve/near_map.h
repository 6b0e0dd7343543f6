// A probe convolved with a narrow kernel, at a map's texels.
//
// Weights (near_weights.h) depend on where a texel lies between the probe's pixels and on nothing
// else: turns and reflections that take pixels to pixels and texels to texels take weights to
// weights. A cube's 24 quarter faces need two between them, a lat-long map a few columns.
#pragma once

#include "convolve/near_weights.h"
#include "convolve/prefilter.h"
#include "panorama/panorama.h"

namespace ibl {

/// The mean over each texel's footprint of the kernel's convolution with a lat-long probe. What
/// has no direction is 0. Texels whose kernel is within them, about, are the means of `areas`, the
/// probe itself or what it was read from, and what the kernel moves across their outlines. Of the
/// cube family's layouts `faces` alone (nearMapOf). Progress is told a step for each of the map's
/// rows, if at all.
Image nearMap(const Panorama& probe, const Panorama& areas, const NearField& field,
              const PrefilterRequest& request, const Footprint& footprint, int threads,
              Progress* progress = nullptr);

} // namespace ibl
