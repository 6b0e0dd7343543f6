// The lights as CSV, glTF and USD.
#pragma once

#include "lights/light.h"

#include <optional>
#include <string>
#include <string_view>

namespace ibl {

enum class LightFormat { json, csv, gltf, usda };

/// By name, or by a file name's extension without its dot; none for others.
std::optional<LightFormat> lightFormat(std::string_view name);

/// A line a light after comment lines that name source, axes, units and error, and a header line.
std::string lightsCsv(const LightSet& set);

/// glTF 2.0 with KHR_lights_punctual: a directional light and a node each. glTF's directional
/// lights shine along their node's -Z, so +Z is turned to the light's direction. One unit of the
/// probe's radiance times steradian is written as 1 lux; `intensity` is the largest channel and
/// `color` the irradiance over it. A light can not be negative there: such channels become 0, and
/// `clamped` counts their lights.
std::string lightsGltf(const LightSet& set, int& clamped);

/// USD as text: a UsdLux DistantLight each, which shines along its -Z. With inputs:normalize 1 the
/// intensity times the colour is the irradiance on a surface that faces the light, in the probe's
/// units, whatever inputs:angle is (the lamp's diameter, 0 for regions of a cut).
std::string lightsUsda(const LightSet& set);

} // namespace ibl
