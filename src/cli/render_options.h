// Options of render by what they are of: camera, object, material, picture.
#pragma once

#include "cli/display_options.h"
#include "cli/session.h"

#include "lights/cut_lights.h"
#include "lights/scene_light.h"
#include "render/renderer.h"

#include <map>
#include <optional>
#include <string>

namespace ibl {

struct CameraArguments {
    std::optional<V3d> eye; ///< otherwise the orbit
    V3d target{0, 0, 0};
    V3d up{0, 1, 0};
    double azimuth = 0;
    double elevation = 0;
    double distance = 4;
    double fov = 40;
};
void bindCamera(CLI::App& app, CameraArguments& arguments);
Camera cameraOf(const CameraArguments& arguments);

struct ObjectArguments {
    std::string name = "sphere"; ///< built in, or a file
};
void bindObject(CLI::App& app, ObjectArguments& arguments);
/// Throws Error (usage) where there is no such object.
Object objectOf(Session& session, const ObjectArguments& arguments);

struct MaterialArguments {
    Shader shader = Shader::mirror;
    std::map<Parameter, V3d> values; ///< those given
};
/// `--shader` and an option for each row of parameterTable().
void bindMaterial(CLI::App& app, MaterialArguments& arguments);
/// Throws Error (usage) for a parameter that the shader does not have.
Material materialOf(const MaterialArguments& arguments);

struct PictureArguments {
    std::string background = "probe";
    FrameOptions frame;
    bool size_given = false;
};
/// `--size`, `--samples`, `--background`.
void bindPicture(CLI::App& app, PictureArguments& arguments);
Background backgroundOf(Session& session, const PictureArguments& arguments);

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
std::vector<SceneLight> lightsOf(Session& session, const LightArguments& arguments,
                                 const Panorama& probe);
std::optional<Ground> groundOf(const LightArguments& arguments, const Object& object);
Image plateOf(Session& session, const LightArguments& arguments);
void reportLights(Session& session, const LightCounts& counts);

} // namespace ibl
