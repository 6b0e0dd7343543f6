// What the tests of the display chain share.
#pragma once

#include "scene_support.h"

#include "render/display_chain.h"

#include <cmath>
#include <vector>

namespace ibl {

inline Image shown(const DisplayOptions& options, Image picture, double exposure = 0,
                   int tile_edge = 4096) {
    DisplayChain(softwareContext(), options, std::nullopt, tile_edge).apply(picture, exposure);
    return picture;
}

inline Image displayed(ToneMap map, const ToneParameters& parameters, Per per, const Image& picture,
                       double exposure = 0) {
    DisplayOptions options;
    options.tone_map = map;
    options.parameters = parameters;
    options.per = per;
    return shown(options, picture, exposure);
}

/// A picture one pixel high, of greys.
inline Image row(const std::vector<float>& values) {
    Image picture(static_cast<int>(values.size()), 1);
    for (std::size_t i = 0; i < values.size(); ++i) {
        for (int c = 0; c < 3; ++c)
            picture.pixels[3 * i + static_cast<std::size_t>(c)] = values[i];
    }
    return picture;
}

inline Image flat(int width, int height, float value) {
    Image picture(width, height);
    for (float& v : picture.pixels)
        v = value;
    return picture;
}

inline double total(const Image& picture) {
    double sum = 0;
    for (const float v : picture.pixels)
        sum += v;
    return sum;
}

/// One axis of blurredExactly().
inline std::vector<double> axisBlurredExactly(const std::vector<double>& in, int n, int stride,
                                              int lines, int line_stride, double deviation) {
    std::vector<double> out(in.size());
    const int reach = static_cast<int>(6 * deviation) + 1;
    for (int line = 0; line < lines; ++line) {
        for (int i = 0; i < n; ++i) {
            double sum = 0, weights = 0;
            for (int k = -reach; k <= reach; ++k) {
                const double weight = std::exp(-0.5 * k * k / (deviation * deviation));
                int j = ((i + k) % (2 * n) + 2 * n) % (2 * n);
                if (j >= n) j = 2 * n - 1 - j;
                sum += weight * in[static_cast<std::size_t>(line * line_stride + j * stride)];
                weights += weight;
            }
            out[static_cast<std::size_t>(line * line_stride + i * stride)] = sum / weights;
        }
    }
    return out;
}

/// The oracle of blurs: a Gaussian's weights at every pixel, the picture going on as its mirror
/// image.
inline std::vector<double> blurredExactly(const std::vector<double>& picture, int width, int height,
                                          double deviation) {
    const auto across = axisBlurredExactly(picture, width, 1, height, width, deviation);
    return axisBlurredExactly(across, height, width, width, 1, deviation);
}

/// A scene of wide range: a gradient with a lamp of 1e4 and a dark corner.
inline Image lampScene(int width, int height) {
    Image picture(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const float ripple = 1 + 0.5F * std::sin(0.7F * static_cast<float>(x + 2 * y));
            const float base = std::exp2(static_cast<float>(x) / 10) * 0.02F * ripple;
            const bool lamp = std::hypot(x - 0.6 * width, y - 0.4 * height) < 4;
            for (int c = 0; c < 3; ++c)
                picture.at(x, y)[c] = lamp ? 1e4F : base * (1 + 0.3F * static_cast<float>(c));
        }
    }
    return picture;
}

} // namespace ibl
