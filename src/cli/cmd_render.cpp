#include "cli/commands.h"
#include "cli/frame_writer.h"
#include "cli/render_options.h"
#include "cli/session.h"

#include "core/error.h"
#include "image/finite.h"
#include "render/shader_program.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace ibl {
namespace {

struct RenderOptions {
    CommonOptions common;
    ProbeOptions probe;
    ImageOutputOptions output;
    TurnArguments turn;
    ObjectArguments object;
    MaterialArguments material;
    MapArguments maps;
    CameraArguments camera;
    LensArguments lens;
    PictureArguments picture;
    LightArguments lights;
    DisplayArguments display;
    FrameRange frames;
    DeviceArguments device;
    std::string shader_folder;
};

/// The scene of a frame and what it was made from. What the next frame has under the same name is
/// kept.
struct LoadedScene {
    std::string probe_name, object_name, background_name, lights_name;
    std::optional<ShaderText> own_shader;
    RenderMaps maps;
    bool fixed = true; ///< Material::fixed of what the maps were made for
    std::vector<NamedCamera> cameras;
    Scene scene;
};

void requireSize(const std::string& name, const Background& background, const FrameOptions& frame) {
    const auto* image = std::get_if<ImageBackground>(&background);
    if (!image || (image->width == frame.width && image->height == frame.height)) return;
    const auto size = [](int width, int height) {
        return std::to_string(width) + "x" + std::to_string(height);
    };
    throw inputError(name, "is of " + size(image->width, image->height) +
                               " pixels, the picture of " + size(frame.width, frame.height) +
                               "; resize one of them");
}

/// Brings the scene to a frame. Returns whether anything has to be uploaded.
bool loadScene(Session& session, const RenderOptions& options, const FrameOptions& frame,
               const FramePlace& place, LoadedScene& loaded) {
    Scene& scene = loaded.scene;
    scene.material = materialOf(options.material, loaded.own_shader, place);
    scene.interpolation = options.material.interpolation;
    scene.turn = turnOf(options.turn, place);
    scene.placement = placementOf(options.object, place);
    bool changed = false;
    const auto renamed = [&](std::string& last, const std::string& pattern) {
        const std::string name = nameOfFrame(pattern, options.frames, place);
        if (name == last) return false;
        last = name;
        return changed = true;
    };
    if (renamed(loaded.object_name, options.object.name)) {
        ObjectFile file = objectOf(session, options.object, loaded.object_name);
        scene.object = std::move(file.object);
        loaded.cameras = std::move(file.cameras);
        overrideSurfaces(options.material, scene.object);
    }
    if (!scene.ground) scene.ground = groundOf(options.lights, scene);
    const std::string& plate = options.lights.plate;
    if (renamed(loaded.background_name, plate.empty() ? options.picture.background : plate)) {
        scene.background = plate.empty()
                               ? backgroundOf(session, loaded.background_name)
                               : Background(session.readPicture(loaded.background_name, "plate"));
        requireSize(loaded.background_name, scene.background, frame);
    }
    if (surfacesVary(scene.object)) scene.material.fixed = false;
    const bool other_lights = renamed(loaded.lights_name, options.lights.lights);
    const bool counted = isLightCount(loaded.lights_name);
    const bool other_probe = renamed(loaded.probe_name, options.probe.input);
    if (other_probe || scene.material.fixed != loaded.fixed) {
        ProbeOptions probe = options.probe;
        probe.input = loaded.probe_name;
        loaded.maps = prepareMaps(session, probe, options.maps, scene, counted);
        loaded.maps.show(scene);
        loaded.fixed = scene.material.fixed;
    }
    if (other_lights || (other_probe && counted)) {
        scene.lights = lightsOf(session, options.lights, loaded.lights_name, loaded.maps.probe);
    }
    return changed;
}

/// What draws frames in turn: the device, the scene on it, and how pictures are shown.
struct Drawing {
    const EglContext& context;
    const FrameOptions& frame;
    std::size_t bad_pixels = 0; ///< with NaN or infinite values, of all frames
    LoadedScene loaded = LoadedScene();
    std::optional<Renderer> renderer = std::nullopt;
};

/// A frame as it is written: the picture and what is known beside it.
struct Frame {
    Image picture;
    std::vector<ExtraChannel> aovs;
};

/// Pictures that are written, whose memory later frames take over.
class SparePictures {
public:
    Image take() {
        const std::lock_guard lock(mutex_);
        if (pictures_.empty()) return {};
        Image last = std::move(pictures_.back());
        pictures_.pop_back();
        return last;
    }

