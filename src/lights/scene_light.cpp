#include "lights/scene_light.h"

#include "core/error.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace ibl {
namespace {

using Json = nlohmann::json;

// A problem of one light, told to the user after its place in the list.
struct LightFault {
    std::string text;
};

double finiteNumber(const Json& json, const std::string& member) {
    const double value = json.is_number() ? json.get<double>() : std::nan("");
    if (!(std::abs(value) <= 1e30)) throw LightFault{member + " is not of finite numbers"};
    return value;
}

const Json& memberOf(const Json& json, const std::string& member) {
    if (!json.contains(member)) throw LightFault{"has no " + member};
    return json[member];
}

V3d triple(const Json& light, const std::string& member) {
    const Json& json = memberOf(light, member);
    if (!json.is_array() || json.size() != 3) throw LightFault{member + " is not three numbers"};
    return {finiteNumber(json[0], member), finiteNumber(json[1], member),
            finiteNumber(json[2], member)};
}

V3d unitVector(const Json& light, const std::string& member) {
    const V3d v = triple(light, member);
    if (!(std::abs(v.length() - 1) < 1e-3)) throw LightFault{member + " is not of length 1"};
    return v.normalized();
}

double degrees(const Json& light, const std::string& member) {
    return finiteNumber(memberOf(light, member), member) * kPi / 180;
}

SceneLight lightOf(const Json& json) {
    if (!json.is_object()) throw LightFault{"is not an object"};
    const std::string type = json.value("type", "directional");
    SceneLight light;
    if (type == "directional") {
        light.direction = unitVector(json, "direction");
        light.strength = triple(json, "irradiance");
        return light;
    }
    if (type != "point" && type != "spot") throw LightFault{"is of an unknown type"};
    light.type = LightType::point;
    light.position = triple(json, "position");
    light.strength = triple(json, "intensity");
    if (type == "point") return light;
    light.type = LightType::spot;
    light.direction = unitVector(json, "direction");
    light.inner_cone = json.contains("inner_cone") ? degrees(json, "inner_cone") : 0;
    light.outer_cone = degrees(json, "outer_cone");
    if (!(light.inner_cone >= 0 && light.inner_cone < light.outer_cone &&
          light.outer_cone <= kPi / 2 + 1e-9)) {
        throw LightFault{"cones are not 0 <= inner_cone < outer_cone <= 90"};
    }
    return light;
}

} // namespace

std::vector<SceneLight> sceneLights(const LightSet& set) {
    std::vector<SceneLight> lights;
    for (const Light& light : set.lights)
        lights.push_back({LightType::directional, light.direction, light.irradiance, V3d(0), 0, 0});
    return lights;
}

std::vector<SceneLight> readSceneLights(std::string_view text, const std::string& name) {
    const Json root = Json::parse(text, nullptr, false);
    if (!root.is_object() || !root.contains("lights") || !root["lights"].is_array()) {
        throw inputError(name, "is no JSON of lights; give what ibltool lights writes");
    }
    const Json& list = root["lights"];
    if (list.size() > static_cast<std::size_t>(kMostSceneLights)) {
        throw inputError(name, "has more than " + std::to_string(kMostSceneLights) +
                                   " lights; cut the probe into fewer");
    }
    std::vector<SceneLight> lights;
    for (const Json& json : list) {
        try {
            lights.push_back(lightOf(json));
        } catch (const LightFault& fault) {
            throw inputError(name, "light " + std::to_string(lights.size()) + ": " + fault.text +
                                       "; correct it as ibltool-lights(1) says");
        } catch (const Json::exception&) {
            throw inputError(name, "light " + std::to_string(lights.size()) +
                                       ": its type is not text; correct it as ibltool-lights(1) "
                                       "says");
        }
    }
    return lights;
}

} // namespace ibl
