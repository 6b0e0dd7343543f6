#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/session.h"

#include "core/error.h"
#include "image/png.h"
#include "image/source.h"
#include "lights/cut_lights.h"
#include "lights/lamp.h"
#include "lights/light_files.h"
#include "lights/lights_json.h"
#include "lights/preview.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>

namespace ibl {
namespace {

struct LightsOptions {
    CommonOptions common;
    ProbeOptions probe;
    std::optional<int> count;
    std::optional<double> max_error;
    std::optional<LightMethod> method;
    std::optional<LightPlacement> placement;
    bool sun = false;
    std::string residual;
    std::string previous;
    std::string output = "-";
    std::string format;
    std::string preview;
};

LightFormat formatOf(const LightsOptions& options) {
    if (!options.format.empty()) return *lightFormat(options.format);
    if (options.output == "-") return LightFormat::json;
    std::string extension = std::filesystem::path(options.output).extension().string();
    if (!extension.empty()) extension.erase(0, 1);
    if (const auto format = lightFormat(extension)) return *format;
    throw Error(ExitCode::usage, options.output + ": the extension says no format of lights; end "
                                                  "it in .json, .csv, .gltf or .usda, or say "
                                                  "--format");
}

void checkOptions(const LightsOptions& options) {
    const auto refuse = [](const std::string& what) { throw Error(ExitCode::usage, what); };
    if (!options.residual.empty() && !options.sun)
        refuse("--residual: without --sun nothing is taken out; add --sun");
    if (options.residual == "-") refuse("--residual: does not go to standard output; name a file");
    const bool samples = options.method == LightMethod::importance;
    if (samples && options.max_error)
        refuse("--max-error: importance does not search for a count; use median or variance");
    if (samples && options.placement)
        refuse("--place: importance places each light itself; leave it out");
    if (options.placement == LightPlacement::matched && options.max_error)
        refuse("--max-error: searches with lights at centroids or centres; leave out --place "
               "matched, or say --count");
    if (!options.preview.empty() && std::filesystem::path(options.preview).extension() != ".png")
        refuse("--preview: " + options.preview + ": is written as PNG; end it in .png");
}

LightSet readPrevious(Session& session, const LightsOptions& options, std::string_view method) {
    const std::string& name = options.previous;
    Source source = openSource(name);
    readWhole(source);
    session.addInput(name);
    LightSet previous = readLightsJson(
        {reinterpret_cast<const char*>(source.bytes.data()), source.bytes.size()}, name);
    if (previous.method != method) {
        throw inputError(name, "was made by --method " + previous.method + ", not " +
                                   std::string(method) + "; use the same for all frames");
    }
    return previous;
}

/// Pixels that have what the method cuts by.
std::size_t litPixels(const Image& latlong, LightMethod method) {
    std::size_t count = 0;
    for (std::size_t k = 0; k < latlong.pixels.size(); k += 3) {
        const float* rgb = &latlong.pixels[k];
        const double luminance = luminanceOf({rgb[0], rgb[1], rgb[2]});
        if (luminance > 0 || (luminance < 0 && method == LightMethod::variance)) ++count;
    }
    return count;
}

LightSet cut(Session& session, const LightsOptions& options, const Image& latlong) {
    LightRequest request;
    request.method = options.method.value_or(LightMethod::median);
    request.count = options.count.value_or(request.count);
    request.max_error = options.max_error;
    request.progress = session.progress("cut");
    request.placement = options.placement.value_or(LightPlacement::centroid);
    LightSet previous;
    if (!options.previous.empty()) {
        previous = readPrevious(session, options, methodName(request.method));
        request.previous = &previous;
        if (!options.count && !previous.lights.empty())
            request.count = std::min(kMostLights, static_cast<int>(previous.lights.size()));
    }
    LightSet set =
        session.stage("cut", [&] { return cutLights(latlong, request, session.threads()); });
    const std::string& source = options.probe.input;
    if (set.lights.empty()) {
        const bool black = std::ranges::all_of(latlong.pixels, [](float v) { return v == 0; });
        session.note(source, black ? "black: no lights" : "no luminance above 0: no lights");
    } else if (!options.max_error && static_cast<int>(set.lights.size()) < request.count) {
        session.note(source, "only " + std::to_string(set.lights.size()) + " of " +
                                 std::to_string(request.count) + " lights: " +
                                 (litPixels(latlong, request.method) > set.lights.size()
                                      ? "each other pixel has less than 2e-19 of the energy"
                                      : "no more pixels have energy"));
    }
    return set;
}

LightSet takeOutSun(Session& session, const LightsOptions& options, const Image& latlong) {
    Lamp lamp = session.stage("sun", [&] { return findLamp(latlong, options.probe.input); });
    LightSet set;
    set.lights.push_back(lamp.light);
    set.method = "sun";
    set.irradiance_error = session.stage(
        "error", [&] { return lampError(latlong, lamp.residual, lamp.light, session.threads()); });
    if (!options.residual.empty()) {
        WriteOptions how;
        how.threads = session.threads();
        session.stage("write", [&] {
            session.write(options.residual, Panorama{Layout::latlong, std::move(lamp.residual)},
                          how);
        });
    }
    return set;
}

void writeLights(Session& session, const LightsOptions& options, LightFormat format,
                 const LightSet& set) {
    int clamped = 0;
    std::string text;
    switch (format) {
    case LightFormat::json:
        text = lightsJson(set, session.threads());
        break;
    case LightFormat::csv:
        text = lightsCsv(set);
        break;
    case LightFormat::gltf:
        text = lightsGltf(set, clamped);
        break;
    case LightFormat::usda:
        text = lightsUsda(set);
        break;
    }
    if (clamped > 0) {
        session.note(options.output, "negative colours of " + std::to_string(clamped) +
                                         (clamped == 1 ? " light" : " lights") +
                                         " written as 0: glTF has none");
    }
    session.writeText(options.output, text);
}

void runLights(const LightsOptions& options) {
    checkOptions(options);
    const LightFormat format = formatOf(options);
    Session session("lights", options.common);
    const Image latlong = latlongOf(session.readProbe(options.probe), session.threads());
    LightSet set =
        options.sun ? takeOutSun(session, options, latlong) : cut(session, options, latlong);
    set.source = options.probe.input;
    session.results()["lights"] = set.lights.size();
    session.results()["irradiance_error"] = set.irradiance_error;
    session.stage("write", [&] { writeLights(session, options, format, set); });
    if (!options.preview.empty()) {
        session.stage("preview", [&] {
            const Preview picture = drawPreview(latlong, set.lights);
            Image codes(picture.width, picture.height);
            std::ranges::transform(picture.bytes, codes.pixels.begin(),
                                   [](std::uint8_t byte) { return byte / 255.0f; });
            writePng(session.outputs().add(options.preview), codes,
                     {.bits = 8, .dither = false, .encoded = true}, session.threads());
            session.addOutput(options.preview);
        });
    }
    session.finish();
}

void bindCuts(CLI::App& app, LightsOptions& options) {
    CLI::Option* count =
        app.add_option("-n,--count", options.count,
                       "How many lights, 1 to 65536 (default 64, or as many as --previous has)")
            ->check(inRange(1, kMostLights))
            ->type_name("N");
    CLI::Option* error =
        app.add_option("--max-error", options.max_error,
                       "The fewest lights whose irradiance has at most this relative RMSE")
            ->check(inRange(1e-6, 1.0))
            ->excludes(count)
            ->type_name("E");
    CLI::Option* method =
        app.add_option_function<std::string>(
               "--method",
               [&options](const std::string& name) { options.method = methodFromName(name); },
               "How lights are found (default median). median: Debevec 2005; variance: Viriyothai "
               "and Debevec 2009; importance: a low-discrepancy set")
            ->check(CLI::IsMember({"median", "variance", "importance"}))
            ->type_name("NAME");
    CLI::Option* place = app.add_option_function<std::string>(
                                "--place",
                                [&options](const std::string& name) {
                                    options.placement = name == "centre" ? LightPlacement::centre
                                                        : name == "matched"
                                                            ? LightPlacement::matched
                                                            : LightPlacement::centroid;
                                },
                                "Where in its region a light stands (default centroid, of its "
                                "energy; matched: moved "
                                "from there so that all lights together are nearer the probe)")
                             ->check(CLI::IsMember({"centroid", "centre", "matched"}))
                             ->type_name("WHERE");
    CLI::Option* previous =
        app.add_option("--previous", options.previous,
                       "Lights of the frame before, whose identity and order are kept")
            ->type_name("FILE");
    CLI::Option* sun =
        app.add_flag("--sun", options.sun, "The sun or brightest lamp as the only light");
    for (CLI::Option* other : {count, error, method, place, previous})
        sun->excludes(other);
    app.add_option("--residual", options.residual, "With --sun: the probe without it, a lat-long")
        ->type_name("OUT")
        ->group("Output");
}

} // namespace

Command bindLights(CLI::App& root) {
    CLI::App* app = root.add_subcommand(
        "lights", "Directional lights by median or variance cut, or the sun, as JSON, glTF, USD");
    auto options = std::make_shared<LightsOptions>();
    bindProbe(*app, options->probe);
    bindCuts(*app, *options);
    app->add_option("-o,--output", options->output, "File to write, - for standard output")
        ->type_name("OUT")
        ->capture_default_str()
        ->group("Output");
    app->add_option("--format", options->format,
                    "Format instead of what the extension says (on standard output json)")
        ->check(CLI::IsMember({"json", "csv", "gltf", "usda"}))
        ->type_name("FORMAT")
        ->group("Output");
    app->add_option("--preview", options->preview,
                    "Picture of the probe, its regions and lights to write")
        ->type_name("PNG")
        ->group("Output");
    bindCommon(*app, options->common);
    return {app, [options] { runLights(*options); }};
}

} // namespace ibl
