// Where in a pixel its samples lie.
#pragma once

#include <Imath/ImathVec.h>

#include <vector>

namespace ibl {

using Imath::V2d;

/// `count` points in the unit square, the same on every call: a latin square, so that each of the
/// `count` columns and of the `count` rows of the square holds the centre of one point (an edge
/// along either axis shows all its levels, and the points' mean is the pixel's centre), in the
/// order of the golden-ratio sequence, which spreads them evenly over the square too. One point is
/// the centre.
std::vector<V2d> samplePattern(int count);

} // namespace ibl