    /// A frame whose picture comes back when nobody needs it any more.
    std::shared_ptr<Frame> hold(Frame frame) {
        return {new Frame(std::move(frame)), [this](Frame* used) {
                    const std::unique_ptr<Frame> owned(used);
                    const std::lock_guard lock(mutex_);
                    pictures_.push_back(std::move(used->picture));
                }};
    }

private:
    std::mutex mutex_;
    std::vector<Image> pictures_;
};

std::size_t countNotFinite(const Image& picture) {
    if (allFinite(picture.pixels)) return 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < picture.pixels.size(); i += picture.channels) {
        float sum = 0; // of zeros, or NaN
        for (std::size_t c = i; c < i + picture.channels; ++c)
            sum += 0 * picture.pixels[c];
        count += sum != 0;
    }
    return count;
}

void noteNotFinite(Session& session, const std::string& shader, std::size_t count) {
    if (count == 0) return;
    session.note("--shader " + shader,
                 std::to_string(count) + (count == 1 ? " pixel was" : " pixels were") +
                     " NaN or infinite; written as 0 and as the largest number that fits");
}

void noteUnset(Session& session, const std::string& shader, const std::vector<std::string>& names) {
    if (names.empty()) return;
    std::string list;
    for (const std::string& name : names)
        list += (list.empty() ? "" : ", ") + name;
    const bool one = names.size() == 1;
    session.note("--shader " + shader,
                 (one ? "no option sets its uniform " : "no options set its uniforms ") + list +
                     (one ? "; it stays" : "; they stay") +
                     " as declared, 0 where nothing is said");
}

Frame drawFrame(Session& session, const RenderOptions& options, const FramePlace& place,
                Drawing& drawing, Image spare = {}) {
    const bool changed = loadScene(session, options, drawing.frame, place, drawing.loaded);
    const Scene& scene = drawing.loaded.scene;
    if (changed) {
        session.stage("upload",
                      [&] { drawing.renderer.emplace(drawing.context, scene, drawing.frame); });
    } else {
        drawing.renderer->change(scene.material, scene.turn, scene.placement);
    }
    const Camera camera = cameraOf(options.camera, place, drawing.frame, drawing.loaded.cameras);
    Frame frame{
        session.stage("draw", [&] { return drawing.renderer->render(camera, std::move(spare)); }),
        {}};
    drawing.bad_pixels += countNotFinite(frame.picture);
    if (!scene.lights.empty()) reportLights(session, drawing.renderer->lightCounts());
    const bool blurs = options.lens.blurs(place);
    if (blurs || !options.picture.aovs.empty()) {
        FrameAovs aovs = session.stage("aov", [&] { return drawing.renderer->renderAovs(camera); });
        if (blurs) {
            session.stage("lens", [&] {
                throughLens(drawing.context, options.lens, place, camera, drawing.frame,
                            scene.ground, aovs, session.threads(), frame.picture);
            });
        }
        frame.aovs = aovChannels(options.picture, std::move(aovs));
    }
    if (drawing.frame.matte) frame.aovs.push_back(takeMatte(frame.picture));
    return frame;
}

WriteLosses writeFrame(OutputSet& outputs, const std::string& name, const RenderOptions& options,
                       const Frame& frame, WriteOptions how, int threads) {
    how.extra = frame.aovs;
    return writeShown(outputs, name, frame.picture, options.display, how, threads);
}

/// All frames; each is encoded and written while later ones are drawn.
void drawSequence(Session& session, const RenderOptions& options, const WriteOptions& how,
                  Drawing& drawing, PictureDisplay& display) {
    nlohmann::ordered_json frames = nlohmann::ordered_json::array();
    std::vector<std::string> names;
    SparePictures spares; // outlives the frames in the writer
    FrameWriter writer(session.threads());
    for (FramePlace place{options.frames.first, 0, options.frames.count()};
         place.index < place.count; ++place.number, ++place.index) {
        const auto frame = spares.hold(drawFrame(session, options, place, drawing, spares.take()));
        const double exposure = display.show(frame->picture);
        const std::string name = nameOfFrame(options.output.output, options.frames, place);
        names.push_back(name);
        frames.push_back({{"frame", place.number}, {"exposure", exposure}});
        session.stage("wait", [&] {
            writer.add([frame, name, &options, &how](OutputSet& outputs) {
                return writeFrame(outputs, name, options, *frame, how, 1);
            });
        });
    }
    const auto written = session.stage("wait", [&] { return writer.finish(); });
    WriteLosses losses;
    for (std::size_t i = 0; i < written.size(); ++i) {
        losses += written[i].losses;
        session.addOutput(names[i]);
        session.addSeconds("encode", written[i].seconds);
    }
    const double pixels = static_cast<double>(drawing.frame.width) * drawing.frame.height;
    noteShown(session, options.output.output, losses, options.display, how,
              pixels * static_cast<double>(written.size()));
    session.results()["frames"] = std::move(frames);
}

