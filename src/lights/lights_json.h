// The lights as JSON, units and axes named.
#pragma once

#include "lights/median_cut.h"

#include <string>
#include <vector>

namespace ibl {

/// One JSON object, indented, ending in a newline: `axes`, `units`, `source`, `method`,
/// `total_irradiance` and `lights`, brightest first, each with `direction` (unit, towards the
/// light), `irradiance` ([r, g, b]), `solid_angle` and `region` (`longitude` and `latitude`, each
/// [from, to]). Numbers are the shortest that read back as the same double.
std::string lightsJson(const std::vector<Light>& lights, const std::string& source,
                       const std::string& method);

} // namespace ibl
