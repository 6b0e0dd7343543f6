// A probe of another layout than lat-long convolved with a narrow kernel, at a map's texels.
//
// As near_map.h, but by the outlines of the probe's own texels: in a lat-long that it was read into
// edges lie elsewhere, and lobes narrower than its texels see that (faces of 200 of a night, GGX
// 0.05: 2.3e-4 off at 2048 rows, which have 35 times as many pixels).
#pragma once

#include "convolve/near_weights.h"
#include "convolve/prefilter.h"
#include "panorama/panorama.h"

namespace ibl {

/// Whether a lobe's core is to be convolved along the probe's own texels: of a probe, not a
/// lat-long, whose texels are not small beside the lobe. (Faces of 200 of a night in a lat-long of
/// 2048 rows: GGX 0.125 is within 1e-5, by the estimate, 0.1 is not.)
bool seesOwnTexels(const Panorama& probe, const Lobe& lobe);

/// nearMap of such a probe.
Image nearMapOfOwnTexels(const Panorama& probe, const NearField& field,
                         const PrefilterRequest& request, const Footprint& footprint, int threads,
                         Progress* progress = nullptr);

} // namespace ibl
