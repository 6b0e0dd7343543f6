// Draws one object under a probe, offscreen.
#pragma once

#include "image/image.h"
#include "render/camera.h"
#include "render/egl_context.h"
#include "render/scene.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ibl {

struct FrameOptions {
    int width = 512;
    int height = 512;
    int samples = 16; ///< shaded samples a pixel; the picture is their mean (a box of one pixel)
    std::optional<std::filesystem::path> shader_folder; ///< replaces built-in shaders, file by file
    /// Texels a side of shadow maps; 0: the power of two that is at least 3/4 of the frame's
    /// height, 256 to 2048; where only a ground is lit, not so large that the maps of up to 256
    /// lights take more than 256 MiB.
    int shadow_size = 0;
    bool matte = false; ///< pictures with a background have alpha, too
};

/// What is known of a frame beside its colours, at the centre of each pixel: nothing of it is
/// anti-aliased.
struct FrameAovs {
    Image normal;             ///< unit, in the world, turned to the eye; 0 where the object is not
    std::vector<float> depth; ///< along the view; kNoDepth where the object is not
    std::vector<float> id;    ///< the object's part, from 1; 0 where the object is not
};
constexpr float kNoDepth = 1e10F;

/// A scene on the graphics device, ready to be drawn. The context must be current and outlive it,
/// and so must a scene with lights.
///
/// Throws Error: usage for frames the device cannot draw (a side over its limit, samples < 1), for
/// a background image of another size, for a missing map, for lit materials and grounds without
/// lights and for a ground that cuts the object; input for shaders from the folder that do not
/// compile, with file and line, and for probes larger than the device's textures.
class Renderer {
public:
    Renderer(const EglContext& context, const Scene& scene, const FrameOptions& options);
    ~Renderer();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;

    /// Gives the scene other values of its shader's parameters, another turn of the probe and
    /// another place of the object, without another upload.
    void change(const Material& material, const Turn& turn, const Placement& placement);

    /// Scene-linear pixels: RGBA, premultiplied, when the scene has no background, otherwise RGB,
    /// or with `matte` RGBA, whose colours are whole and whose alpha is what it is without the
    /// background: 1 on the object, D / E by luminance on the ground, 0 elsewhere.
    /// Throws Error (usage) for a camera below the ground. The picture takes over the memory of
    /// `spare`, an earlier one that is no longer needed: the system clears new memory, page by
    /// page.
    Image render(const Camera& camera, Image spare = {});

    /// What became of the lights in the picture drawn last.
    LightCounts lightCounts() const;

    FrameAovs renderAovs(const Camera& camera);

    /// The uniforms of a user's own shader that nothing sets, in alphabetical order.
    std::vector<std::string> unsetUniforms() const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace ibl
