#include "render/renderer_state.h"

#include "core/error.h"
#include "render/light_choice.h"
#include "render/surface_program.h"
#include "render/uniforms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace ibl {
namespace {

// A frame is drawn in tiles, so that memory beside the picture itself does not grow with it. Every
// tile draws the whole mesh once a sample, so they are no smaller than they must be.
constexpr int kTileWidth = 2048, kTileHeight = 2048;

Error usage(const std::string& problem) {
    return {ExitCode::usage, "render: " + problem};
}

// On the ground, the more lights, the less it shows how fine the map of each is. On a lit object it
// shows: 256 lights' maps of 512 texels are off by 2.5 times as much as those of 1024.
int shadowSize(const FrameOptions& options, bool lit, std::size_t lights) {
    if (options.shadow_size > 0) return options.shadow_size;
    int size = 256;
    while (size < 2048 && 4 * size < 3 * options.height)
        size *= 2;
    while (!lit && size > 256 &&
           std::min(lights, Lighting::mapsAtOnce(256)) > Lighting::mapsAtOnce(size))
        size /= 2;
    return size;
}

} // namespace

bool needsProbe(const Material& material, const Background& background) {
    return mapNeeds(material).probe || std::holds_alternative<ProbeBackground>(background);
}

bool needsDiffuse(const Material& material) {
    return mapNeeds(material).diffuse;
}

void Renderer::State::uploadScene(const Scene& scene) {
    if (needsProbe(scene.material, scene.background)) {
        if (!scene.probe) throw usage("the picture needs a probe; give one");
        probe = uploadPanorama(*scene.probe, "probe");
    }
    if (needsDiffuse(scene.material)) {
        if (!scene.diffuse) throw usage("the shader needs a diffuse map; give one");
        diffuse = uploadPanorama(*scene.diffuse, "diffuse map");
    }
    uploadLobe(scene);
    if (const auto* picture = std::get_if<ImageBackground>(&scene.background)) {
        if (picture->width != options.width || picture->height != options.height) {
            throw usage("the background image is not of the frame's size; resize one of them");
        }
        image = uploadImage(*picture, "background image");
    }
    if (const auto* color = std::get_if<ColorBackground>(&scene.background)) clear_color = *color;
    with_alpha = options.matte || std::holds_alternative<NoBackground>(scene.background);
    extent = extentOf(scene.object);
    parts = partsOf(scene.object);
    surfaces = uploadSurfaces(scene.object);
    if (scene.object.mesh) mesh = uploadMesh(*scene.object.mesh);
    lit = !scene.material.own && shaderInfo(scene.material.shader).lit;
    lit_at_points = lit && scene.interpolation != Interpolation::gouraud;
    ground = scene.ground;
    if (!lit && !ground) return;
    if (scene.lights.empty()) throw usage("nothing lights the picture; give lights");
    light_scene = &scene;
    lighting.emplace(scene, surfaces.definitions, shadowSize(options, lit, scene.lights.size()),
                     options.samples, options.shader_folder);
}

