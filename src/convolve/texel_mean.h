// The mean over a texel of a lobe's mass over a pixel, however narrow the lobe.
//
// Points in the texel would have to stand as close as the lobe is wide. But the mean over texel T
// of the lobe about each of its points, integrated over pixel P, is as well a mean over
// displacements:
//
//     1/|T| int_T int_P K = int a(t) dM(t),   a(t) = mean over directions of |T n (P + t)| / |T|,
//
// M the lobe's mass within the angle t. The overlap a(t) knows nothing of the lobe and varies over
// the texel and the pixel alone, so a few displacements do; M is known in closed form. Both are
// taken in the plane that touches the sphere at the pixel's centre, where great circles are
// straight.
#pragma once

#include "convolve/lobe.h"
#include "convolve/peaks.h"

#include <array>

namespace ibl {

/// The mean over the texel of the lobe's normalised mass over the pixel. The texel's corners are
/// polar directions (peaks.h) in order around, less than about a radian from the pixel; its edges
/// are taken as great circles.
double texelMean(const LobeMassBeyond& mass_beyond, const std::array<V3d, 4>& texel,
                 const Rectangle& pixel);

} // namespace ibl
