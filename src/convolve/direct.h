// The direct sum: a lobe's mean over the probe with no part of it in harmonics, in double
// precision.
//
// A pixel's share is the lobe's mass over its rectangle: by Gauss points where the lobe is smooth
// over the pixel, by its edges (edges.h) near the axis and the horizon, where it is not, so lobes
// may be much narrower than a pixel. The reference quality and the tests use it.
#pragma once

#include "convolve/edges.h"
#include "convolve/lobe.h"
#include "image/image.h"

#include <array>
#include <vector>

namespace ibl {

/// n x n Gauss points over each pixel of a lat-long, in (psi, theta), as a product: rows * n
/// colatitudes and columns * n azimuths.
struct PixelPointGrid {
    int n = 0;
    std::vector<double> sine, cosine; ///< of theta
    std::vector<double> weight;       ///< of theta and psi; a pixel's sum to its solid angle
    std::vector<double> psi_sine, psi_cosine;
    std::vector<double> psi_weight; ///< of the rule alone, n of them, summing to 1
};

/// A lobe and the probe that it is to be summed over; the probe must outlive it.
struct DirectSum {
    const Image& probe;
    double scale; ///< of the probe's values
    Lobe lobe;
    LobeMassBeyond mass_beyond;
    double width; ///< lobeWidth
    double norm;  ///< 1 / integral of the lobe
    Disc disc;    ///< where the lobe is not zero,
    double begin; ///< but for what is nearer to its axis
    PixelPointGrid coarse, fine;
};

DirectSum makeDirectSum(const Lobe& lobe, const Image& probe, double scale);

/// Adds (K * L) in the direction of the axis, L the probe times its scale: sum[c], c < 3.
void addDirect(const DirectSum& direct, const Axis& axis, double* sum);

} // namespace ibl
