#include "render/renderer.h"

#include "core/error.h"
#include "render/far_side.h"
#include "render/light_choice.h"
#include "render/lighting.h"
#include "render/mesh_buffers.h"
#include "render/panorama_texture.h"
#include "render/sample_pattern.h"
#include "render/surface_program.h"
#include "render/surface_textures.h"
#include "render/uniforms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ibl {
namespace {

using Imath::V2i;

// A frame is drawn in tiles, so that memory beside the picture itself does not grow with it. Every
// tile draws the whole mesh once a sample, so they are no smaller than they must be.
constexpr int kTileWidth = 2048, kTileHeight = 2048;

Error usage(const std::string& problem) {
    return {ExitCode::usage, "render: " + problem};
}

int shadowSize(const FrameOptions& options) {
    if (options.shadow_size > 0) return options.shadow_size;
    int size = 256;
    while (size < 2048 && 4 * size < 3 * options.height)
        size *= 2;
    return size;
}

// `offset` from the target's pixels to the frame's, counted from its centre.
void setView(const Program& program, const CameraRays& rays, const V2d& offset) {
    setUniform(program, "pixel_offset", offset);
    setUniform(program, "forward", rays.forward);
    setUniform(program, "step_x", rays.step_x);
    setUniform(program, "step_y", rays.step_y);
}

void setView(const Program& program, const CameraRays& rays, const V2i& tile, const V2d& jitter) {
    setView(program, rays, V2d(tile) + jitter - rays.centre);
}

void setUpDrawing(int frame_width) {
    glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    glFrontFace(GL_CW);     // counter-clockwise, in a frame whose y is down
    glDepthFunc(GL_LEQUAL); // the background stands at the far plane itself
    glBlendFunc(GL_ONE, GL_ONE);
    glPixelStorei(GL_PACK_ROW_LENGTH, frame_width);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
}

} // namespace

bool needsProbe(const Material& material, const Background& background) {
    return mapNeeds(material).probe || std::holds_alternative<ProbeBackground>(background);
}

bool needsDiffuse(const Material& material) {
    return mapNeeds(material).diffuse;
}

struct Renderer::State {
    FrameOptions options;
    bool opaque = true;
    V3f clear_color{0, 0, 0};
    Extent extent;
    std::vector<Part> parts;
    SurfaceTextures surfaces;
    Material material;
    Similarity similarity;
    PanoramaTexture probe, diffuse;
    Texture image, specular, split_sum, probe_levels;
    V2d specular_scale{0, 0}; // level = (roughness - x) y
    Interpolation interpolation = Interpolation::phong;
    std::optional<MeshBuffers> mesh;
    std::optional<FarSide> far_side;

    VertexArray no_vertices;
    std::optional<Lighting> lighting;
    std::optional<Ground> ground;
    bool lit = false;
    const Scene* light_scene = nullptr; ///< of which `lighting` chooses lights

    Program surface, under_lights, ground_shadow, background, accumulate, resolve;
    Program aov; ///< when first asked for
    // One tile: a sample, the sum of samples, and the picture as it is read.
    Texture sample, sum, mean;
    Renderbuffer depth;
    Framebuffer to_sample, to_sum, to_mean;
    std::array<Texture, 4> lit_points; ///< points, normals, facets' normals, colours
    Framebuffer to_points;             ///< these, with `sample` and its depth
    Texture kept;                      ///< from the ground
    Framebuffer to_kept;

    std::vector<std::string> mapDefinitions() const;
    std::vector<std::string> surfaceDefinitions() const;
    void uploadScene(const Scene& scene);
    void uploadLobe(const Scene& scene);
    void makeSurface(const Scene& scene);
    void makePrograms(const Scene& scene);
    void makeBackground(const Scene& scene);
    void makeGround();
    void setMaterial(const Material& material);
    void place(const Turn& turn, const Placement& placement);
    void makeTargets();
    void makePointTargets(const V2i& size);

