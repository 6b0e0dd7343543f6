// Options of render by what they are of: camera, object, material, picture.
#pragma once

#include "cli/display_options.h"
#include "cli/frame_range.h"
#include "cli/session.h"

#include "lights/cut_lights.h"
#include "lights/scene_light.h"
#include "render/defocus.h"
#include "render/object_file.h"
#include "render/renderer.h"

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ibl {

struct CameraArguments {
    std::optional<V3d> eye; ///< otherwise the orbit
    V3d target{0, 0, 0};
    V3d up{0, 1, 0};
    Ramp azimuth = 0;
    Ramp elevation = 0;
    Ramp distance = 4;
    Ramp fov = 40;
    std::optional<Ramp> focal_length; ///< millimetres, instead of the field of view
    double sensor = 36;               ///< its width
    std::string of_file; ///< name or number of a camera of the object's file, instead of all that
};
void bindCamera(CLI::App& app, CameraArguments& arguments, FrameRange& frames);
/// The camera at a frame of that size. Throws Error (usage) for a camera that the file lacks.
Camera cameraOf(const CameraArguments& arguments, const FramePlace& place,
                const FrameOptions& frame, const std::vector<NamedCamera>& of_file);

/// Depth of field.
struct LensArguments {
    Ramp aperture = 0;         ///< diameter in scene units
    std::optional<Ramp> focus; ///< distance along the view, otherwise the target's

    bool blurs(const FramePlace& place) const { return aperture.at(place) > 0; }
};
void bindLens(CLI::App& app, LensArguments& arguments, FrameRange& frames);
/// Refuses a focus without a lens, and a lens without a focus.
void requireLens(const LensArguments& lens, const CameraArguments& camera);
/// Puts a scene-linear picture out of focus where the lens does.
void throughLens(const EglContext& context, const LensArguments& arguments, const FramePlace& place,
                 const Camera& camera, const FrameOptions& options,
                 const std::optional<Ground>& ground, const FrameAovs& aovs, int threads,
                 Image& picture);

struct ObjectArguments {
    std::string name = "sphere"; ///< built in, or a file
    std::string base_texture;    ///< file
    std::array<Ramp, 3> translate{0, 0, 0};
    std::array<Ramp, 3> rotate{0, 0, 0}; ///< degrees about x, y and z
    Ramp scale = 1;
    bool fit = false;
};
void bindObject(CLI::App& app, ObjectArguments& arguments, FrameRange& frames);
Placement placementOf(const ObjectArguments& arguments, const FramePlace& place);
/// The object of that name, the arguments' own or a frame's, with the base texture. Throws
/// inputError where there is no such object.
ObjectFile objectOf(Session& session, const ObjectArguments& arguments, const std::string& name);

struct TurnArguments {
    Ramp yaw = 0;
    Ramp pitch = 0;
    Ramp roll = 0;
    bool mirror = false;
};
void bindTurn(CLI::App& app, TurnArguments& arguments, FrameRange& frames);
Turn turnOf(const TurnArguments& arguments, const FramePlace& place);

struct DeviceArguments {
    bool software = false;
    std::optional<int> number; ///< of eglDevices(); none: hardware first
};
void bindDevice(CLI::App& app, DeviceArguments& arguments);
EglContext contextOf(const DeviceArguments& arguments);

struct MaterialArguments {
    std::string shader = "mirror";                   ///< a row's name, or a file
    std::map<Parameter, std::array<Ramp, 3>> values; ///< those given
    std::optional<int> samples;
    std::optional<bool> multiscatter;
    std::optional<Masking> masking;
    Interpolation interpolation = Interpolation::phong;
};
/// `--shader`, an option for each row of parameterTable(), `--samples-specular`, `--multiscatter`,
/// `--masking`, `--interpolation`.
void bindMaterial(CLI::App& app, MaterialArguments& arguments, FrameRange& frames);
/// The user's own shader, if `--shader` names a file. Throws Error (input) where it cannot be read.
std::optional<ShaderText> ownShader(Session& session, const MaterialArguments& arguments);
/// Throws Error (usage) for a parameter that the shader does not have.
Material materialOf(const MaterialArguments& arguments, const std::optional<ShaderText>& own,
                    const FramePlace& place);
/// Takes from the object's parts what the arguments give otherwise: metallic and roughness.
void overrideSurfaces(const MaterialArguments& arguments, Object& object);
/// Whether parts of the object say how rough or metallic they are.
bool surfacesVary(const Object& object);

struct MapArguments {
    std::string diffuse, specular; ///< files made earlier
};
/// `--diffuse-map` and `--specular-map`.
void bindMaps(CLI::App& app, MapArguments& arguments);

/// The maps that a picture needs; the others are empty.
struct RenderMaps {
    Panorama probe, diffuse;
    SpecularMaps specular;
    Image split_sum;
    std::vector<Panorama> probe_levels;

    /// Puts them into the scene, which refers to them.
    void show(Scene& scene) const;
};
/// Reads and computes them for the scene's material and background; `probe_needed`: the probe in
/// any case. Throws Error (usage) for files that the material does not read.
RenderMaps prepareMaps(Session& session, const ProbeOptions& probe, const MapArguments& arguments,
                       const Scene& scene, bool probe_needed);

struct PictureArguments {
    std::string background = "probe";
    FrameOptions frame;
    bool size_given = false;
    std::vector<std::string> aovs; ///< normal, depth, id
};
/// `--size`, `--samples`, `--background`, `--aov`.
void bindPicture(CLI::App& app, PictureArguments& arguments);
/// The channels that `--aov` asks for.
std::vector<ExtraChannel> aovChannels(const PictureArguments& arguments, FrameAovs aovs);
/// Takes alpha out of the picture, as the channel `matte.A`. Were it the picture's own, whose
/// background is whole, readers would divide the colours by it.
ExtraChannel takeMatte(Image& picture);
/// The background of that name: the arguments' own, or a frame's.
Background backgroundOf(Session& session, const std::string& name);

struct LightArguments {
    std::string lights; ///< a number, a file, or nothing
    std::optional<LightMethod> method;
    std::optional<int> shadow_size;
    bool ground = false;
    std::optional<double> ground_height;
    std::optional<V3d> ground_albedo;
    std::string plate;
};
/// `--lights`, `--light-method`, `--shadow-size`, `--ground`, `--ground-height`, `--ground-albedo`,
/// `--plate`; after bindPicture().
void bindLightOptions(CLI::App& app, LightArguments& arguments);
/// Throws Error (usage) for lights that light nothing, for what needs lights and has none, and for
/// a number that is none of lights; for an albedo of the ground where nothing is behind it.
void requireLightUse(const LightArguments& arguments, const Material& material,
                     const PictureArguments& picture);
/// Whether `--lights` asks for as many lights cut from the probe, and names no file.
bool isLightCount(const std::string& text);
/// The lights of that number or file: the arguments' own or a frame's.
std::vector<SceneLight> lightsOf(Session& session, const LightArguments& arguments,
                                 const std::string& name, const Panorama& probe);
/// Where nothing else is told it lies under the object as it stands.
std::optional<Ground> groundOf(const LightArguments& arguments, const Scene& scene);
void reportLights(Session& session, const LightCounts& counts);

} // namespace ibl
