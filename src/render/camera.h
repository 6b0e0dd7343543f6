// The pinhole camera.
#pragma once

#include <Imath/ImathVec.h>

namespace ibl {

using Imath::V2d;
using Imath::V2i;
using Imath::V3d;

/// Looks from `eye` to `target`, `up` upwards in the picture.
struct Camera {
    V3d eye{0, 0, 4};
    V3d target{0, 0, 0};
    V3d up{0, 1, 0};
    double fov = 40; ///< vertical, degrees, between the frame's upper and lower edge
};

/// The camera on a sphere about `target`, angles in degrees:
/// eye = target + distance (cos el sin az, sin el, cos el cos az), +Y up. At the poles, where +Y is
/// the direction of view, up is the limit of the same orbit: -(sin az, 0, cos az) at elevation 90.
Camera orbitCamera(double azimuth, double elevation, double distance, const V3d& target,
                   double fov);

/// Rays through a frame: pixel coordinates (x right, y down, centres at +0.5) give the direction
/// `forward + (x - centre.x) step_x + (y - centre.y) step_y`, whose part along the view is 1.
struct CameraRays {
    V3d eye;
    V3d forward;
    V3d step_x;
    V3d step_y;
    V2d centre;

    V3d direction(double x, double y) const {
        return forward + step_x * (x - centre.x) + step_y * (y - centre.y);
    }
};

/// A rectangle of a frame, in pixels; empty when max <= min.
struct PixelRect {
    V2i min;
    V2i max;
};

/// The pixels of the frame that the unit sphere at the origin may touch, samples anywhere in a
/// pixel included: the whole frame when the eye's plane cuts the sphere, none when it lies behind.
PixelRect unitSphereRect(const CameraRays& rays, int width, int height);

/// Rays of a width x height frame of square pixels.
/// Throws Error (usage) when the camera has no picture: eye at target, up along the view or zero,
/// fov not in (0, 180), anything not finite.
CameraRays cameraRays(const Camera& camera, int width, int height);

} // namespace ibl