    V2i tileSize() const;
    void drawFullscreen(const Program& program) const;
    void lightSurface(const CameraRays& rays, const V2i& tile, const V2d& jitter, int batch) const;
    void drawGroundShadow(const CameraRays& rays, const V2i& tile, const V2d& jitter,
                          int batch) const;
    void drawSample(const CameraRays& rays, const V2i& tile, const V2d& jitter, int batch) const;
    void drawSphere(const Program& program, const CameraRays& rays, const V2i& tile) const;
    void drawObject(const Program& program, const CameraRays& rays, const V2i& tile,
                    const V2d& jitter) const;
    void drawMesh(const Program& program, const CameraRays& rays, const V2d& jitter) const;
    void drawFarSide(const CameraRays& rays, const V2d& jitter) const;
    void drawTile(const CameraRays& rays, const V2i& tile);
    void placeLights(const CameraRays& rays);
    void drawFrame(const Camera& camera, Image& frame);
    void drawAovs(const Camera& camera, FrameAovs& aovs);
};

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
    opaque = !std::holds_alternative<NoBackground>(scene.background);
    extent = extentOf(scene.object);
    parts = partsOf(scene.object);
    surfaces = uploadSurfaces(scene.object);
    if (scene.object.mesh) mesh = uploadMesh(*scene.object.mesh);
    lit = !scene.material.own && shaderInfo(scene.material.shader).lit;
    ground = scene.ground;
    if (!lit && !ground) return;
    if (scene.lights.empty()) throw usage("nothing lights the picture; give lights");
    light_scene = &scene;
    lighting.emplace(scene, shadowSize(options), options.shader_folder);
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
    if (ground) {
        define({"GROUND_ALBEDO " + std::to_string(ground->albedo.has_value()),
                "GROUND_ALPHA " + std::to_string(!opaque)});
    }
    define({"KEEP_POSITIVE " + std::to_string(ground && ground->albedo)});
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
        far_side = makeFarSide({options.width, options.height},
                               makeProgram(farSideParts(kind), options.shader_folder));
    }
}

