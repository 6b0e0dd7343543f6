// A texel's value as a sum over pixels, for kernels that are not smooth over either.
//
// What is wanted of a texel T and every pixel P near it is G(T, P) = int_T int_P K. Where both are
// small beside their distance, K at a few points does. Nearer:
//
// - For a T that is not much larger than the kernel is wide, the kernel's mass over P is smooth
//   enough in T for Gauss points; about each of them the mass is a sum over P's edges (A of
//   edge_table.h).
// - For larger ones, with K = m delta + laplacian of Phi and Gauss's theorem in both T and P,
//
//       G(T, P) = m |T n P| - sum over edges e of T and f of P of (n_e . n_f) int_e int_f Phi,
//
//   n the outward normals: radiance flows from texel to texel across e, as much as the kernel
//   reaches over it, and f is where the radiance changes. The first term summed over pixels is the
//   area filter's. The inner integral is B of edge_table.h, the outer one Gauss points on e that
//   stand the closer the nearer f's ends are; what Phi is integrated over there is the kernel's
//   width, so however narrow it is the points are few.
//
// Both take great circles as straight, in the plane that touches the sphere at the point or at the
// middle of e.
#pragma once

#include "convolve/edge_table.h"
#include "convolve/narrow.h"
#include "convolve/texels.h"
#include "image/image.h"

#include <vector>

namespace ibl {

/// A kernel with what its weights are made from.
struct NearField {
    NearKernel kernel;
    EdgeTable table;
    int width; ///< of the probe
    int height;
};

NearField makeNearField(const NearKernel& kernel, int probe_width, int probe_height);

/// A texel is area * (its area-filtered value) + sum of weight * pixel.
struct NearWeights {
    double area = 0;
    int row = 0; ///< the first
    int rows = 0;
    int column = 0; ///< the first, perhaps below 0 or beyond the probe's width
    int columns = 0;
    std::vector<double> weight; ///< [rows][columns]
};

/// Of texel (x, y) of a map. The weights and `area` sum to the kernel's mass.
NearWeights nearWeights(const NearField& field, const MapExtent& map, int x, int y,
                        const Footprint& footprint);

} // namespace ibl
