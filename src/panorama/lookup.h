// The radiance a probe holds in a direction.
#pragma once

#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/panorama.h"

#include <array>

namespace ibl {

/// Radiance from `direction` (any length but 0), bilinear between pixel centres: across the seam of
/// a lat-long, towards the mean of the first or last row at its poles (one value, from wherever the
/// pole is approached), across the edges of a cube, and with the mean of the three texels that meet
/// for the missing fourth at its corners, as OpenGL's seamless filtering does; across
/// the edges of an octahedral map and the rim of a ball map. Constant probes give
/// their constant.
V3d radianceAt(const Panorama& panorama, const V3d& direction);

/// A probe made ready for many lookups. Refers to the panorama, which must outlive it.
struct Sampler {
    const Panorama* panorama = nullptr;
    int edge = 0;                         ///< of cubes
    std::array<FacePlacement, 6> faces{}; ///< of cubes
    V3d north{0, 0, 0};                   ///< value at the poles of lat-longs
    V3d south{0, 0, 0};
};
Sampler makeSampler(const Panorama& panorama);

/// As `radianceAt`. Lat-longs are averaged along the parallel over `width` radians of arc less one
/// column (so not at all where columns are wider than that): their columns crowd towards the poles,
/// where single lookups would skip over most of them.
V3d radianceAt(const Sampler& sampler, const V3d& direction, double width = 0);

} // namespace ibl