void Renderer::State::makePrograms(const Scene& scene) {
    const auto program = [&](std::vector<std::string_view> fragment) {
        return makeProgram({{"fullscreen.vert"}, std::move(fragment), mapDefinitions(), {}},
                           options.shader_folder);
    };
    makeSurface(scene);
    if (lit) {
        const std::string_view file = shaderInfo(scene.material.shader).file;
        under_lights = program(
            {"view.glsl", "light_blocks.glsl", "lights.glsl", "tangent.glsl", file, "lit.frag"});
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
    setUniform(background, "plain_alpha", opaque ? 1.0 : 0.0);
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
        if (ground && ground->height > lowest + 1e-5 * similarity.scale * extent.radius)
            throw usage("the ground cuts the object; lower it to " + std::to_string(lowest));
    }
    if (lit) {
        const M33d& t = similarity.turn;
        setUniform(under_lights, "object_right", V3d(t[0][0], t[0][1], t[0][2]));
        setUniform(under_lights, "object_up", V3d(t[1][0], t[1][1], t[1][2]));
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
    if (lit) makePointTargets(size);
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

void Renderer::State::drawFullscreen(const Program& program) const {
    glUseProgram(program.id());
    glBindVertexArray(no_vertices.id());
    glDrawArrays(GL_TRIANGLES, 0, 3);
}

// The camera is brought to the unit sphere; directions stay as they are.
void Renderer::State::drawSphere(const Program& program, const CameraRays& rays,
                                 const V2i& tile) const {
    CameraRays brought = rays;
    brought.eye = (rays.eye - similarity.shift) / similarity.scale;
    setUniform(program, "sphere_eye", brought.eye);
    setUniform(program, "moment_forward", brought.eye.cross(rays.forward));
    setUniform(program, "moment_x", brought.eye.cross(rays.step_x));
    setUniform(program, "moment_y", brought.eye.cross(rays.step_y));
    setUniform(program, "sphere_radius", similarity.scale);
    setUniform(program, "sphere_centre", similarity.shift);
    setUniform(program, "object_from_world", similarity.turn.transposed());
    const PixelRect rect = unitSphereRect(brought, options.width, options.height);
    glScissor(rect.min.x - tile.x, rect.min.y - tile.y, rect.max.x - rect.min.x,
              rect.max.y - rect.min.y);
    glEnable(GL_SCISSOR_TEST);
    glDepthRange(0, 0); // whatever the triangle's depth is: the background stays behind
    drawFullscreen(program);
    glDepthRange(0, 1);
    glDisable(GL_SCISSOR_TEST);
}

void Renderer::State::drawMesh(const Program& program, const CameraRays& rays,
                               const V2d& jitter) const {
    const M44d world_from_object = matrixOf(similarity);
    Box3f box; // in the world
    for (int corner = 0; corner < 8; ++corner) {
        const Box3f& b = extent.box;
        const V3d p(corner & 1 ? b.max.x : b.min.x, corner & 2 ? b.max.y : b.min.y,
                    corner & 4 ? b.max.z : b.min.z);
        box.extendBy(V3f(similarity.point(p)));
    }
    const auto clip_from_world = clipFromWorld(rays, box, jitter);
    if (!clip_from_world) return;
    setUniform(program, "clip_from_world", *clip_from_world);
    setUniform(program, "clip_from_object", world_from_object * *clip_from_world);
    setUniform(program, "world_from_object", world_from_object);
    glUseProgram(program.id());
    glBindVertexArray(mesh->array.id());
    for (const Part& part : parts) {
        bindSurface(surfaces, program, material, part.surface);
        setUniform(program, "part_id", static_cast<double>(&part - parts.data() + 1));
        glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(part.count), GL_UNSIGNED_INT,
                       reinterpret_cast<const void*>(part.first * sizeof(std::uint32_t)));
    }
}

void Renderer::State::drawObject(const Program& program, const CameraRays& rays, const V2i& tile,
                                 const V2d& jitter) const {
    setUniform(program, "eye", rays.eye);
    if (mesh) return drawMesh(program, rays, jitter);
    bindSurface(surfaces, program, material, parts[0].surface);
    setUniform(program, "part_id", 1.0);
    drawSphere(program, rays, tile);
}

void Renderer::State::drawFarSide(const CameraRays& rays, const V2d& jitter) const {
    beginFarSide(*far_side);
    // Its pixels may be larger than the frame's.
    const V2d scale(static_cast<double>(options.width) / far_side->size.x,
                    static_cast<double>(options.height) / far_side->size.y);
    CameraRays coarse = rays;
    coarse.step_x *= scale.x;
    coarse.step_y *= scale.y;
    setView(far_side->program, coarse, (jitter - rays.centre) / scale);
    drawMesh(far_side->program, rays, jitter);
    endFarSide(*far_side);
}

// Adds the batch's lights to the object's samples: a full-screen pass behind nothing but them.
void Renderer::State::lightSurface(const CameraRays& rays, const V2i& tile, const V2d& jitter,
                                   int batch) const {
    setView(under_lights, rays, tile, jitter);
    lighting->setUniforms(under_lights, batch, jitter);
    for (GLuint i = 0; i < lit_points.size(); ++i)
        glBindTextureUnit(4 + i, lit_points[i].id());
    glDepthFunc(GL_GREATER);
    glDepthMask(GL_FALSE);
    glEnable(GL_BLEND);
    drawFullscreen(under_lights);
    glDisable(GL_BLEND);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LEQUAL);
}

// What the batch's lights are kept from shining on the ground, light by light where its map lies.
void Renderer::State::drawGroundShadow(const CameraRays& rays, const V2i& tile, const V2d& jitter,
                                       int batch) const {
    glBindFramebuffer(GL_FRAMEBUFFER, to_kept.id());
    const std::array<float, 4> nothing{};
    glClearBufferfv(GL_COLOR, 0, nothing.data());
    setView(ground_shadow, rays, tile, jitter);
    lighting->setUniforms(ground_shadow, batch, jitter);
    setUniform(ground_shadow, "eye", rays.eye);
    // Whatever box is before the eye: depth is not used.
    const V3f ahead(rays.eye + rays.forward);
    setUniform(ground_shadow, "clip_from_world", *clipFromWorld(rays, {ahead, ahead}, jitter));
    glEnable(GL_CLIP_DISTANCE0);
    glEnable(GL_BLEND);
    glUseProgram(ground_shadow.id());
    glBindVertexArray(no_vertices.id());
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, lighting->viewCount(batch));
    glDisable(GL_BLEND);
    glDisable(GL_CLIP_DISTANCE0);
    glBindTextureUnit(9, kept.id());
}

