#include "render/renderer_state.h"

#include "core/error.h"
#include "render/sample_pattern.h"
#include "render/surface_program.h"
#include "render/uniforms.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace ibl {
namespace {

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
    drawParts(program);
}

void Renderer::State::drawParts(const Program& program) const {
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

void Renderer::State::drawFarSide(const CameraRays& rays, const V2d& jitter,
                                  const V2i& sample_of) const {
    beginFarSide(*far_side);
    // Its pixels may be larger than the frame's.
    const V2d scale(static_cast<double>(options.width) / far_side->size.x,
                    static_cast<double>(options.height) / far_side->size.y);
    CameraRays coarse = rays;
    coarse.step_x *= scale.x;
    coarse.step_y *= scale.y;
    setView(far_side->program, coarse, (jitter - rays.centre) / scale);
    setUniform(far_side->program, "sample_of", sample_of);
    drawMesh(far_side->program, rays, jitter);
    endFarSide(*far_side);
}

// Adds the sample's lights to the object's samples: a full-screen pass behind nothing but them.
void Renderer::State::lightSurface(const CameraRays& rays, const V2i& tile,
                                   const V2d& jitter) const {
    setView(under_lights, rays, tile, jitter);
    lighting->setUniforms(under_lights, jitter);
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

// What the sample's lights are kept from shining on the ground, light by light where its map lies.
void Renderer::State::drawGroundShadow(const CameraRays& rays, const V2i& tile,
                                       const V2d& jitter) const {
    glBindFramebuffer(GL_FRAMEBUFFER, to_kept.id());
    const std::array<float, 4> nothing{};
    glClearBufferfv(GL_COLOR, 0, nothing.data());
    setView(ground_shadow, rays, tile, jitter);
    lighting->setUniforms(ground_shadow, jitter);
    setUniform(ground_shadow, "eye", rays.eye);
    // Whatever box is before the eye: depth is not used.
    const V3f ahead(rays.eye + rays.forward);
    setUniform(ground_shadow, "clip_from_world", *clipFromWorld(rays, {ahead, ahead}, jitter));
    glEnable(GL_CLIP_DISTANCE0);
    glEnable(GL_BLEND);
    glUseProgram(ground_shadow.id());
    glBindVertexArray(no_vertices.id());
    glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, lighting->viewCount());
    glDisable(GL_BLEND);
    glDisable(GL_CLIP_DISTANCE0);
    glBindTextureUnit(9, kept.id());
}

// One sample a pixel of a tile: which of how many. `jitter` is its place from the pixel's centre.
// The background comes last, at the far plane, so that it is looked up only where it is seen.
// Batches after the first add what their lights give, and no alpha.
void Renderer::State::drawSample(const CameraRays& rays, const V2i& tile, const V2d& jitter,
                                 const V2i& sample_of, int batch) const {
    glViewport(-tile.x, -tile.y, options.width, options.height);
    if (far_side) drawFarSide(rays, jitter, sample_of);
    if (ground) drawGroundShadow(rays, tile, jitter);
    glBindFramebuffer(GL_FRAMEBUFFER, to_sample.id());
    if (!background || batch > 0) {
        const V3f color_behind = batch > 0 ? V3f(0) : clear_color;
        const std::array<float, 4> color{color_behind.x, color_behind.y, color_behind.z, 0};
        glClearBufferfv(GL_COLOR, 0, color.data());
    }
    const float far_depth = 1;
    glClearBufferfv(GL_DEPTH, 0, &far_depth);
    glEnable(GL_DEPTH_TEST);
    if (lit_at_points) glBindFramebuffer(GL_FRAMEBUFFER, to_points.id());
    const bool at_vertices = lit && !lit_at_points;
    if (at_vertices) lighting->setUniforms(surface, jitter);
    const GLboolean rgb = batch == 0 || at_vertices, alpha = batch == 0;
    glColorMaski(0, rgb, rgb, rgb, alpha);
    setView(surface, rays, tile, jitter);
    setUniform(surface, "sample_of", sample_of);
    drawObject(surface, rays, tile, jitter);
    glColorMaski(0, GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glBindFramebuffer(GL_FRAMEBUFFER, to_sample.id());
    if (lit_at_points) lightSurface(rays, tile, jitter);
    if (background && (batch == 0 || ground)) {
        setView(background, rays, tile, jitter);
        setUniform(background, "tile_origin", tile);
        if (ground) lighting->setUniforms(background, jitter);
        drawFullscreen(background);
    }
    glDisable(GL_DEPTH_TEST);
}

// All samples of a tile under all batches of lights; they end up in `sum`, or in `sample` when
// there is but one.
void Renderer::State::drawTile(const CameraRays& rays, const V2i& tile) {
    const int batches = lighting ? lighting->batchCount() : 1;
    const std::vector<V2d> pattern = samplePattern(options.samples);
    bool first = true;
    for (int batch = 0; batch < batches; ++batch) {
        if (lighting) lighting->use(batch, [this](const Program& p) { drawParts(p); });
        for (std::size_t i = 0; i < pattern.size(); ++i) {
            const bool any_light = lighting && lighting->useSample(static_cast<int>(i));
            if (batch > 0 && !any_light) continue;
            glBindTextureUnit(0, probe.texture.id());
            drawSample(rays, tile, pattern[i] - V2d(0.5), {static_cast<int>(i), options.samples},
                       batch);
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
        throw Error(
            ExitCode::usage,
            "render: the camera stands below the ground, which is seen from above; raise it");
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
                         std::min(size.y, options.height - y), with_alpha ? GL_RGBA : GL_RGB,
                         GL_FLOAT, frame.at(x, y));
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

} // namespace ibl
