// A map's texels as kernels meet them: outlines and points.
#pragma once

#include "convolve/near_flow.h"

#include <vector>

namespace ibl {

/// The points of texel (x, y)'s footprint.
std::vector<TexelPoint> pointsOf(const MapExtent& map, int x, int y, const Footprint& footprint);

/// The footprint of that scale, its outline in pieces of about `longest` radians; the whole sphere
/// has none.
Texel texelOf(const MapExtent& map, int x, int y, double scale, double longest = kLongest);

/// What pieces of pixels' outlines carry to a texel's footprint: by its outline, or where that is
/// small (leastOutline) by points.
class Flow {
public:
    Flow(const NearField& field, const MapExtent& map, int x, int y, const Footprint& footprint,
         const Texel& texel, Potential potential);

    /// That piece's part of the mean over the footprint of the kernel's mass over what is on its
    /// left.
    double across(const Arc& f) const;

private:
    const NearField& field_;
    const Texel& texel_;
    Potential potential_;
    std::vector<TexelPoint> points_;
};

} // namespace ibl
