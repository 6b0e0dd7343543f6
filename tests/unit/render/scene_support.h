// What the tests of drawing share.
#pragma once

#include "panorama/layouts.h"
#include "panorama/lookup.h"
#include "render/renderer.h"

#include <cmath>
#include <cstdint>
#include <optional>

namespace ibl {

/// One context for all tests of the program, of Mesa's rasteriser on every machine.
inline EglContext& softwareContext() {
    static EglContext context(DevicePreference::software);
    return context;
}

/// A probe of pixels that have nothing to do with their neighbours, 0.1 to 2.1.
inline Panorama noiseProbe(Layout layout, int width, int height) {
    Panorama probe{layout, Image(width, height)};
    std::uint32_t state = 1;
    for (float& value : probe.image.pixels) {
        state = state * 1664525u + 1013904223u;
        value = 0.1f + static_cast<float>(state >> 8) / 8388608.0f;
    }
    return probe;
}

inline Panorama constantProbe(float value) {
    Panorama probe{Layout::latlong, Image(8, 4)};
    for (float& v : probe.image.pixels)
        v = value;
    return probe;
}

inline V3d pixel(const Image& image, int x, int y) {
    const float* p = image.at(x, y);
    return {p[0], p[1], p[2]};
}

/// Where a ray first meets the unit sphere at the origin, from outside, by the quadratic formula.
inline std::optional<V3d> meetSphere(const V3d& eye, const V3d& direction) {
    const V3d d = direction.normalized();
    const double b = eye.dot(d), disc = b * b - (eye.length2() - 1);
    if (disc < 0 || b > 0) return std::nullopt;
    return eye + d * (-b - std::sqrt(disc));
}

inline V3d reflected(const V3d& d, const V3d& n) {
    return d - n * (2 * d.dot(n));
}

} // namespace ibl
