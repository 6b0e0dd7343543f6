#include "lights/cut_lights.h"
#include "lights/light_files.h"
#include "lights/lights_json.h"

#include "core/error.h"
#include "unit/lights/light_probes.h"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <regex>
#include <sstream>

namespace ibl {
namespace {

LightSet someLights(int count) {
    LightRequest request;
    request.count = count;
    LightSet set = cutLights(noise(32, 16, 61), request, 1);
    set.source = "a \"quoted\"\xff name\n#";
    return set;
}

/// A set of lights along the axes, and their opposites.
LightSet axisLights() {
    LightSet set;
    set.method = "median";
    for (const V3d& d : {V3d(1, 0, 0), V3d(-1, 0, 0), V3d(0, 1, 0), V3d(0, -1, 0), V3d(0, 0, 1),
                         V3d(0, 0, -1), V3d(0.6, 0, -0.8)}) {
        Light light;
        light.direction = d;
        light.irradiance = {1, 2, 4};
        light.id = static_cast<int>(set.lights.size());
        set.lights.push_back(light);
    }
    return set;
}

/// v turned by the quaternion: v + 2 q x (q x v + w v).
V3d turned(const V3d& q, double w, const V3d& v) {
    return v + 2.0 * q.cross(q.cross(v) + w * v);
}

TEST(LightsJson, NamesUnitsAndReadsBack) {
    const LightSet set = someLights(5);
    const auto json = nlohmann::json::parse(lightsJson(set, 2));
    EXPECT_EQ(json.at("units").at("solid_angle"), "steradian");
    ASSERT_EQ(json.at("lights").size(), 5u);
    double share = 0;
    for (const auto& light : json["lights"])
        share += light.at("share").get<double>();
    EXPECT_NEAR(share, 1, 1e-12);
    const LightSet back = readLightsJson(lightsJson(set, 2), "x");
    EXPECT_EQ(back.method, set.method);
    EXPECT_EQ(back.irradiance_error, set.irradiance_error);
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(back.lights[i].direction, set.lights[i].direction);
        EXPECT_EQ(back.lights[i].irradiance, set.lights[i].irradiance);
        EXPECT_EQ(back.lights[i].solid_angle, set.lights[i].solid_angle);
        EXPECT_EQ(back.lights[i].region->longitude[0], set.lights[i].region->longitude[0]);
    }
}

TEST(LightsJson, HostileTextIsRefused) {
    const std::string whole = lightsJson(someLights(2), 2);
    for (std::size_t length = 0; length + 2 < whole.size(); length += 7)
        EXPECT_THROW(readLightsJson(whole.substr(0, length), "x"), Error) << length;
    for (const char* text : {"[]", "{\"lights\": 3}", "null", "{\"lights\": [{\"id\": 1}]}"})
        EXPECT_THROW(readLightsJson(text, "x"), Error) << text;
}

TEST(LightsGltf, MinusZOfEachNodeIsWhereTheLightShines) {
    int clamped = 0;
    const LightSet set = axisLights();
    const auto json = nlohmann::json::parse(lightsGltf(set, clamped));
    EXPECT_EQ(json.at("asset").at("version"), "2.0");
    EXPECT_EQ(json.at("extensionsUsed"), nlohmann::json({"KHR_lights_punctual"}));
    const auto& lights = json.at("extensions").at("KHR_lights_punctual").at("lights");
    ASSERT_EQ(lights.size(), set.lights.size());
    for (std::size_t i = 0; i < set.lights.size(); ++i) {
        const auto& node =
            json.at("nodes").at(json.at("scenes")[0].at("nodes")[i].get<std::size_t>());
        const auto& light = lights.at(
            node.at("extensions").at("KHR_lights_punctual").at("light").get<std::size_t>());
        EXPECT_EQ(light.at("type"), "directional");
        const auto& q = node.at("rotation");
        const V3d shines = turned({q[0], q[1], q[2]}, q[3], {0, 0, -1});
        EXPECT_LT((shines + set.lights[i].direction).length(), 1e-12) << i;
        EXPECT_EQ(light.at("intensity"), 4.0);
        EXPECT_EQ(light.at("color"), nlohmann::json({0.25, 0.5, 1.0}));
    }
    EXPECT_EQ(clamped, 0);
}

TEST(LightsGltf, NegativeColoursAreCountedAndNoLightsIsNoArray) {
    LightSet set = axisLights();
    set.lights[2].irradiance = {-1, 2, 0};
    int clamped = 0;
    const auto json = nlohmann::json::parse(lightsGltf(set, clamped));
    EXPECT_EQ(clamped, 1);
    EXPECT_EQ(json["extensions"]["KHR_lights_punctual"]["lights"][2]["color"],
              nlohmann::json({0.0, 1.0, 0.0}));
    const auto none = nlohmann::json::parse(lightsGltf({}, clamped));
    EXPECT_FALSE(none.contains("nodes"));
    EXPECT_FALSE(none.contains("extensions"));
}

TEST(LightsUsda, MinusZOfEachLightIsWhereItShines) {
    LightSet set = axisLights();
    set.lights[0].angular_radius = kPi / 360;
    set.source = "a \"b\"\\\n";
    const std::string usd = lightsUsda(set);
    EXPECT_EQ(usd.rfind("#usda 1.0\n", 0), 0u);
    EXPECT_NE(usd.find("doc = \"Lights of a _b___ by ibltool"), std::string::npos) << usd;
    EXPECT_EQ(std::count(usd.begin(), usd.end(), '{'), std::count(usd.begin(), usd.end(), '}'));
    const std::regex light(R"re(def DistantLight "Light_(\d+)"[^{]*\{[^}]*\}\s*\)\s*\{)re"
                           R"re(\s*float inputs:angle = (\S+)\n)re"
                           R"re(\s*color3f inputs:color = \(0.25, 0.5, 1\)\n)re"
                           R"re(\s*float inputs:intensity = 4\n)re"
                           R"re(\s*bool inputs:normalize = 1\n)re"
                           R"re(\s*quatd xformOp:orient = \((\S+), (\S+), (\S+), (\S+)\)\n)re"
                           R"re(\s*uniform token\[\] xformOpOrder = \["xformOp:orient"\]\n)re");
    std::size_t found = 0;
    for (std::sregex_iterator it(usd.begin(), usd.end(), light), end; it != end; ++it, ++found) {
        const auto number = [&](int group) { return std::stod((*it)[group]); };
        const V3d shines = turned({number(4), number(5), number(6)}, number(3), {0, 0, -1});
        EXPECT_LT((shines + set.lights[found].direction).length(), 1e-12);
        EXPECT_NEAR(number(2), found == 0 ? 1 : 0, 1e-12); // degrees across
    }
    EXPECT_EQ(found, set.lights.size());
}

TEST(LightsCsv, HasALineALight) {
    const LightSet set = someLights(4);
    std::istringstream csv(lightsCsv(set));
    std::string line;
    std::size_t rows = 0;
    while (std::getline(csv, line)) {
        if (line[0] == '#') continue;
        EXPECT_EQ(std::count(line.begin(), line.end(), ','), 9) << line;
        if (line.rfind("id,", 0) == 0) continue;
        double id = 0, x = 0;
        char comma = 0;
        std::istringstream(line) >> id >> comma >> x;
        EXPECT_EQ(id, static_cast<double>(rows));
        EXPECT_EQ(x, set.lights[rows].direction.x);
        ++rows;
    }
    EXPECT_EQ(rows, 4u);
}

} // namespace
} // namespace ibl
