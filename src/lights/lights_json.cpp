#include "lights/lights_json.h"

#include <nlohmann/json.hpp>

namespace ibl {
namespace {

using Json = nlohmann::ordered_json;

Json jsonOf(const V3d& v) {
    return Json::array({v.x, v.y, v.z});
}

} // namespace

std::string lightsJson(const std::vector<Light>& lights, const std::string& source,
                       const std::string& method) {
    Json root;
    root["axes"] =
        "right-handed, +Y up; a lat-long's centre looks along +Z, +X stands at a quarter "
        "of its width; longitude = atan2(x, z), latitude = asin(y)";
    root["units"] = {{"direction", "unit vector towards the light"},
                     {"irradiance", "radiance of the source times steradian"},
                     {"solid_angle", "steradian"},
                     {"region", "degrees, from and to"}};
    root["source"] = source;
    root["method"] = method;
    root["total_irradiance"] = jsonOf(totalIrradiance(lights));
    Json& list = root["lights"] = Json::array();
    for (const Light& light : lights) {
        list.push_back({{"direction", jsonOf(light.direction)},
                        {"irradiance", jsonOf(light.irradiance)},
                        {"solid_angle", light.solid_angle},
                        {"region",
                         {{"longitude", {light.longitude[0], light.longitude[1]}},
                          {"latitude", {light.latitude[0], light.latitude[1]}}}}});
    }
    // A source may be a file name in any encoding: what is not UTF-8 is replaced.
    return root.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

} // namespace ibl
