#include "lights/light_files.h"

#include "lights/lights_json.h"
#include "lights/number_text.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

using Json = nlohmann::ordered_json;

/// Text that may stand in a comment or a quoted string: no line breaks, quotes or backslashes.
std::string plain(std::string words) {
    for (char& c : words) {
        if (static_cast<unsigned char>(c) < 32 || c == '"' || c == '\\') c = '_';
    }
    return words;
}

/// The unit quaternion x, y, z, w of the shortest turn from +Z to `d`: half way between them lies
/// h = (Z + d) / |Z + d|, and q = (Z x h, Z . h). For d = -Z half a turn about Y.
std::array<double, 4> turnFromZ(const V3d& d) {
    const double length = std::sqrt(d.x * d.x + d.y * d.y + (1 + d.z) * (1 + d.z));
    if (length < 1e-12) return {0, 1, 0, 0};
    return {-d.y / length, d.x / length, 0, (1 + d.z) / length};
}

/// Irradiance as intensity times a colour in [-1, 1].
struct IntensityAndColour {
    double intensity;
    V3d colour;
};

IntensityAndColour split(const V3d& irradiance) {
    const double most =
        std::max({std::abs(irradiance.x), std::abs(irradiance.y), std::abs(irradiance.z)});
    return {most, most > 0 ? irradiance / most : V3d(1)};
}

} // namespace

std::optional<LightFormat> lightFormat(std::string_view name) {
    if (name == "json") return LightFormat::json;
    if (name == "csv") return LightFormat::csv;
    if (name == "gltf") return LightFormat::gltf;
    if (name == "usda") return LightFormat::usda;
    return std::nullopt;
}

std::string lightsCsv(const LightSet& set) {
    std::string csv = "# source: " + plain(set.source) + "\n# method: " + set.method +
                      "\n# axes: " + kLightAxes + "\n# irradiance: " + kLightUnits +
                      "\n# irradiance_error: " + shortestNumber(set.irradiance_error) +
                      "\nid,x,y,z,red,green,blue,solid_angle,share,angular_radius\n";
    const V3d total = totalIrradiance(set.lights);
    for (const Light& light : set.lights) {
        csv += std::to_string(light.id);
        for (const double value : {light.direction.x, light.direction.y, light.direction.z,
                                   light.irradiance.x, light.irradiance.y, light.irradiance.z,
                                   light.solid_angle, energyShare(light, total)}) {
            csv.append(1, ',').append(shortestNumber(value));
        }
        csv += ',';
        if (light.angular_radius) csv += shortestNumber(*light.angular_radius);
        csv += "\n";
    }
    return csv;
}

std::string lightsGltf(const LightSet& set, int& clamped) {
    clamped = 0;
    Json root;
    root["asset"] = {{"version", "2.0"},
                     {"generator", "ibltool"},
                     {"extras",
                      {{"source", set.source},
                       {"method", set.method},
                       {"units", std::string("1 lux is 1 unit of irradiance: ") + kLightUnits},
                       {"irradiance_error", set.irradiance_error}}}};
    Json lights = Json::array(), nodes = Json::array(), indices = Json::array();
    const V3d total = totalIrradiance(set.lights);
    for (std::size_t i = 0; i < set.lights.size(); ++i) {
        const Light& light = set.lights[i];
        const V3d positive(std::max(0.0, light.irradiance.x), std::max(0.0, light.irradiance.y),
                           std::max(0.0, light.irradiance.z));
        if (positive != light.irradiance) ++clamped;
        const auto [intensity, colour] = split(positive);
        const std::string name = "light_" + std::to_string(light.id);
        Json extras = {{"share", energyShare(light, total)}, {"solid_angle", light.solid_angle}};
        if (light.angular_radius) extras["angular_radius"] = *light.angular_radius;
        lights.push_back({{"type", "directional"},
                          {"name", name},
                          {"color", {colour.x, colour.y, colour.z}},
                          {"intensity", intensity},
                          {"extras", extras}});
        nodes.push_back({{"name", name},
                         {"rotation", turnFromZ(light.direction)},
                         {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
        indices.push_back(i);
    }
    // glTF has no empty arrays.
    Json scene = {{"name", "lights"}};
    if (!set.lights.empty()) {
        root["extensionsUsed"] = {"KHR_lights_punctual"};
        root["extensions"] = {{"KHR_lights_punctual", {{"lights", lights}}}};
        root["nodes"] = nodes;
        scene["nodes"] = indices;
    }
    root["scene"] = 0;
    root["scenes"] = Json::array({scene});
    return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::string lightsUsda(const LightSet& set) {
    std::string usd =
        "#usda 1.0\n(\n    defaultPrim = \"Lights\"\n    doc = \"Lights of " + plain(set.source) +
        " by ibltool, " + set.method +
        ". Intensity times colour is irradiance in the probe's units: " + kLightUnits +
        ". Relative RMSE of the irradiance over all normals: " +
        shortestNumber(set.irradiance_error) +
        ".\"\n    upAxis = \"Y\"\n)\n\ndef Xform \"Lights\"\n{\n";
    const V3d total = totalIrradiance(set.lights);
    for (const Light& light : set.lights) {
        const auto [intensity, colour] = split(light.irradiance);
        const auto q = turnFromZ(light.direction);
        const double angle = 2 * light.angular_radius.value_or(0) * 180 / kPi;
        usd += "    def DistantLight \"Light_" + std::to_string(light.id) +
               "\" (\n        customData = {\n            double share = " +
               shortestNumber(energyShare(light, total)) +
               "\n            double solidAngle = " + shortestNumber(light.solid_angle) +
               "\n        }\n    )\n    {\n";
        usd += "        float inputs:angle = " + shortestNumber(angle) + "\n";
        usd += "        color3f inputs:color = (" + shortestNumber(colour.x) + ", " +
               shortestNumber(colour.y) + ", " + shortestNumber(colour.z) + ")\n";
        usd += "        float inputs:intensity = " + shortestNumber(intensity) + "\n";
        usd += "        bool inputs:normalize = 1\n";
        usd += "        quatd xformOp:orient = (" + shortestNumber(q[3]) + ", " +
               shortestNumber(q[0]) + ", " + shortestNumber(q[1]) + ", " + shortestNumber(q[2]) +
               ")\n";
        usd += "        uniform token[] xformOpOrder = [\"xformOp:orient\"]\n    }\n";
    }
    return usd + "}\n";
}

} // namespace ibl
