// Probes that the tests of this layer share.
#pragma once

#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/panorama.h"

#include <array>
#include <random>

namespace ibl::test {

constexpr std::array<Layout, 11> kAllLayouts{
    Layout::angular, Layout::mirrorBall, Layout::octahedral, Layout::latlong,
    Layout::faces,   Layout::vcross,     Layout::hcross,     Layout::strip,
    Layout::vstrip,  Layout::exrLatlong, Layout::exrCube};

inline V3d pixel(const Panorama& p, int x, int y) {
    const float* v = p.image.at(x, y);
    return {v[0], v[1], v[2]};
}

/// f at the direction of every pixel's centre; 0 where a cross has no face.
template <class F>
Panorama filled(Layout layout, int width, int height, F f) {
    Panorama p{layout, Image(width, height)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto d = texelDirection(layout, width, height, x + 0.5, y + 0.5);
            const V3d value = d ? f(*d) : V3d(0);
            for (int c = 0; c < 3; ++c)
                p.image.at(x, y)[c] = static_cast<float>(value[c]);
        }
    }
    return p;
}

inline Panorama noise(Layout layout, int width, int height, unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> value(0, 1);
    return filled(layout, width, height,
                  [&](const V3d&) { return V3d(value(random), value(random), value(random)); });
}

/// Sum of radiance times solid angle.
inline V3d energy(const Panorama& p) {
    V3d sum(0);
    for (int y = 0; y < p.image.height; ++y) {
        for (int x = 0; x < p.image.width; ++x) {
            sum += pixel(p, x, y) * texelSolidAngle(p.layout, p.image.width, p.image.height, x, y);
        }
    }
    return sum;
}

/// The largest difference of two images of one extent.
inline double largestDifference(const Image& a, const Image& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        largest = std::max(largest, std::abs(static_cast<double>(a.pixels[i]) - b.pixels[i]));
    }
    return largest;
}

} // namespace ibl::test
