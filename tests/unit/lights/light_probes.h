// Probes that the tests of this layer share.
#pragma once

#include "image/image.h"
#include "panorama/conventions.h"

#include <algorithm>
#include <array>
#include <numbers>
#include <random>

namespace ibl {

inline Image filled(int width, int height, float value) {
    Image image(width, height, 3);
    std::fill(image.pixels.begin(), image.pixels.end(), value);
    return image;
}

inline void setPixel(Image& image, int x, int y, float r, float g, float b) {
    float* rgb = image.at(x, y);
    rgb[0] = r;
    rgb[1] = g;
    rgb[2] = b;
}

inline Image noise(int width, int height, unsigned seed) {
    Image image(width, height, 3);
    std::mt19937 random(seed);
    std::lognormal_distribution<float> value(0.f, 2.f);
    for (float& v : image.pixels)
        v = value(random);
    return image;
}

/// The probe's integral, summed in long double from solid angles taken as cosine differences.
inline std::array<long double, 3> integral(const Image& image) {
    std::array<long double, 3> sum{};
    const long double pi = std::numbers::pi_v<long double>;
    for (int j = 0; j < image.height; ++j) {
        const long double omega =
            2 * pi / image.width *
            (std::cos(pi * j / image.height) - std::cos(pi * (j + 1) / image.height));
        for (int i = 0; i < image.width; ++i) {
            for (int c = 0; c < 3; ++c)
                sum[c] += omega * image.at(i, j)[c];
        }
    }
    return sum;
}

} // namespace ibl
