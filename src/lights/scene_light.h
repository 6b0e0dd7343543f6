// A light as a renderer takes it: without what it stands for in its probe.
#pragma once

#include "lights/light.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ibl {

/// How many lights a file or a probe gives at most.
inline constexpr int kMostSceneLights = 65536;

enum class LightType : std::uint8_t { directional, point, spot };

/// A point p at the distance d of a point or spot light's position gets the irradiance
/// `strength` / d^2 on a surface that faces it; of a directional light `strength` itself.
///
/// A spot light's cone is as in KHR_lights_punctual: with c the cosine of the angle to the axis,
/// the light is multiplied by t^2, t = clamp((c - cos outer) / (cos inner - cos outer), 0, 1).
struct SceneLight {
    LightType type = LightType::directional;
    V3d direction{0, 0, 1}; ///< unit, towards a directional light; of a spot, where it shines
    V3d strength{0};        ///< RGB; irradiance (directional) or intensity (irradiance at 1 unit)
    V3d position{0};        ///< of point and spot lights
    double inner_cone = 0;  ///< half angles of a spot, radians, 0 <= inner < outer <= pi / 2
    double outer_cone = 0;

    bool operator==(const SceneLight&) const = default;
};

/// The lights of a cut.
std::vector<SceneLight> sceneLights(const LightSet& set);

/// Reads what `lights` of lightsJson's object says, and point and spot lights that someone wrote
/// beside them (testdata/lights.schema.json); nothing else of the object is read.
/// Throws Error (input) naming the light that is not one: an unknown type, a missing member, a
/// direction that is not unit, anything not finite, cones out of range; and for more than
/// kMostSceneLights.
std::vector<SceneLight> readSceneLights(std::string_view text, const std::string& name);

} // namespace ibl
