// The lights as JSON, units and axes named.
#pragma once

#include "lights/light.h"

#include <string>
#include <string_view>

namespace ibl {

/// What every format says of axes and units.
inline constexpr const char* kLightAxes =
    "right-handed, +Y up; a lat-long's centre looks along +Z, +X stands at a quarter of its width; "
    "longitude = atan2(x, z), latitude = asin(y)";
inline constexpr const char* kLightUnits = "radiance of the source times steradian";

/// One JSON object, indented, ending in a newline; testdata/lights.schema.json and
/// ibltool-lights(1) say what is in it. Numbers are the shortest that read back as the same double.
std::string lightsJson(const LightSet& set, int threads);

/// What lightsJson wrote, but for `change`. `name` is for messages.
/// Throws Error (input) when the text is not such an object.
LightSet readLightsJson(std::string_view text, const std::string& name);

} // namespace ibl
