// The oracle of the convolution tests: plain loops, nothing shared with the engine.
#pragma once

#include "image/image.h"

#include <array>
#include <functional>
#include <vector>

namespace ibl::oracle {

/// A lobe as a function of the cosine, not normalised.
using LobeFunction = std::function<double(double cos_t)>;

LobeFunction lambert();
LobeFunction ggx(double roughness);
LobeFunction phong(double exponent);
LobeFunction blinnPhong(double exponent);
LobeFunction charlie(double roughness);

/// Gauss-Legendre points on [0, 1] and weights that sum to 1.
struct Rule {
    std::vector<double> x, w;
};
Rule gauss(int n);

struct Direction {
    double x, y, z;
};

/// The kernel-weighted mean of a lat-long probe about each direction, the probe constant over its
/// pixels. Every pixel's rectangle is integrated by n x n Gauss points in (longitude, cos theta), n
/// growing until the means move by less than `tolerance` of the largest of them. Divided by the
/// kernel's own integral, found by one-dimensional quadrature.
std::vector<std::array<double, 3>> convolve(const Image& probe, const LobeFunction& lobe,
                                            const std::vector<Direction>& directions,
                                            double tolerance = 1e-7);

/// The same for lobes much narrower than a pixel: rectangles are divided until they are smaller
/// than half their distance from the axis, or than `width`, over which the lobe is smooth; then 5 x
/// 5 Gauss points.
std::array<double, 3> convolveNarrow(const Image& probe, const LobeFunction& lobe, double width,
                                     const Direction& direction);

/// The kernel's integral over the sphere.
double integral(const LobeFunction& lobe);

/// Direction of the centre of texel (i, j) of face `face` (+X -X +Y -Y +Z -Z, OpenGL), or of the
/// point (i, j) in between, and its solid angle to first order.
Direction cubeDirection(int face, double i, double j, int edge);
double cubeWeight(double i, double j, int edge);

} // namespace ibl::oracle
