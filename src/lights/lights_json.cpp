#include "lights/lights_json.h"

#include "core/error.h"
#include "core/parallel.h"
#include "lights/number_text.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <initializer_list>
#include <vector>

namespace ibl {
namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const V3d& v) {
    return Json::array({v.x, v.y, v.z});
}

/// Numbers in brackets, each the shortest text that reads back as the same double.
void append(std::string& text, std::initializer_list<double> values) {
    const char* separator = "[";
    for (const double value : values) {
        text += separator;
        appendNumber(text, value);
        separator = ", ";
    }
    text += ']';
}

/// One line. Put together by hand: a tree of JSON values costs more than the cuts.
void append(std::string& text, const Light& light, const V3d& total) {
    text += "    {\"id\": " + std::to_string(light.id) + ", \"direction\": ";
    append(text, {light.direction.x, light.direction.y, light.direction.z});
    text += ", \"irradiance\": ";
    append(text, {light.irradiance.x, light.irradiance.y, light.irradiance.z});
    const auto appendMember = [&](const char* before, double value) {
        text += before;
        appendNumber(text, value);
    };
    appendMember(", \"solid_angle\": ", light.solid_angle);
    appendMember(", \"share\": ", energyShare(light, total));
    if (light.angular_radius) appendMember(", \"angular_radius\": ", *light.angular_radius);
    if (light.region) {
        const AngularRegion& region = *light.region;
        text += ", \"region\": {\"longitude\": ";
        append(text, {region.longitude[0], region.longitude[1]});
        text += ", \"latitude\": ";
        append(text, {region.latitude[0], region.latitude[1]});
        text += '}';
    }
    text += '}';
}

V3d vectorOf(const Json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Light lightOf(const Json& json) {
    Light light;
    light.id = json.at("id").get<int>();
    light.direction = vectorOf(json.at("direction"));
    light.irradiance = vectorOf(json.at("irradiance"));
    light.solid_angle = json.at("solid_angle").get<double>();
    if (json.contains("angular_radius"))
        light.angular_radius = json["angular_radius"].get<double>();
    if (json.contains("region")) {
        AngularRegion region;
        for (std::size_t i = 0; i < 2; ++i) {
            region.longitude[i] = json["region"].at("longitude").at(i).get<double>();
            region.latitude[i] = json["region"].at("latitude").at(i).get<double>();
            if (!(std::abs(region.longitude[i]) <= 540 && std::abs(region.latitude[i]) <= 90))
                throw std::out_of_range("region");
        }
        light.region = region;
    }
    if (!(std::abs(light.direction.length() - 1) < 1e-3)) throw std::out_of_range("direction");
    return light;
}

} // namespace

std::string lightsJson(const LightSet& set, int threads) {
    Json root;
    root["axes"] = kLightAxes;
    root["units"] = {{"direction", "unit vector towards the light"},
                     {"irradiance", kLightUnits},
                     {"solid_angle", "steradian"},
                     {"share", "of the luminance of all lights, 0.2125 R + 0.7154 G + 0.0721 B"},
                     {"angular_radius", "radian"},
                     {"region", "degrees, from and to"},
                     {"irradiance_error", "relative RMSE over all normals and channels"}};
    root["source"] = set.source;
    root["method"] = set.method;
    const V3d total = totalIrradiance(set.lights);
    root["total_irradiance"] = jsonOf(total);
    root["irradiance_error"] = set.irradiance_error;
    if (set.change) {
        root["change"] = {{"light_change", set.change->light_change},
                          {"movement", set.change->movement},
                          {"kept", set.change->kept},
                          {"same_regions", set.change->same_regions}};
    }
    // A source may be a file name in any encoding: what is not UTF-8 is replaced.
    std::string text = root.dump(2, ' ', false, Json::error_handler_t::replace);
    text.erase(text.rfind("\n}"));
    text += ",\n  \"lights\": [";
    constexpr std::size_t kRun = 128;
    std::vector<std::string> runs((set.lights.size() + kRun - 1) / kRun);
    parallelForRuns(set.lights.size(), kRun, threads, [&](std::size_t begin, std::size_t end) {
        runs[begin / kRun].reserve(512 * (end - begin));
        for (std::size_t i = begin; i < end; ++i) {
            runs[begin / kRun] += i == 0 ? "\n" : ",\n";
            append(runs[begin / kRun], set.lights[i], total);
        }
    });
    std::size_t size = text.size() + 16;
    for (const std::string& run : runs)
        size += run.size();
    text.reserve(size);
    for (const std::string& run : runs)
        text += run;
    return text += set.lights.empty() ? "]\n}\n" : "\n  ]\n}\n";
}

LightSet readLightsJson(std::string_view text, const std::string& name) {
    LightSet set;
    try {
        const Json root = Json::parse(text);
        set.source = root.at("source").get<std::string>();
        set.method = root.at("method").get<std::string>();
        set.irradiance_error = root.at("irradiance_error").get<double>();
        for (const Json& light : root.at("lights"))
            set.lights.push_back(lightOf(light));
    } catch (const std::exception&) {
        throw inputError(name, "is no JSON of ibltool lights; give one that it wrote");
    }
    return set;
}

} // namespace ibl