// One sample a pixel of a tile. `jitter` is the sample's place from the pixel's centre. The
// background comes last, at the far plane, so that it is looked up only where it is seen. Batches
// after the first add what their lights give, and no alpha.
void Renderer::State::drawSample(const CameraRays& rays, const V2i& tile, const V2d& jitter,
                                 int batch) const {
    glViewport(-tile.x, -tile.y, options.width, options.height);
    if (far_side) drawFarSide(rays, jitter);
    if (ground) drawGroundShadow(rays, tile, jitter, batch);
    glBindFramebuffer(GL_FRAMEBUFFER, to_sample.id());
    if (!background || batch > 0) {
        const V3f color_behind = batch > 0 ? V3f(0) : clear_color;
        const std::array<float, 4> color{color_behind.x, color_behind.y, color_behind.z,
                                         opaque && batch == 0 ? 1.f : 0.f};
        glClearBufferfv(GL_COLOR, 0, color.data());
    }
    const float far_depth = 1;
    glClearBufferfv(GL_DEPTH, 0, &far_depth);
    glEnable(GL_DEPTH_TEST);
    if (lit) glBindFramebuffer(GL_FRAMEBUFFER, to_points.id());
    glColorMaski(0, batch == 0, batch == 0, batch == 0, batch == 0);
    setView(surface, rays, tile, jitter);
    drawObject(surface, rays, tile, jitter);
    glColorMaski(0, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glBindFramebuffer(GL_FRAMEBUFFER, to_sample.id());
    if (lit) lightSurface(rays, tile, jitter, batch);
    if (background && (batch == 0 || ground)) {
        setView(background, rays, tile, jitter);
        setUniform(background, "tile_origin", tile);
        if (ground) lighting->setUniforms(background, batch, jitter);
        drawFullscreen(background);
    }
    glDisable(GL_DEPTH_TEST);
}

// All samples of a tile under all batches of lights; they end up in `sum`, or in `sample` when
// there is but one.
void Renderer::State::drawTile(const CameraRays& rays, const V2i& tile) {
    const int batches = lighting ? lighting->batchCount() : 1;
    bool first = true;
    for (int batch = 0; batch < batches; ++batch) {
        if (lighting) lighting->use(batch, mesh ? &*mesh : nullptr);
        for (const V2d& point : samplePattern(options.samples)) {
            glBindTextureUnit(0, probe.texture.id());
            drawSample(rays, tile, point - V2d(0.5), batch);
            if (!accumulate) return;
            glBindFramebuffer(GL_FRAMEBUFFER, to_sum.id());
            glBindTextureUnit(0, sample.id());
            if (!first) glEnable(GL_BLEND);
            drawFullscreen(accumulate);
            glDisable(GL_BLEND);
            first = false;
        }
    }
}

void Renderer::State::placeLights(const CameraRays& rays) {
    if (!lighting) return;
    if (ground && rays.eye.y <= ground->height)
        throw usage("the camera stands below the ground, which is seen from above; raise it");
    lighting->chooseLights(*light_scene, rays.eye);
    if (!ground) return;
    setUniform(background, "eye", rays.eye);
    setUniform(background, "ground_irradiance", lighting->groundIrradiance());
}

void Renderer::State::drawFrame(const Camera& camera, Image& frame) {
    const CameraRays rays = cameraRays(camera, options.width, options.height);
    placeLights(rays);
    const V2i size = tileSize();
    setUpDrawing(options.width);
    glBindTextureUnit(1, diffuse.texture.id());
    glBindTextureUnit(2, image.id());
    glBindTextureUnit(16, specular.id());
    glBindTextureUnit(17, split_sum.id());
    glBindTextureUnit(18, probe_levels.id());
    for (int y = 0; y < options.height; y += size.y) {
        for (int x = 0; x < options.width; x += size.x) {
            drawTile(rays, {x, y});
            glBindFramebuffer(GL_FRAMEBUFFER, to_mean.id());
            glViewport(0, 0, size.x, size.y);
            glBindTextureUnit(0, accumulate ? sum.id() : sample.id());
            drawFullscreen(resolve);
            glReadPixels(0, 0, std::min(size.x, options.width - x),
                         std::min(size.y, options.height - y), opaque ? GL_RGB : GL_RGBA, GL_FLOAT,
                         frame.at(x, y));
        }
    }
    checkGl("drawing the picture");
}

void Renderer::State::drawAovs(const Camera& camera, FrameAovs& aovs) {
    if (!aov) {
        aov = makeProgram(aovParts({mesh.has_value(), interpolation}, surfaceDefinitions()),
                          options.shader_folder);
    }
    const CameraRays rays = cameraRays(camera, options.width, options.height);
    const V2i size = tileSize();
    const Texture normals = makeTexture(GL_TEXTURE_2D, GL_RGBA32F, size.x, size.y);
    const Texture others = makeTexture(GL_TEXTURE_2D, GL_RG32F, size.x, size.y);
    const Framebuffer target = makeFramebuffer(normals, depth.id());
    glNamedFramebufferTexture(target.id(), GL_COLOR_ATTACHMENT1, others.id(), 0);
    const std::array<GLenum, 2> outputs{GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glNamedFramebufferDrawBuffers(target.id(), 2, outputs.data());
    setUpDrawing(options.width);
    const std::array<float, 4> nothing{0, 0, 0, 0}, far_away{kNoDepth, 0, 0, 0};
    const float far_depth = 1;
    for (int y = 0; y < options.height; y += size.y) {
        for (int x = 0; x < options.width; x += size.x) {
            glBindFramebuffer(GL_FRAMEBUFFER, target.id());
            glViewport(-x, -y, options.width, options.height);
            glClearBufferfv(GL_COLOR, 0, nothing.data());
            glClearBufferfv(GL_COLOR, 1, far_away.data());
            glClearBufferfv(GL_DEPTH, 0, &far_depth);
            glEnable(GL_DEPTH_TEST);
            setView(aov, rays, {x, y}, V2d(0));
            drawObject(aov, rays, {x, y}, V2d(0));
            glDisable(GL_DEPTH_TEST);
            const auto read = [&](GLenum output, GLenum format, float* to) {
                glReadBuffer(output);
                glReadPixels(0, 0, std::min(size.x, options.width - x),
                             std::min(size.y, options.height - y), format, GL_FLOAT, to);
            };
            const std::size_t first = static_cast<std::size_t>(y) * options.width + x;
            read(GL_COLOR_ATTACHMENT0, GL_RGB, aovs.normal.at(x, y));
            read(GL_COLOR_ATTACHMENT1, GL_RED, aovs.depth.data() + first);
            read(GL_COLOR_ATTACHMENT1, GL_GREEN, aovs.id.data() + first);
        }
    }
    checkGl("drawing normals, depth and ids");
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
    if (scene.interpolation == Interpolation::gouraud && !scene.material.own &&
        shaderInfo(scene.material.shader).lit) {
        throw usage("lights are summed in every pixel, not at vertices; take another "
                    "interpolation or shader");
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

Image Renderer::render(const Camera& camera) {
    Image frame(state_->options.width, state_->options.height, state_->opaque ? 3 : 4);
    state_->drawFrame(camera, frame);
    return frame;
}

LightCounts Renderer::lightCounts() const {
    return state_->lighting ? state_->lighting->counts() : LightCounts{};
}

FrameAovs Renderer::renderAovs(const Camera& camera) {
    const int width = state_->options.width, height = state_->options.height;
    const std::size_t pixels = static_cast<std::size_t>(width) * height;
    FrameAovs aovs{Image(width, height), std::vector<float>(pixels), std::vector<float>(pixels)};
    state_->drawAovs(camera, aovs);
    return aovs;
}

} // namespace ibl
