// Where an object stands in the world.
#pragma once

#include "panorama/turn.h"
#include "render/mesh.h"

#include <Imath/ImathMatrix.h>

namespace ibl {

using Imath::M44d;

/// The object's points p stand at translate + scale * turn(p). With `fit` the object is brought
/// into the unit sphere first: the middle of its box to the origin, its farthest point to
/// distance 1.
struct Placement {
    V3d translate{0, 0, 0};
    Turn turn;
    double scale = 1; ///< above 0
    bool fit = false;

    bool operator==(const Placement&) const = default;
};

/// A placement as p' = p * turn * scale + shift (row vectors).
struct Similarity {
    M33d turn; ///< orthogonal
    double scale = 1;
    V3d shift{0, 0, 0};

    V3d point(const V3d& p) const { return p * turn * scale + shift; }
    bool operator==(const Similarity&) const = default;
};

/// Throws Error (usage) when the scale is not above 0 or anything is not finite.
Similarity similarityOf(const Placement& placement, const Extent& extent);

/// The same as a matrix for row vectors.
M44d matrixOf(const Similarity& similarity);

} // namespace ibl
