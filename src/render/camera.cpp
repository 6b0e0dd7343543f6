#include "render/camera.h"

#include "core/error.h"

#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr double kRadians = std::numbers::pi / 180;

bool isFinite(const V3d& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

Error cameraError(const char* problem) {
    return {ExitCode::usage, std::string("camera: ") + problem};
}

} // namespace

Camera orbitCamera(double azimuth, double elevation, double distance, const V3d& target,
                   double fov) {
    const double az = azimuth * kRadians, el = elevation * kRadians;
    const V3d outward(std::cos(el) * std::sin(az), std::sin(el), std::cos(el) * std::cos(az));
    // The derivative of the orbit by elevation: perpendicular to the view everywhere, where +Y is
    // so only at the equator. In the picture it is +Y projected, up to |elevation| 90, and it goes
    // on without a step beyond.
    const V3d northward(-std::sin(el) * std::sin(az), std::cos(el), -std::sin(el) * std::cos(az));
    return {target + outward * distance, target, northward, fov};
}

CameraRays cameraRays(const Camera& camera, int width, int height) {
    if (!isFinite(camera.eye) || !isFinite(camera.target) || !isFinite(camera.up)) {
        throw cameraError("a coordinate is not finite; give finite eye, target and up");
    }
    if (!(camera.fov > 0 && camera.fov < 180)) {
        throw cameraError("the field of view is not between 0 and 180 degrees; give one that is");
    }
    const V3d view = camera.target - camera.eye;
    if (!(view.length() > 0)) {
        throw cameraError("eye and target are the same point; move one of them");
    }
    const V3d forward = view.normalized();
    const V3d right = forward.cross(camera.up.normalized());
    if (!(right.length() > 1e-9)) {
        throw cameraError("up is zero or along the view; give another up vector");
    }
    const V3d unit_right = right.normalized();
    const V3d up = unit_right.cross(forward);
    const double pixel = 2 * std::tan(0.5 * camera.fov * kRadians) / height;
    return {camera.eye, forward, unit_right * pixel, up * -pixel, {0.5 * width, 0.5 * height}};
}

} // namespace ibl
