#include "cli/commands.h"
#include "cli/prefiltering.h"
#include "cli/render_options.h"
#include "cli/session.h"

#include "panorama/square_maps.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace ibl {
namespace {

struct RenderOptions {
    CommonOptions common;
    ProbeOptions probe;
    ImageOutputOptions output;
    ObjectArguments object;
    MaterialArguments material;
    CameraArguments camera;
    PictureArguments picture;
    LightArguments lights;
    DisplayArguments display;
    std::string shader_folder;
};

void runRender(const RenderOptions& options) {
    Session session("render", options.common);
    const WriteOptions how = writeOptions(options.output, options.common);
    requireFitting(options.display, options.output);
    FrameOptions frame = options.picture.frame;
    frame.shadow_size = options.lights.shadow_size.value_or(0);
    std::optional<Image> plate;
    if (!options.lights.plate.empty()) {
        plate = plateOf(session, options.lights);
        if (!options.picture.size_given) {
            frame.width = plate->width;
            frame.height = plate->height;
        }
    }
    const Camera camera = cameraOf(options.camera);
    cameraRays(camera, frame.width, frame.height); // refuses bad cameras
    Scene scene;
    scene.material = materialOf(options.material);
    requireLightUse(options.lights, scene.material, options.picture);
    Panorama probe = session.readProbe(options.probe);
    // Textures hold lat-longs and cubes.
    if (isSquareMap(probe.layout)) {
        probe = {Layout::latlong, latlongOf(std::move(probe), session.threads())};
    }
    scene.probe = &probe;
    scene.object = objectOf(session, options.object);
    scene.background =
        plate ? Background(std::move(*plate)) : backgroundOf(session, options.picture);
    scene.lights = lightsOf(session, options.lights, probe);
    scene.ground = groundOf(options.lights, scene.object);

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
    if (!options.shader_folder.empty()) frame.shader_folder = options.shader_folder;
    Renderer renderer = session.stage("upload", [&] { return Renderer(context, scene, frame); });
    Image picture = session.stage("draw", [&] { return renderer.render(camera); });
    if (!scene.lights.empty()) reportLights(session, renderer.lightCounts());
    showPicture(session, context, options.display, std::move(picture), std::nullopt, options.output,
                how, frame.shader_folder);
    session.finish();
}

} // namespace

Command bindRender(CLI::App& root) {
    CLI::App* app = root.add_subcommand("render", "Draw an object under a probe, offscreen");
    auto options = std::make_shared<RenderOptions>();
    bindProbe(*app, options->probe, "--probe");
    bindObject(*app, options->object);
    bindMaterial(*app, options->material);
    app->add_option("--shader-folder", options->shader_folder,
                    "Folder whose files replace the built-in shaders of the same name")
        ->check(CLI::ExistingDirectory)
        ->type_name("DIR")
        ->group("Material");
    bindCamera(*app, options->camera);
    bindPicture(*app, options->picture);
    bindLightOptions(*app, options->lights);
    bindDisplay(*app, options->display);
    bindImageOutput(*app, options->output);
    bindCommon(*app, options->common);
    return {app, [options] { runRender(*options); }};
}

} // namespace ibl
