#include "cli/render_options.h"

#include "core/error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

namespace ibl {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// By its name, or by its number in the file.
Camera cameraOfFile(const std::string& wanted, const std::vector<NamedCamera>& cameras) {
    for (const NamedCamera& camera : cameras) {
        if (camera.name == wanted) return camera.camera;
    }
    std::size_t index = 0;
    const char* end = wanted.data() + wanted.size();
    const auto [last, problem] = std::from_chars(wanted.data(), end, index);
    const auto numbered = std::ranges::find(cameras, index, &NamedCamera::number);
    if (problem == std::errc() && last == end && numbered != cameras.end()) return numbered->camera;
    std::string names;
    for (const NamedCamera& camera : cameras) {
        names += (names.empty() ? "" : ", ") + std::to_string(camera.number);
        if (!camera.name.empty()) names += " (" + camera.name + ")";
    }
    throw Error(ExitCode::usage,
                "--camera " + wanted + ": the object's file has no such camera; " +
                    (cameras.empty() ? "it has none, give --eye or an orbit" : "it has " + names));
}

} // namespace

Camera cameraOf(const CameraArguments& a, const FramePlace& place, const FrameOptions& frame,
                const std::vector<NamedCamera>& of_file) {
    if (!a.of_file.empty()) return cameraOfFile(a.of_file, of_file);
    double fov = a.fov.at(place);
    if (a.focal_length) { // the sensor is as high as the picture is
        const double height = a.sensor * frame.height / frame.width;
        fov = 2 * std::atan(height / (2 * a.focal_length->at(place))) * kDegrees;
    }
    if (a.eye) return {*a.eye, a.target, a.up, fov};
    return orbitCamera(a.azimuth.at(place), a.elevation.at(place), a.distance.at(place), a.target,
                       fov);
}

void bindCamera(CLI::App& app, CameraArguments& arguments, FrameRange& frames) {
    const double above_zero = std::numeric_limits<double>::min();
    CLI::Option* of_file =
        app.add_option("--camera", arguments.of_file,
                       "Camera of the glTF file that is the object: its name, or its number from 0")
            ->type_name("NAME|N")
            ->group("Camera");
    CLI::Option* eye = app.add_option_function<std::vector<double>>(
                              "--eye",
                              [&arguments](const std::vector<double>& v) {
                                  arguments.eye = V3d(v[0], v[1], v[2]);
                              },
                              "Where the camera stands")
                           ->delimiter(',')
                           ->expected(3)
                           ->excludes(of_file)
                           ->type_name("X,Y,Z")
                           ->group("Camera");
    addTriple(app, "--target", arguments.target, "Where it looks (default 0,0,0)")
        ->excludes(of_file)
        ->group("Camera");
    addTriple(app, "--up", arguments.up, "What is up in the picture (default 0,1,0)")
        ->needs(eye)
        ->group("Camera");
    const auto ramp = [&](const char* name, Ramp& value, double least, double most,
                          const char* help) {
        return addRamp(app, name, value, help, rampIn(least, most), frames)
            ->excludes(of_file)
            ->type_name("DEG")
            ->group("Camera");
    };
    ramp("--azimuth", arguments.azimuth, -1e6, 1e6,
         "Camera's longitude about the target, 0 (default) at +Z, 90 at +X")
        ->excludes(eye);
    ramp("--elevation", arguments.elevation, -90, 90, "Its latitude, -90 to 90 (default 0)")
        ->excludes(eye);
    ramp("--distance", arguments.distance, above_zero, 1e9,
         "Its distance from the target (default 4)")
        ->excludes(eye)
        ->type_name("D");
    CLI::Option* fov = ramp("--fov", arguments.fov, above_zero, 179.999,
                            "Vertical field of view, above 0 and below 180 (default 40)");
    CLI::Option* focal = addRamps(
        app, "--focal-length", 1,
        [&arguments](const std::vector<Ramp>& v) { arguments.focal_length = v[0]; },
        "Focal length in millimetres, instead of the field of view", rampIn(1e-3, 1e6), frames);
    focal->excludes(fov)->excludes(of_file)->type_name("MM")->group("Camera");
    app.add_option("--sensor", arguments.sensor,
                   "Width of the sensor in millimetres (default 36, full frame)")
        ->check(inRange(1e-3, 1e6))
        ->needs(focal)
        ->type_name("MM")
        ->group("Camera");
}

void bindTurn(CLI::App& app, TurnArguments& arguments, FrameRange& frames) {
    const auto ramp = [&](const char* name, Ramp& value, const char* help) {
        addRamp(app, name, value, help, rampIn(-1e6, 1e6), frames)
            ->type_name("DEG")
            ->group("Input");
    };
    ramp("--yaw", arguments.yaw, "Turn the probe about +Y: 90 takes +Z to +X");
    ramp("--pitch", arguments.pitch, "Turn it about +X, ahead of the yaw");
    ramp("--roll", arguments.roll, "Turn it about +Z, ahead of the pitch");
    app.add_flag("--mirror", arguments.mirror, "Negate its x ahead of all turns")->group("Input");
}

Turn turnOf(const TurnArguments& a, const FramePlace& place) {
    return {a.yaw.at(place), a.pitch.at(place), a.roll.at(place), a.mirror};
}

} // namespace ibl
