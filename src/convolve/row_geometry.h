// Angles of many places at once, in vectors.
#pragma once

#include "panorama/conventions.h"

#include <cstddef>

namespace ibl {

/// latlongPoint (conventions.h) of `n` polar directions (peaks.h), to 4e-16; on the seam u is 0.
void latlongPoints(const V3d* direction, std::size_t n, double* u, double* v);

/// cubeTexelSolidAngle of the texels (0 .. edge - 1, j) of a face, steradians.
void faceRowSolidAngles(int edge, int j, double* solid_angle);

} // namespace ibl
