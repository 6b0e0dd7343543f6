// A texel's value as a sum over pixels, for kernels that are not smooth over either.
//
// What is wanted of a texel T and every pixel P near it is G(T, P) = int_T int_P K. Where both are
// small beside their distance, K at a few points does. Nearer, with a potential of K Gauss's
// theorem in both T and P leaves their outlines alone (Neumann's formula for inductances):
//
//     Phi' = -(m - M) / (2 pi sin t),         laplacian of Phi = K - m delta,
//     G(T, P) = m |T n P| - oint_dT oint_dP Phi dx . dy;
//     Psi' = (M - m sin^2(t/2)) / (2 pi sin t),   laplacian of Psi = K - m / (4 pi),
//     G(T, P) = m |T| |P| / (4 pi) - oint_dT oint_dP Psi dx . dy,
//
// M(t) the kernel's mass within t, m all of it. It holds on the sphere as it stands. Phi ends with
// the kernel, and of kernels narrower than the texel only what is beside both outlines counts: its
// first term summed over pixels is the area filter's. Psi is smooth over the kernel's width, so it
// serves the shrunk footprints that wider kernels have. For very small footprints the kernel's mass
// over P is taken at points x,
//
//     G(x, P) = m |P| / (4 pi) + oint_dP (M - m sin^2(t/2)) dchi / (2 pi).
//
// Pieces of outlines that are short beside what lies between them are met by Gauss points, others
// are halved; what touches is met in a plane (edge_table.h).
#pragma once

#include "convolve/edge_table.h"
#include "convolve/narrow.h"
#include "convolve/peaks.h"
#include "convolve/radial_table.h"
#include "convolve/texels.h"
#include "image/image.h"

#include <algorithm>
#include <numbers>
#include <span>
#include <vector>

namespace ibl {

/// Phi or Psi.
enum class Potential { withoutArea, withArea };

/// How exactly weights are made.
struct NearRules {
    double far;   ///< pixels this many times the texel's and the pixel's extent away: by points
    double two;   ///< pieces this many times their length apart: by two points each,
    double three; ///< or by three
    double flat;  ///< longest piece that counts as straight, radians,
    double bend;  ///< if its middle is not farther from its chord than this of its length
    double nodes; ///< of the table, to a unit of its logarithms
    double error; ///< relative RMSE that they leave
};

/// The quickest rules that leave at most 0.6 of `max_error`, or the most exact ones.
const NearRules& nearRules(double max_error);

/// A kernel with what its weights are made from. Tables are of the squared chord.
struct NearField {
    NearKernel kernel;
    NearRules rules;
    RadialTable value, phi, psi;
    RadialTable swirl;       ///< (M - m sin^2(t/2)) / (2 pi sin^2 t)
    RadialTable outer_swirl; ///< (M - m) / (2 pi sin^2 t)
    EdgeTable table;
    /// A ring along the horizon (Charlie): the chord at which it begins, and half of the chord over
    /// which it varies; 0 where there is none.
    double ring_from, ring_room;
    int width; ///< of the probe
    int height;
};

/// Beside which length, by the rules, two things must be short whose middles are `between` apart
/// and that reach `half` from there together: where a lobe is a ring, about the ring's width or
/// what lies between them and it, otherwise any.
inline double roomBesideRing(const NearField& field, double between, double half) {
    if (field.ring_room == 0) return 1e3;
    const double before = field.ring_from - (between + half);
    const double behind = between - half - std::numbers::sqrt2;
    return std::max({before, behind, 0.0}) + field.ring_room;
}

NearField makeNearField(const NearKernel& kernel, const NearRules& rules, int probe_width,
                        int probe_height, int threads);

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
                        const Footprint& of_map);

/// The mean over the footprint of texel (x, y) of the kernel's mass over each peak's pixel, by
/// their outlines. The kernel is as wide as the texel, about, or wider.
std::vector<double> peakMasses(const NearField& field, const MapExtent& map, int x, int y,
                               const Footprint& of_map, std::span<const Peak> peaks);

} // namespace ibl
