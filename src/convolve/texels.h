// The directions that an output's texels look along.
#pragma once

#include "panorama/panorama.h"

#include <cstdint>
#include <vector>

namespace ibl {

/// Lat-long points (u, v) of all texels of a map that have a direction, in the order of its pixels.
struct TexelPoints {
    std::vector<std::uint32_t> pixel; ///< index of the texel in the image
    std::vector<double> u;
    std::vector<double> v;
    std::vector<double> solid_angle;

    std::size_t size() const { return pixel.size(); }
};

TexelPoints texelPoints(const Panorama& map, int threads);

} // namespace ibl
