// The radiance a probe holds in a direction.
#pragma once

#include "panorama/conventions.h"
#include "panorama/panorama.h"

namespace ibl {

/// Radiance from `direction` (any length but 0), bilinear between pixel centres, across the seam,
/// the poles and the edges and corners of the cube. Constant probes give their constant.
V3d radianceAt(const Panorama& panorama, const V3d& direction);

} // namespace ibl
