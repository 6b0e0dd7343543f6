// The conventions of the whole program, stated once.
//
// Space is right-handed, +Y up; pixels are scene-linear radiance.
//
// Lat-long. Pixel centres lie at ((i + 0.5) / W, (j + 0.5) / H); row 0 is at the +Y pole; the image
// centre looks along +Z, +X stands at a quarter of the width, -X at three quarters:
//
//     phi = 2 pi (0.5 - u), theta = pi v,
//     d = (sin theta sin phi, cos theta, sin theta cos phi).
//
// A pixel is an area: integrals take its radiance as constant over its rectangle, whose solid angle
// is dphi (cos theta_top - cos theta_bottom), so (phi, d.y) is an equal-area chart of the sphere.
//
// Cube faces are +X -X +Y -Y +Z -Z, each as OpenGL (and Vulkan, D3D, KTX, DDS) samples it: with
// s and t in [-1, 1], s to the right and t down the image, the face's texel looks along
//
//     +X ( 1, -t, -s)   -X (-1, -t,  s)
//     +Y ( s,  1,  t)   -Y ( s, -1, -t)
//     +Z ( s, -t,  1)   -Z (-s, -t, -1)
//
// (OpenGL 4.6 core, table 8.19, solved for the direction). A face is seen mirrored from inside;
// crosses are not: their cells are drawn as seen from inside, +Z in the middle, +Y above.
#pragma once

#include <Imath/ImathVec.h>

#include <cmath>
#include <numbers>

namespace ibl {

using Imath::V2d;
using Imath::V3d;

constexpr double kPi = std::numbers::pi;

/// Direction of the lat-long point (u, v), both in [0, 1].
inline V3d latlongDirection(double u, double v) {
    const double phi = 2 * kPi * (0.5 - u);
    const double theta = kPi * v;
    const double sin_theta = std::sin(theta);
    return {sin_theta * std::sin(phi), std::cos(theta), sin_theta * std::cos(phi)};
}

/// Lat-long point (u, v) of a direction of any length but 0; u in [0, 1], v in [0, 1]. At the poles
/// u is that of the +Z meridian. Exact near the poles, where acos(y) would not be.
inline V2d latlongPoint(const V3d& d) {
    const double phi = std::atan2(d.x, d.z);
    const double theta = std::atan2(std::hypot(d.x, d.z), d.y);
    return {0.5 - phi / (2 * kPi), theta / kPi};
}

/// Solid angle of each pixel of row j in a W x H lat-long image, steradians.
/// cos a - cos b is taken as 2 sin((a+b)/2) sin((b-a)/2), which keeps its precision at the poles.
inline double latlongPixelSolidAngle(int width, int height, int j) {
    return 2 * kPi / width * 2 * std::sin(kPi * (j + 0.5) / height) * std::sin(0.5 * kPi / height);
}

/// A point on the cube: face 0..5 (+X -X +Y -Y +Z -Z) and s, t in [-1, 1].
struct CubePoint {
    int face;
    double s;
    double t;
};

/// Direction (not normalised: its largest component is 1) of a point on the cube.
inline V3d cubeDirection(const CubePoint& p) {
    switch (p.face) {
    case 0:
        return {1, -p.t, -p.s};
    case 1:
        return {-1, -p.t, p.s};
    case 2:
        return {p.s, 1, p.t};
    case 3:
        return {p.s, -1, -p.t};
    case 4:
        return {p.s, -p.t, 1};
    default:
        return {-p.s, -p.t, -1};
    }
}

/// The point on the cube where a direction (any length but 0) leaves it.
inline CubePoint cubePoint(const V3d& d) {
    const double ax = std::abs(d.x), ay = std::abs(d.y), az = std::abs(d.z);
    if (ax >= ay && ax >= az) {
        return d.x > 0 ? CubePoint{0, -d.z / ax, -d.y / ax} : CubePoint{1, d.z / ax, -d.y / ax};
    }
    if (ay >= az) {
        return d.y > 0 ? CubePoint{2, d.x / ay, d.z / ay} : CubePoint{3, d.x / ay, -d.z / ay};
    }
    return d.z > 0 ? CubePoint{4, d.x / az, -d.y / az} : CubePoint{5, -d.x / az, -d.y / az};
}

/// Direction of the centre of texel (i, j) of an N x N face, not normalised.
inline V3d cubeTexelDirection(int face, int i, int j, int edge) {
    return cubeDirection({face, (2.0 * i + 1) / edge - 1, (2.0 * j + 1) / edge - 1});
}

/// A complex number whose argument is the solid angle of a rectangle on a cube face, exact: the
/// alternating sum over its corners of the integral of (1 + s^2 + t^2)^(-3/2), which is atan(s t /
/// sqrt(1 + s^2 + t^2)). The angles are added as the arguments of a product, which takes one arc
/// tangent.
inline V2d cubeRectangleProduct(double s0, double s1, double t0, double t1) {
    const double r00 = std::sqrt(s0 * s0 + t0 * t0 + 1), p00 = s0 * t0;
    const double r01 = std::sqrt(s0 * s0 + t1 * t1 + 1), p01 = s0 * t1;
    const double r10 = std::sqrt(s1 * s1 + t0 * t0 + 1), p10 = s1 * t0;
    const double r11 = std::sqrt(s1 * s1 + t1 * t1 + 1), p11 = s1 * t1;
    // (r00 + i p00) (r01 - i p01) and (r10 - i p10) (r11 + i p11).
    const double left_re = r00 * r01 + p00 * p01, left_im = p00 * r01 - r00 * p01;
    const double right_re = r10 * r11 + p10 * p11, right_im = r10 * p11 - p10 * r11;
    return {left_re * right_re - left_im * right_im, left_re * right_im + left_im * right_re};
}

/// Solid angle of a rectangle on a cube face, exact, steradians.
inline double cubeRectangleSolidAngle(double s0, double s1, double t0, double t1) {
    const V2d product = cubeRectangleProduct(s0, s1, t0, t1);
    return std::atan2(product.y, product.x);
}

/// Solid angle of texel (i, j) of an N x N cube face, exact, steradians.
inline double cubeTexelSolidAngle(int i, int j, int edge) {
    return cubeRectangleSolidAngle(2.0 * i / edge - 1, 2.0 * (i + 1) / edge - 1, 2.0 * j / edge - 1,
                                   2.0 * (j + 1) / edge - 1);
}

} // namespace ibl
