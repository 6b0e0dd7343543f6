// The turns and reflections that take a cube to itself, and which of a map's texels they exchange.
#pragma once

#include "convolve/texels.h"
#include "panorama/conventions.h"

#include <array>
#include <vector>

namespace ibl {

/// The axes in another order, some of them the other way round.
struct Symmetry {
    std::array<int, 3> axis;
    std::array<double, 3> sign;

    V3d operator()(const V3d& d) const {
        return {sign[0] * d[axis[0]], sign[1] * d[axis[1]], sign[2] * d[axis[2]]};
    }
    V3d back(const V3d& d) const {
        V3d result;
        for (int k = 0; k < 3; ++k)
            result[axis[k]] = sign[k] * d[k];
        return result;
    }
};

/// Those that take the image of a probe of that layout to itself, pixels to pixels, each face by
/// turns and reflections in the image. The first leaves all as it is. Not for latlong.
std::vector<Symmetry> symmetriesOf(Layout layout);

/// The texel whose weights are reckoned for another, y * width + x, and the symmetry that takes the
/// other to it.
struct Shared {
    int key = -1;
    int symmetry = 0;
};

/// The first texel that any symmetry takes this one to, which has a direction.
Shared sharedOf(const MapExtent& map, const std::vector<Symmetry>& symmetries, int x, int y);

} // namespace ibl
