// The split-sum table (DFG): what a specular lobe under a constant probe reflects, by the cosine
// between normal and view and by roughness (Karis 2013).
#pragma once

#include "image/image.h"

#include <optional>

namespace ibl {

/// Smith's masking and shadowing of microfacets: correlated in height (Heitz 2014), or the product
/// of both as though they were independent.
enum class Masking { correlated, separable };

struct SplitSumOptions {
    int size = 128;            ///< edge of the table, at least 1
    bool multiscatter = false; ///< (bias, total) instead of (scale, bias)
    bool cloth = false;        ///< the cloth term in the third channel, else 0
    int threads = 0;           ///< 0: as many as the machine has; the result does not depend on it
    std::optional<double> roughness{};     ///< a single row, of this one (at least that of row 0)
    Masking masking = Masking::correlated; ///< of GGX
};

struct SplitSumTable {
    Image image;
    double error_estimate = 0; ///< absolute: twice the points move no looked-at texel by more
};

/// RGB: texel (i, j) stands for N.V = (i + 0.5) / size and the perceptual roughness
/// (j + 0.5) / size, row 0 at the top, so the top is smooth. With D of GGX, alpha = roughness^2,
/// and V the visibility of Smith, G / (4 (n.l) (n.v)),
///
///     total = int D V 4 (v.h) (n.l) dh,   bias = int D V (1 - v.h)^5 4 (v.h) (n.l) dh,
///
/// and scale = total - bias, so that a surface of Fresnel reflectance F0 reflects
/// F0 scale + bias = mix(bias, total, F0). The first two channels are (scale, bias), or
/// (bias, total) with `multiscatter` (Filament's layout). The cloth term is the total of Charlie's
/// distribution with the visibility of Neubelt and Pettineo (2013), 1 / (4 (n.l + n.v - n.l n.v)).
SplitSumTable splitSumTable(const SplitSumOptions& options);

/// The integrals of one texel, `refinement` (>= 1) times the points that the table takes.
struct SplitSum {
    double bias;
    double total;
};
SplitSum ggxSplitSum(double n_dot_v, double roughness, int refinement = 1,
                     Masking masking = Masking::correlated);
double clothSplitSum(double n_dot_v, double roughness, int refinement = 1);

} // namespace ibl
