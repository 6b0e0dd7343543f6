// Draws one object under a probe, offscreen.
#pragma once

#include "image/image.h"
#include "panorama/panorama.h"
#include "render/camera.h"
#include "render/egl_context.h"
#include "render/mesh.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

namespace ibl {

/// How the surface answers the probe. L is the probe's radiance, E its irradiance, n the normal, r
/// the reflected ray, c the base colour, k the reflectivity.
enum class Shader {
    mirror,        ///< c L(r)
    diffuse,       ///< c E(n) / pi: c is the albedo
    mirrorDiffuse, ///< (1 - k) c E(n) / pi + k L(r)
};

/// A row for each shader: its name to users, and which maps it reads.
struct ShaderInfo {
    Shader shader;
    std::string_view name;
    std::string_view file; ///< in the shader folder
    bool reads_probe;
    bool reads_diffuse;
};
std::span<const ShaderInfo> shaderTable();
const ShaderInfo& shaderInfo(Shader shader);
std::optional<Shader> shaderFromName(std::string_view name);

struct Material {
    Shader shader = Shader::mirror;
    V3f base_color{1, 1, 1};
    float reflectivity = 0.5f; ///< of mirrorDiffuse, 0 to 1
};

/// What is seen beside the object.
struct ProbeBackground {};     ///< the probe itself
struct NoBackground {};        ///< nothing: the picture has premultiplied alpha
using ColorBackground = V3f;   ///< linear radiance
using ImageBackground = Image; ///< linear radiance, 3 channels, of the frame's own size
using Background = std::variant<ProbeBackground, NoBackground, ColorBackground, ImageBackground>;

/// All that is uploaded once and drawn from any number of cameras. What the picture does not need
/// may be absent: a diffuse object before no probe needs no probe, a mirror no diffuse map.
struct Scene {
    const Panorama* probe = nullptr;   ///< radiance
    const Panorama* diffuse = nullptr; ///< irradiance / pi, such as prefilter() gives
    Object object;
    Material material;
    Background background;
};

/// Whether the scene needs the probe's radiance, and its diffuse map, to be drawn.
bool needsProbe(const Material& material, const Background& background);
bool needsDiffuse(const Material& material);

struct FrameOptions {
    int width = 512;
    int height = 512;
    int samples = 16; ///< shaded samples a pixel; the picture is their mean (a box of one pixel)
    std::optional<std::filesystem::path> shader_folder; ///< replaces built-in shaders, file by file
};

/// A scene on the graphics device, ready to be drawn. The context must be current and outlive it.
///
/// Throws Error: usage for frames the device cannot draw (a side over its limit, samples < 1), for
/// a background image of another size and for a missing map; input for shaders from the folder that
/// do not compile, with file and line, and for probes larger than the device's textures.
class Renderer {
public:
    Renderer(const EglContext& context, const Scene& scene, const FrameOptions& options);
    ~Renderer();
    Renderer(Renderer&&) noexcept;
    Renderer& operator=(Renderer&&) noexcept;

    /// Scene-linear pixels: RGBA, premultiplied, when the scene has no background, otherwise RGB.
    Image render(const Camera& camera);

private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace ibl
