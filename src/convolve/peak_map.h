// Peaks in maps of few large texels.
//
// A wide lobe's horizon is a kink that crosses such texels: at 16 x 16 points in each a lone sun
// under GGX of roughness 1 was off by 3e-4 of a cube of one texel a face, under Charlie of 0.3 by
// 5e-2 of a lat-long of two texels, and every point is an evaluation a peak. By the outlines of
// texel and pixel (near_weights.h) it is 1e-7 in the time of 600 evaluations.
#pragma once

#include "convolve/peaks.h"
#include "convolve/prefilter.h"
#include "convolve/texels.h"

#include <vector>

namespace ibl {

/// For maps of which isCrossedByHorizons: the mean over each texel's footprint of what the lobe
/// gathers of the peaks' excess, divided by `scale`. The probe is `width` x `height`.
Image peakMap(const std::vector<Peak>& peaks, double scale, int width, int height,
              const PrefilterRequest& request, const Footprint& footprint, int threads);

/// Relative RMSE that it leaves: that of the most exact rules. A lone peak in a large texel needs
/// them; what others leave of a mean of many pixels is 1e-4 of it.
inline constexpr double kPeakMapError = 1e-6;

} // namespace ibl
