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

/// The kernel's integral over the sphere.
double integral(const LobeFunction& lobe);

} // namespace ibl::oracle
