#include "cli/render_options.h"

#include "core/error.h"
#include "image/source.h"
#include "lights/cut_lights.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <charconv>

namespace ibl {
namespace {

Error usage(const std::string& what) {
    return {ExitCode::usage, what};
}

std::vector<SceneLight> cutOf(Session& session, const LightArguments& arguments,
                              const Panorama& probe) {
    LightRequest request;
    request.method = arguments.method.value_or(LightMethod::median);
    request.count = std::stoi(arguments.lights);
    const Image latlong = latlongOf(Panorama(probe), session.threads());
    const LightSet set =
        session.stage("lights", [&] { return cutLights(latlong, request, session.threads()); });
    if (set.lights.empty()) {
        throw inputError("--lights", "the probe has no luminance above 0, so no lights; "
                                     "leave out --lights or name a file of lights");
    }
    session.results()["irradiance_error"] = set.irradiance_error;
    return sceneLights(set);
}

/// Numbers that no file is likely to be named by, such as -3 and 2.5.
bool isNumber(const std::string& text) {
    double value = 0;
    const char* end = text.data() + text.size();
    const auto [last, problem] = std::from_chars(text.data(), end, value);
    return problem == std::errc() && last == end;
}

Error notACount(const std::string& text) {
    return usage("--lights " + text + ": a probe gives 1 to " + std::to_string(kMostLights) +
                 " lights; give a number of these, or a file");
}

} // namespace

bool isLightCount(const std::string& text) {
    return !text.empty() && std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
}

void requireLightUse(const LightArguments& arguments, const Material& material,
                     const PictureArguments& picture) {
    const bool lit = !material.own && shaderInfo(material.shader).lit;
    const std::string shader =
        material.own ? material.own->name : std::string(shaderInfo(material.shader).name);
    if (arguments.lights.empty()) {
        if (arguments.method || arguments.shadow_size) {
            throw usage(std::string(arguments.method ? "--light-method" : "--shadow-size") +
                        " is of --lights; give them, or leave it out");
        }
        if (lit) throw usage("--shader " + shader + " is lit by lights; give --lights N or a file");
        if (arguments.ground) throw usage("--ground is lit by lights; give --lights N or a file");
        return;
    }
    if (!lit && !arguments.ground) {
        throw usage("--lights: --shader " + shader +
                    " is not lit by lights; choose one that is, "
                    "add --ground, or leave --lights out");
    }
    if (arguments.ground_albedo && picture.background == "none") {
        throw usage("--ground-albedo: without a background the shadow is alpha, whatever the "
                    "albedo; leave it out");
    }
    if (!isLightCount(arguments.lights)) {
        if (isNumber(arguments.lights)) throw notACount(arguments.lights);
        if (arguments.method)
            throw usage("--light-method: a file's lights are cut already; leave it out");
        return;
    }
    if (arguments.lights.size() > 5 || std::stoi(arguments.lights) < 1 ||
        std::stoi(arguments.lights) > kMostLights) {
        throw notACount(arguments.lights);
    }
}

std::vector<SceneLight> lightsOf(Session& session, const LightArguments& arguments,
                                 const std::string& name, const Panorama& probe) {
    if (isLightCount(name)) return cutOf(session, arguments, probe);
    Source source = openSource(name);
    readWhole(source);
    session.addInput(name);
    std::vector<SceneLight> lights = readSceneLights(
        {reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size()}, name);
    if (lights.empty()) throw inputError(name, "holds no lights; give some");
    return lights;
}

std::optional<Ground> groundOf(const LightArguments& arguments, const Scene& scene) {
    if (!arguments.ground) return std::nullopt;
    const double height = arguments.ground_height ? *arguments.ground_height
                                                  : lowestPoint(scene.object, scene.placement);
    return Ground{height, arguments.ground_albedo};
}

void reportLights(Session& session, const LightCounts& counts) {
    session.results()["lights"] = {{"given", counts.given},
                                   {"drawn", counts.drawn},
                                   {"black", counts.black},
                                   {"unseen", counts.unseen}};
    session.detail("lights: " + std::to_string(counts.drawn) + " drawn of " +
                   std::to_string(counts.given));
}

void bindLightOptions(CLI::App& app, LightArguments& arguments) {
    app.add_option("--lights", arguments.lights,
                   "Lights of lit materials and the ground: N cut from the probe, or a JSON file "
                   "as ibltool lights writes")
        ->type_name("N|FILE")
        ->group("Lights");
    app.add_option_function<std::string>(
           "--light-method",
           [&arguments](const std::string& name) { arguments.method = methodFromName(name); },
           "How N lights are cut: median (default) or variance")
        ->check(CLI::IsMember({"median", "variance"}))
        ->type_name("NAME")
        ->group("Lights");
    app.add_option("--shadow-size", arguments.shadow_size,
                   "Texels a side of each light's shadow map, 16 to 8192 (default by the "
                   "picture's height, 256 to 2048)")
        ->check(inRange(16, 8192))
        ->type_name("N")
        ->group("Lights");
    CLI::Option* ground =
        app.add_flag("--ground", arguments.ground,
                     "A plane below the object that shows its shadow and nothing else")
            ->group("Lights");
    app.add_option("--ground-height", arguments.ground_height,
                   "Its y (default the object's lowest point)")
        ->needs(ground)
        ->check(inRange(-1e6, 1e6))
        ->type_name("Y")
        ->group("Lights");
    app.add_option_function<std::vector<double>>(
           "--ground-albedo",
           [&arguments](const std::vector<double>& v) {
               arguments.ground_albedo = V3d(v[0], v[1], v[2]);
           },
           "Its albedo (default: whatever makes it look as the background does)")
        ->delimiter(',')
        ->expected(3)
        ->check(inRange(0.0, 1.0))
        ->needs(ground)
        ->type_name("R,G,B")
        ->group("Lights");
    app.add_option("--plate", arguments.plate,
                   "Photograph to show instead of the background; the picture takes its size")
        ->needs(ground)
        ->excludes("--background")
        ->type_name("FILE")
        ->group("Lights");
}

} // namespace ibl
