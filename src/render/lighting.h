// The scene's lights on the device, with their shadow maps. Internal to the render layer.
#pragma once

#include "render/gl_objects.h"
#include "render/light_samples.h"
#include "render/scene.h"
#include "render/shadow_views.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace ibl {

/// Draws the object, in its own space, by a program that has all but the parts' uniforms.
using DrawCaster = std::function<void(const Program&)>;

/// Lights are drawn in batches of as many as the shaders' uniform blocks hold; light adds up, so
/// that a picture is the sum of its batches' pictures. A batch's maps are one texture array, made
/// anew for each batch, and kept where there is but one, from picture to picture while neither
/// lights nor object change. Each sample of a pixel has its own of the batch's lights
/// (light_samples.h).
class Lighting {
public:
    /// How many maps of that size a batch has at the most.
    static std::size_t mapsAtOnce(int map_size);

    /// The scene's object casts the shadows; the exact sphere needs no maps. `surfaces` are the
    /// definitions of the textures of its parts.
    /// Throws Error (input) where point or spot lights are among more lights than one batch holds.
    Lighting(const Scene& scene, const std::vector<std::string>& surfaces, int map_size,
             int samples, const std::optional<std::filesystem::path>& shader_folder);

    /// For every program that includes shaders/lights.glsl.
    std::vector<std::string> definitions() const;

    /// Where the object stands and how the probe, and directional lights with it, is turned.
    void place(const Scene& scene, const Turn& turn, const Similarity& similarity);
    /// Chooses the lights that show from there.
    void chooseLights(const Scene& scene, const V3d& eye);
    const LightCounts& counts() const { return counts_; }
    int batchCount() const { return static_cast<int>(batches_.size()); }
    /// Of the chosen lights: the irradiance of the ground without the object, of directional ones.
    const V3d& groundIrradiance() const { return ground_irradiance_; }

    /// Makes the batch the one that programs see; has `draw` draw the object into its maps where
    /// they are not there. Leaves the frame buffer's binding and the viewport changed.
    void use(int batch, const DrawCaster& draw);
    /// Brings the lights of one of a pixel's samples into the batch that is in use. False where it
    /// has none.
    bool useSample(int sample);
    /// Sets the uniforms of a program that includes shaders/lights.glsl, for the sample in use,
    /// which stands `jitter` from its pixel's centre.
    void setUniforms(const Program& program, const V2d& jitter) const;
    /// Maps of the sample's lights, and their size.
    int viewCount() const { return views_in_use_; }
    int mapSize() const { return map_size_; }

private:
    struct Batch {
        std::size_t first_light, lights, first_view, views;
    };

    void makeBatches();
    void uploadViews(const Batch& batch);
    void drawMaps(const Batch& batch, const DrawCaster& draw);

    bool local_ = false; ///< point or spot lights are among them
    bool placed_ = false;
    M33d probe_turn_;
    std::vector<SceneLight> turned_;
    Similarity similarity_;
    std::vector<V3f> points_; ///< of the mesh, in the world
    Caster caster_;
    bool maps_needed_; ///< the exact sphere has views, but no maps
    int map_size_;
    int samples_;
    std::vector<SceneLight> lights_;
    std::vector<std::vector<SampledLight>> of_samples_;
    LightCounts counts_;
    V3d ground_irradiance_{0};
    std::vector<ShadowView> views_;   ///< of all lights, one after the other
    std::vector<std::size_t> starts_; ///< each light's first, and the end
    std::vector<Batch> batches_;
    int in_use_ = -1;
    int lights_in_use_ = 0, views_in_use_ = 0;
    Program draw_depth_;
    Texture maps_;
    GLsizei layers_ = 0;
    Framebuffer to_layer_;
    Buffer light_block_, view_block_;
};

} // namespace ibl
