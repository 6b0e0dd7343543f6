#include "render/camera.h"

#include "core/error.h"

#include <algorithm>
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

PixelRect unitSphereRect(const CameraRays& rays, int width, int height) {
    const V3d centre = -rays.eye;
    const double z = centre.dot(rays.forward);
    if (z < -1) return {{0, 0}, {0, 0}};
    PixelRect rect{{0, 0}, {width, height}};
    if (z * z <= 1.0001) return rect;
    // Along one axis of the picture: slopes t whose plane through the eye touches the sphere,
    // (x - t z)^2 = 1 + t^2, so t = (x z -+ sqrt(x^2 + z^2 - 1)) / (z^2 - 1).
    for (int axis = 0; axis < 2; ++axis) {
        const V3d& step = axis == 0 ? rays.step_x : rays.step_y;
        const double pixel = step.length();
        const double x = centre.dot(step) / pixel;
        const double root = std::sqrt(x * x + z * z - 1), scale = (z * z - 1) * pixel;
        const double low = rays.centre[axis] + (x * z - root) / scale;
        const double high = rays.centre[axis] + (x * z + root) / scale;
        const int limit = rect.max[axis];
        rect.min[axis] = static_cast<int>(std::clamp(std::floor(low) - 1, 0.0, double(limit)));
        rect.max[axis] = static_cast<int>(std::clamp(std::ceil(high) + 1, 0.0, double(limit)));
    }
    return rect;
}

} // namespace ibl
