// What a kernel carries from a texel or a direction into the pixels about it, by their edges.
#pragma once

#include "convolve/near_edges.h"

#include <vector>

namespace ibl {

/// A direction within a texel and its share in the texel's mean.
struct TexelPoint {
    V3d at;
    double share;
};

/// A texel's footprint.
struct Texel {
    V3d centre;
    double radius; ///< of the farthest corner, chord
    std::vector<Arc> outline;
    double solid_angle; ///< negative where the outline runs clockwise as seen from outside
    std::vector<TexelPoint> four, nine; ///< by products of Gauss rules
};

/// f's part of the mean over the texel of the kernel's mass over the pixel on its left.
double flowAcross(const NearField& field, Potential potential, const Texel& texel, const Arc& f);

/// The same of a direction alone, with Psi.
double flowAcross(const NearField& field, const V3d& x, const Arc& f);

} // namespace ibl
