#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/display_options.h"
#include "cli/prefiltering.h"
#include "cli/session.h"

#include "core/error.h"
#include "image/read.h"
#include "render/renderer.h"

#include <nlohmann/json.hpp>

#include "panorama/square_maps.h"
#include <charconv>
#include <cmath>
#include <filesystem>

#include <memory>

namespace ibl {
namespace {

struct RenderOptions {
    CommonOptions common;
    ProbeOptions probe;
    ImageOutputOptions output;
    std::string object = "sphere";
    Shader shader = Shader::mirror;
    V3d base_color{1, 1, 1};
    std::optional<double> reflectivity;
    std::string background = "probe";
    std::optional<V3d> eye; ///< otherwise the orbit
    V3d target{0, 0, 0};
    V3d up{0, 1, 0};
    double azimuth = 0;
    double elevation = 0;
    double distance = 4;
    double fov = 40;
    FrameOptions frame;
    DisplayArguments display;
    std::string shader_folder;
};

/// `WxH`, both from 1.
void parseSize(const std::string& text, FrameOptions& frame) {
    const std::size_t cross = text.find('x');
    const auto number = [&](std::size_t begin, std::size_t end, int& value) {
        const auto [last, problem] = std::from_chars(text.data() + begin, text.data() + end, value);
        return problem == std::errc() && last == text.data() + end && value >= 1;
    };
    if (cross == std::string::npos || !number(0, cross, frame.width) ||
        !number(cross + 1, text.size(), frame.height)) {
        throw CLI::ValidationError("--size", "'" + text + "' is not WIDTHxHEIGHT, such as 640x480");
    }
}

Camera cameraOf(const RenderOptions& options) {
    if (!options.eye) {
        return orbitCamera(options.azimuth, options.elevation, options.distance, options.target,
                           options.fov);
    }
    return {*options.eye, options.target, options.up, options.fov};
}

Object objectOf(Session& session, const std::string& name) {
    if (std::optional<Object> builtin = builtinObject(name)) return std::move(*builtin);
    std::error_code ignored;
    if (!std::filesystem::path(name).has_extension() && !std::filesystem::exists(name, ignored)) {
        std::string names;
        for (const std::string_view known : builtinObjectNames())
            names.append(" ").append(known);
        throw Error(ExitCode::usage, "--object " + name + ": no such object; there are" + names +
                                         ", or an OBJ file");
    }
    session.addInput(name);
    return {session.stage("mesh", [&] { return loadObj(name); })};
}

/// `r,g,b`, if the text is three numbers.
std::optional<V3f> colorFrom(const std::string& text) {
    V3f color;
    const char* at = text.data();
    const char* end = at + text.size();
    for (int c = 0; c < 3; ++c) {
        const auto [next, problem] = std::from_chars(at, end, color[c]);
        if (problem != std::errc()) return std::nullopt;
        at = next;
        if (c < 2 && (at == end || *at++ != ',')) return std::nullopt;
    }
    return at == end ? std::optional(color) : std::nullopt;
}

Background backgroundOf(Session& session, const RenderOptions& options) {
    if (options.background == "probe") return ProbeBackground{};
    if (options.background == "none") return NoBackground{};
    if (const std::optional<V3f> color = colorFrom(options.background)) return *color;
    std::error_code ignored;
    if (options.background.find(',') != std::string::npos &&
        !std::filesystem::exists(options.background, ignored)) {
        throw Error(ExitCode::usage, "--background " + options.background +
                                         ": a colour is three numbers, such as 0.2,0.2,0.2");
    }
    session.addInput(options.background);
    ReadOptions how;
    how.threads = session.threads();
    ImageFile file =
        session.stage("background", [&] { return readImage(options.background, how); });
    for (const std::string& text : file.notes)
        session.note(options.background, text);
    return std::move(file.image);
}

void runRender(const RenderOptions& options) {
    Session session("render", options.common);
    const WriteOptions how = writeOptions(options.output, options.common);
    requireFitting(options.display, options.output);
    if (options.reflectivity && options.shader != Shader::mirrorDiffuse) {
        throw Error(ExitCode::usage,
                    "--reflectivity is of the shader mirror-diffuse; leave it out");
    }
    for (int c = 0; c < 3; ++c) {
        if (!(options.base_color[c] >= 0) || !std::isfinite(options.base_color[c])) {
            throw Error(ExitCode::usage, "--base-color is not negative; give three numbers from 0");
        }
    }
    cameraRays(cameraOf(options), options.frame.width, options.frame.height); // refuses bad cameras
    Panorama probe = session.readProbe(options.probe);
    // Textures hold lat-longs and cubes.
    if (isSquareMap(probe.layout)) {
        probe = {Layout::latlong, latlongOf(std::move(probe), session.threads())};
    }
    Scene scene;
    scene.probe = &probe;
    scene.object = objectOf(session, options.object);
    scene.material.shader = options.shader;
    scene.material.base_color = V3f(options.base_color);
    if (options.reflectivity) {
        scene.material.reflectivity = static_cast<float>(*options.reflectivity);
    }
    scene.background = backgroundOf(session, options);

    Panorama diffuse;
    if (needsDiffuse(scene.material)) {
        const Panorama latlong{Layout::latlong, latlongOf(Panorama(probe), session.threads())};
        const PrefilterRequest request{{Kernel::lambert, 0}, Layout::faces, 64};
        diffuse = std::move(runPrefilter(session, latlong, {&request, 1}, {})[0].map);
        scene.diffuse = &diffuse;
    }

    const EglContext context = session.stage("context", [] { return EglContext(); });
    session.detail("device: " + context.description());
    session.results()["device"] = context.description();
    FrameOptions frame = options.frame;
    if (!options.shader_folder.empty()) frame.shader_folder = options.shader_folder;
    Renderer renderer = session.stage("upload", [&] { return Renderer(context, scene, frame); });
    Image picture = session.stage("draw", [&] { return renderer.render(cameraOf(options)); });
    showPicture(session, context, options.display, std::move(picture), std::nullopt, options.output,
                how, frame.shader_folder);
    session.finish();
}

void bindCamera(CLI::App& app, RenderOptions& options) {
    V3d& target = options.target;
    CLI::Option* eye =
        app.add_option_function<std::vector<double>>(
               "--eye",
               [&options](const std::vector<double>& v) { options.eye = V3d(v[0], v[1], v[2]); },
               "Where the camera stands")
            ->delimiter(',')
            ->expected(3)
            ->type_name("X,Y,Z");
    addTriple(app, "--target", target, "Where it looks (default 0,0,0)")->group("Camera");
    addTriple(app, "--up", options.up, "What is up in the picture (default 0,1,0)")
        ->needs(eye)
        ->group("Camera");
    eye->group("Camera");
    const auto orbit = [&](const char* name, double& value, const char* help) {
        return app.add_option(name, value, help)
            ->excludes(eye)
            ->capture_default_str()
            ->group("Camera");
    };
    const CLI::Validator above_zero(
        [](const std::string& text) {
            double value = 0;
            const bool fits = CLI::detail::lexical_cast(text, value) && value > 0 && value < 1e9;
            return fits ? std::string() : "'" + text + "' is not a number above 0 and below 1e9";
        },
        "ABOVE 0");
    orbit("--azimuth", options.azimuth, "Camera's longitude about the target, 0 at +Z, 90 at +X")
        ->type_name("DEG");
    orbit("--elevation", options.elevation, "Its latitude, -90 to 90")
        ->check(CLI::Range(-90.0, 90.0))
        ->type_name("DEG");
    orbit("--distance", options.distance, "Its distance from the target")
        ->check(above_zero)
        ->type_name("D");
    app.add_option("--fov", options.fov, "Vertical field of view, above 0 and below 180")
        ->type_name("DEG")
        ->capture_default_str()
        ->group("Camera");
}

void bindPicture(CLI::App& app, RenderOptions& options) {
    app.add_option_function<std::string>(
           "--size", [&options](const std::string& text) { parseSize(text, options.frame); },
           "Width and height in pixels (default 512x512)")
        ->type_name("WxH")
        ->group("Picture");
    app.add_option("--samples", options.frame.samples,
                   "Shaded samples a pixel, averaged in linear light")
        ->check(CLI::Range(1, 4096))
        ->type_name("N")
        ->capture_default_str()
        ->group("Picture");
    app.add_option(
           "--background", options.background,
           "What is behind the object: probe, none (premultiplied alpha), r,g,b or an image "
           "of the picture's size")
        ->type_name("WHAT")
        ->capture_default_str()
        ->group("Picture");
}

} // namespace

Command bindRender(CLI::App& root) {
    CLI::App* app = root.add_subcommand("render", "Draw an object under a probe, offscreen");
    auto options = std::make_shared<RenderOptions>();
    bindProbe(*app, options->probe, "--probe");
    std::string objects;
    for (const std::string_view name : builtinObjectNames())
        objects += std::string(name) + ", ";
    app->add_option("--object", options->object, objects + "or an OBJ file")
        ->type_name("OBJECT")
        ->capture_default_str()
        ->group("Object");
    std::vector<std::string> shaders;
    for (const ShaderInfo& row : shaderTable())
        shaders.emplace_back(row.name);
    app->add_option_function<std::string>(
           "--shader",
           [o = options.get()](const std::string& n) { o->shader = *shaderFromName(n); },
           "Material of the object (default mirror)")
        ->check(CLI::IsMember(shaders))
        ->type_name("NAME")
        ->group("Object");
    addTriple(*app, "--base-color", options->base_color, "Tint or albedo (default 1,1,1)", "R,G,B")
        ->group("Object");
    app->add_option("--reflectivity", options->reflectivity,
                    "Of mirror-diffuse, 0 to 1 (default 0.5)")
        ->check(CLI::Range(0.0, 1.0))
        ->type_name("K")
        ->group("Object");
    app->add_option("--shader-folder", options->shader_folder,
                    "Folder whose files replace the built-in shaders of the same name")
        ->check(CLI::ExistingDirectory)
        ->type_name("DIR")
        ->group("Object");
    bindCamera(*app, *options);
    bindPicture(*app, *options);
    bindDisplay(*app, options->display);
    bindImageOutput(*app, options->output);
    bindCommon(*app, options->common);
    return {app, [options] { runRender(*options); }};
}

} // namespace ibl