/// Refuses, before any work is done, what the first frame would be refused for.
void requireSound(const RenderOptions& options, const std::optional<ShaderText>& own_shader) {
    requireFrames(options.frames, options.output.output);
    requireFitting(options.display, options.output, options.frames.count());
    requireLightUse(options.lights, materialOf(options.material, own_shader, {}), options.picture);
    requireLens(options.lens, options.camera);
    if (!options.picture.aovs.empty()) requireExr(options.output, "--aov");
    if (options.camera.of_file.empty()) {
        const FrameOptions& frame = options.picture.frame;
        cameraRays(cameraOf(options.camera, {}, frame, {}), frame.width, frame.height);
    } else if (options.object.fit) {
        throw Error(ExitCode::usage, "--fit takes the object from what the file's camera looks at; "
                                     "leave out --fit or --camera");
    }
}

/// The folder, if it is one and replaces anything.
std::filesystem::path shaderFolder(const std::string& name) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(name, ignored))
        throw inputError(name, "there is no such folder; check the name");
    const bool replaces = std::ranges::any_of(embeddedShaders(), [&](const EmbeddedShader& shader) {
        return std::filesystem::exists(std::filesystem::path(name) / shader.name, ignored);
    });
    if (!replaces) {
        throw inputError(name, "has no file of a built-in shader's name; give one that has, or "
                               "--shader FILE.frag for a shader of your own");
    }
    return name;
}

void runRender(const RenderOptions& options) {
    Session session("render", options.common);
    const WriteOptions how = writeOptions(options.output, options.common);
    const std::optional<ShaderText> own_shader = ownShader(session, options.material);
    requireSound(options, own_shader);
    FrameOptions frame = options.picture.frame;
    frame.shadow_size = options.lights.shadow_size.value_or(0);
    frame.matte =
        options.lights.ground && options.picture.background != "none" && isExr(options.output);
    std::optional<Image> plate; // of the first frame, whose size all frames have
    const std::string plate_name =
        nameOfFrame(options.lights.plate, options.frames, {options.frames.first, 0, 1});
    if (!plate_name.empty() && !options.picture.size_given) {
        plate = session.readPicture(plate_name, "plate");
        frame.width = plate->width;
        frame.height = plate->height;
    }
    if (!options.shader_folder.empty()) frame.shader_folder = shaderFolder(options.shader_folder);
    const EglContext context = session.stage("context", [&] { return contextOf(options.device); });
    if (options.common.verbose) {
        const std::vector<std::string> devices = eglDevices();
        for (std::size_t i = 0; i < devices.size(); ++i)
            session.detail("EGL device " + std::to_string(i) + ": " + devices[i]);
    }
    session.detail("device: " + context.description());
    session.results()["device"] = context.description();

    Drawing drawing{context, frame};
    drawing.loaded.own_shader = own_shader;
    if (plate) {
        drawing.loaded.background_name = plate_name;
        drawing.loaded.scene.background = std::move(*plate);
    }
    PictureDisplay display(session, context, options.display, frame.shader_folder);
    if (options.frames.told) {
        drawSequence(session, options, how, drawing, display);
        display.handOn();
    } else {
        Frame drawn = drawFrame(session, options, {}, drawing);
        display.show(drawn.picture);
        display.handOn();
        const std::string& name = options.output.output;
        session.stage("write", [&] {
            const WriteLosses losses =
                writeFrame(session.outputs(), name, options, drawn, how, session.threads());
            noteShown(session, name, losses, options.display, how,
                      static_cast<double>(frame.width) * frame.height);
            session.addOutput(name);
        });
    }
    noteNotFinite(session, options.material.shader, drawing.bad_pixels);
    noteUnset(session, options.material.shader, drawing.renderer->unsetUniforms());
    session.finish();
}

} // namespace

Command bindRender(CLI::App& root) {
    CLI::App* app = root.add_subcommand("render", "Draw an object under a probe, offscreen");
    auto options = std::make_shared<RenderOptions>();
    bindProbe(*app, options->probe, "--probe");
    bindTurn(*app, options->turn, options->frames);
    bindObject(*app, options->object, options->frames);
    bindMaterial(*app, options->material, options->frames);
    bindMaps(*app, options->maps);
    app->add_option("--shader-folder", options->shader_folder,
                    "Folder whose files replace the built-in shaders of the same name")
        ->type_name("DIR")
        ->group("Material");
    bindCamera(*app, options->camera, options->frames);
    bindLens(*app, options->lens, options->frames);
    bindPicture(*app, options->picture);
    bindLightOptions(*app, options->lights);
    bindFrames(*app, options->frames);
    bindDisplay(*app, options->display);
    bindImageOutput(*app, options->output);
    bindDevice(*app, options->device);
    bindCommon(*app, options->common);
    return {app, [options] { runRender(*options); }};
}

} // namespace ibl
