// The fewest lights that keep an error.
#pragma once

#include "lights/cut_lights.h"

namespace ibl {

/// As cutLights() with a LightRequest::max_error; method and change of the result are not set.
LightSet fewestLights(const Image& latlong, const LightRequest& request, int threads);

} // namespace ibl
