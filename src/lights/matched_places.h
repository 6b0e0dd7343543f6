// Lights moved a little, so that together they light as the probe does.
#pragma once

#include "lights/light.h"
#include "lights/light_harmonics.h"

#include <vector>

namespace ibl {

/// Irradiance is nearly all in the harmonics of degree 0, 1, 2 and 4 (irradiance_error.h). Points
/// at their regions' centroids have too much of all but the first: a region that becomes a point
/// gathers its light, so the coefficients of degree l grow by about l (l + 1) / 4 times its squared
/// radius, in all regions alike. A cloud of points is spread again by moving the points apart.
///
/// Moves `lights` from where they stand (centroids) such that those harmonics come near the
/// probe's, by the least movement in units of Light::radius, and always less than half of it: a
/// sun's light stays on the sun. Colours are kept. Places follow the probe without steps. `probe`
/// has degree 4 or more.
void matchPlaces(std::vector<Light>& lights, const LightHarmonics& probe, int threads);

} // namespace ibl
