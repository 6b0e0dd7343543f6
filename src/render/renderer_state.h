// What a Renderer holds, and the steps that set it up and draw with it. Internal to the render
// layer; renderer.cpp sets up, renderer_draw.cpp draws.
#pragma once

#include "render/far_side.h"
#include "render/lighting.h"
#include "render/mesh_buffers.h"
#include "render/panorama_texture.h"
#include "render/renderer.h"
#include "render/surface_textures.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace ibl {

using Imath::V2i;

struct Renderer::State {
    FrameOptions options;
    bool with_alpha = false; ///< the picture is read
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
    bool lit = false;                   ///< the material is
    bool lit_at_points = false;         ///< in a pass of its own (`under_lights`), not at vertices
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
    void lightSurface(const CameraRays& rays, const V2i& tile, const V2d& jitter) const;
    void drawGroundShadow(const CameraRays& rays, const V2i& tile, const V2d& jitter) const;
    void drawSample(const CameraRays& rays, const V2i& tile, const V2d& jitter,
                    const V2i& sample_of, int batch) const;
    void drawSphere(const Program& program, const CameraRays& rays, const V2i& tile) const;
    void drawObject(const Program& program, const CameraRays& rays, const V2i& tile,
                    const V2d& jitter) const;
    void drawMesh(const Program& program, const CameraRays& rays, const V2d& jitter) const;
    void drawParts(const Program& program) const;
    void drawFarSide(const CameraRays& rays, const V2d& jitter, const V2i& sample_of) const;
    void drawTile(const CameraRays& rays, const V2i& tile);
    void placeLights(const CameraRays& rays);
    void drawFrame(const Camera& camera, Image& frame);
    void drawAovs(const Camera& camera, FrameAovs& aovs);
};

} // namespace ibl
