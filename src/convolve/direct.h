// The direct sum: a lobe's mean over the probe with no part of it in harmonics, in double
// precision.
//
// The probe is constant over its pixels, so the integral of K L is a sum over the edges between
// pixels of the radiance's step times the integral of K on one side, and Green's theorem turns that
// into an integral along the edge (edges.h). It is exact for lobes much narrower than a pixel, and
// slow: the reference quality and the tests use it.
#pragma once

#include "convolve/edges.h"
#include "convolve/lobe.h"
#include "image/image.h"

namespace ibl {

/// A lobe as a function for edges.h: Q(h) = M(t) - M(pi), M its mass within t of the axis and
/// h = sin^2(t/2).
struct DirectLobe {
    LobeMassBeyond mass_beyond;
    Disc disc; ///< where Q is not zero

    double operator()(double h) const;
};

DirectLobe makeDirectLobe(const Lobe& lobe);

/// Adds (K * L) in the direction of the axis, L the probe times `scale`: sum[c], c < 3.
void addDirect(const DirectLobe& lobe, const Image& probe, double scale, const Axis& axis,
               double* sum);

} // namespace ibl