void Renderer::State::uploadLobe(const Scene& scene) {
    const MapNeeds needs = mapNeeds(scene.material);
    const auto require = [](bool there, const char* what) {
        if (!there) throw usage(std::string("the shader needs ") + what + "; give it");
    };
    if (needs.specular) {
        require(scene.specular, "a specular chain");
        const auto& [levels, first, last] = *scene.specular;
        specular = uploadCubeLevels(levels, "specular map");
        specular_scale = {
            first, last > first ? static_cast<double>(levels.size() - 1) / (last - first) : 0};
    }
    if (needs.split_sum) {
        require(scene.split_sum, "a split-sum table");
        split_sum = uploadImage(*scene.split_sum, "split-sum table");
        glTextureParameteri(split_sum.id(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
        glTextureParameteri(split_sum.id(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        glTextureParameteri(split_sum.id(), GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
        glTextureParameteri(split_sum.id(), GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    }
    if (needs.probe_levels) {
        require(scene.probe_levels, "the probe's levels");
        probe_levels = uploadCubeLevels(*scene.probe_levels, "probe");
    }
}

std::vector<std::string> Renderer::State::mapDefinitions() const {
    std::vector<std::string> definitions = probe.definitions("PROBE");
    for (const std::string& d : diffuse.definitions("DIFFUSE"))
        definitions.push_back(d);
    const auto define = [&](const std::vector<std::string>& more) {
        definitions.insert(definitions.end(), more.begin(), more.end());
    };
    if (lighting) define(lighting->definitions());
    if (ground) define({"GROUND_ALBEDO " + std::to_string(ground->albedo.has_value())});
    return definitions;
}

std::vector<std::string> Renderer::State::surfaceDefinitions() const {
    std::vector<std::string> definitions = mapDefinitions();
    for (const std::string& d : surfaces.definitions)
        definitions.push_back(d);
    return definitions;
}

void Renderer::State::makeSurface(const Scene& scene) {
    interpolation = scene.interpolation;
    const SurfaceKind kind{mesh.has_value(), interpolation};
    surface = makeProgram(surfaceParts(scene.material, kind, surfaceDefinitions()),
                          options.shader_folder);
    setUniform(surface, "specular_scale", specular_scale);
    if (mesh && mapNeeds(scene.material).far_side) {
        far_side = makeFarSide(
            {options.width, options.height},
            makeProgram(farSideParts(kind, surfaces.definitions), options.shader_folder));
    }
}

void Renderer::State::makePrograms(const Scene& scene) {
    const auto program = [&](std::vector<std::string_view> fragment) {
        return makeProgram({{"fullscreen.vert"}, std::move(fragment), mapDefinitions(), {}},
                           options.shader_folder);
    };
    makeSurface(scene);
    if (lit_at_points) {
        std::vector<std::string_view> files{"view.glsl"};
        for (const std::string_view file : litFiles(scene.material.shader))
            files.push_back(file);
        files.push_back("lit.frag");
        under_lights = program(std::move(files));
    }
    makeBackground(scene);
    if (ground) makeGround();
    resolve = program({"resolve.frag"});
    if (options.samples > 1 || lighting) accumulate = program({"accumulate.frag"});
    // Each sample goes into the sum by the weight 2^-k, where 2^k >= samples.
    const double weight = std::exp2(-std::ceil(std::log2(options.samples)));
    if (accumulate) setUniform(accumulate, "weight", weight);
    setUniform(resolve, "sum_weight", weight * options.samples);
    setMaterial(scene.material);
    place(scene.turn, scene.placement);
}

void Renderer::State::makeBackground(const Scene& scene) {
    std::vector<std::string_view> files{"view.glsl", "lookup.glsl", "maps.glsl"};
    if (std::holds_alternative<ProbeBackground>(scene.background)) {
        files.push_back("background_probe.glsl");
    } else if (image) {
        files.push_back("background_image.glsl");
    } else if (ground) {
        files.push_back("background_plain.glsl");
    } else {
        return;
    }
    if (ground) {
        for (const std::string_view file : {"light_blocks.glsl", "lights.glsl", "ground.glsl"})
            files.push_back(file);
    }
    files.push_back(ground ? "ground.frag" : "background.frag");
    background =
        makeProgram({{"fullscreen.vert"}, files, mapDefinitions(), {}}, options.shader_folder);
}

void Renderer::State::makeGround() {
    setUniform(background, "plain_color", V3d(clear_color));
    setUniform(background, "ground_height", ground->height);
    if (ground->albedo) setUniform(background, "ground_albedo", *ground->albedo);
    ground_shadow = makeProgram(
        {{"light_blocks.glsl", "ground_shadow.vert"},
         {"view.glsl", "light_blocks.glsl", "lights.glsl", "ground.glsl", "ground_shadow.frag"},
         mapDefinitions(),
         {}},
        options.shader_folder);
    setUniform(ground_shadow, "ground_height", ground->height);
    setUniform(ground_shadow, "map_size", V2d(lighting->mapSize()));
}

void Renderer::State::place(const Turn& turn, const Placement& placement) {
    similarity = similarityOf(placement, extent);
    if (lighting) {
        lighting->place(*light_scene, turn, similarity);
        const double lowest = lowestPoint(light_scene->object, placement);
        if (ground && ground->height > lowest + 1e-5 * similarity.scale * extent.radius) {
            char text[80];
            std::snprintf(text, sizeof text, "the ground cuts the object; lower it to %.6g",
                          lowest);
            throw usage(text);
        }
    }
    if (lit) {
        const M33d& t = similarity.turn;
        const Program& program = lit_at_points ? under_lights : surface;
        setUniform(program, "object_right", V3d(t[0][0], t[0][1], t[0][2]));
        setUniform(program, "object_up", V3d(t[1][0], t[1][1], t[1][2]));
    }
    const M33d probe_from_world = turnMatrix(turn).transposed();
    setUniform(surface, "probe_from_world", probe_from_world);
    setUniform(surface, "object_extent", 2 * extent.radius * similarity.scale);
    if (background) setUniform(background, "probe_from_world", probe_from_world);
}

void Renderer::State::setMaterial(const Material& of_object) {
    material = of_object;
    ibl::setMaterial(surface, material);
    if (under_lights) ibl::setMaterial(under_lights, material);
}

V2i Renderer::State::tileSize() const {
    return {std::min(options.width, kTileWidth), std::min(options.height, kTileHeight)};
}

void Renderer::State::makeTargets() {
    const V2i size = tileSize();
    depth = makeRenderbuffer(GL_DEPTH_COMPONENT32F, size.x, size.y);
    sample = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, size.x, size.y);
    to_sample = makeFramebuffer(sample, depth.id());
    if (accumulate) {
        sum = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, size.x, size.y);
        to_sum = makeFramebuffer(sum);
    }
    if (lit_at_points) makePointTargets(size);
    if (ground) {
        kept = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, size.x, size.y);
        to_kept = makeFramebuffer(kept);
    }
    mean = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, size.x, size.y);
    to_mean = makeFramebuffer(mean);
    GLuint array = 0;
    glCreateVertexArrays(1, &array);
    no_vertices = VertexArray(array);
}

void Renderer::State::makePointTargets(const V2i& size) {
    to_points = makeFramebuffer(sample, depth.id());
    std::array<GLenum, 5> buffers{GL_COLOR_ATTACHMENT0};
    for (std::size_t i = 0; i < lit_points.size(); ++i) {
        lit_points[i] = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, size.x, size.y);
        buffers[i + 1] = GL_COLOR_ATTACHMENT1 + static_cast<GLenum>(i);
        glNamedFramebufferTexture(to_points.id(), buffers[i + 1], lit_points[i].id(), 0);
    }
    glNamedFramebufferDrawBuffers(to_points.id(), static_cast<GLsizei>(buffers.size()),
                                  buffers.data());
}

Renderer::Renderer(const EglContext&, const Scene& scene, const FrameOptions& options)
    : state_(std::make_unique<State>()) {
    std::array<GLint, 2> limit{};
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, limit.data());
    if (options.width < 1 || options.height < 1 || options.width > limit[0] ||
        options.height > limit[1]) {
        throw usage("this device draws frames from 1x1 to " + std::to_string(limit[0]) + "x" +
                    std::to_string(limit[1]) + " pixels; choose a size among these");
    }
    if (scene.interpolation != Interpolation::phong && !scene.object.mesh) {
        throw usage("the sphere has no triangles to interpolate over; take another object");
    }
    if (options.samples < 1) throw usage("there is no picture of no samples; give at least one");
    state_->options = options;
    state_->uploadScene(scene);
    state_->makePrograms(scene);
    state_->makeTargets();
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

void Renderer::change(const Material& material, const Turn& turn, const Placement& placement) {
    state_->setMaterial(material);
    state_->place(turn, placement);
}

Image Renderer::render(const Camera& camera, Image spare) {
    const int width = state_->options.width, height = state_->options.height;
    const int channels = state_->with_alpha ? 4 : 3;
    Image frame = std::move(spare);
    frame.width = width;
    frame.height = height;
    frame.channels = channels; // the spare one may have lost its alpha
    frame.pixels.resize(frame.rowFloats() * static_cast<std::size_t>(height));
    state_->drawFrame(camera, frame);
    return frame;
}

LightCounts Renderer::lightCounts() const {
    return state_->lighting ? state_->lighting->counts() : LightCounts{};
}

std::vector<std::string> Renderer::unsetUniforms() const {
    const std::optional<ShaderText>& own = state_->material.own;
    return own ? ibl::unsetUniforms(state_->surface, *own) : std::vector<std::string>();
}

FrameAovs Renderer::renderAovs(const Camera& camera) {
    const int width = state_->options.width, height = state_->options.height;
    const std::size_t pixels = static_cast<std::size_t>(width) * height;
    FrameAovs aovs{Image(width, height), std::vector<float>(pixels), std::vector<float>(pixels)};
    state_->drawAovs(camera, aovs);
    return aovs;
}

} // namespace ibl
