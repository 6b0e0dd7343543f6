// Options of render by what they are of: camera, object, material, picture.
#pragma once

#include "cli/display_options.h"
#include "cli/session.h"

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
};
/// `--size`, `--samples`, `--background`.
void bindPicture(CLI::App& app, PictureArguments& arguments);
Background backgroundOf(Session& session, const PictureArguments& arguments);

} // namespace ibl
