// Lights that stay the same lights from frame to frame.
#pragma once

#include "lights/light.h"

#include <vector>

namespace ibl {

/// Gives `lights` the ids of those of the frame before, and the order of the ids. First lights with
/// the very same region are the same; then each light of the frame before, the brightest first,
/// takes the nearest one left within its own region's radius. The others get ids not used before.
FrameChange keepIdentity(std::vector<Light>& lights, const std::vector<Light>& previous);

} // namespace ibl
