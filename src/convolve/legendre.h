// Spherical-harmonic coefficients and the Legendre sums that make and evaluate them.
//
// Basis: Y_lm = P_lm(cos theta) exp(i m psi), orthonormal over the sphere, m >= 0 (the fields are
// real, so -m is the conjugate), no Condon-Shortley sign, psi = 2 pi u growing with the lat-long
// column. Ring sums run over pairs of rings theta and pi - theta, on which P_lm is even or odd with
// l - m, in steps of two degrees (Schaeffer 2013, eq. 9-12):
//
//     P_(l+2) = [(x^2 - e_(l+1)^2 - e_l^2) P_l - e_l e_(l-1) P_(l-2)] / (e_(l+1) e_(l+2)),
//     e_l = sqrt((l^2 - m^2) / (4 l^2 - 1)),  x = cos theta.
//
// With P_l = t_l Q_l and t_(l+2) = t_(l-2) e_l e_(l-1) / (e_(l+1) e_(l+2)) the last factor is 1:
//
//     Q_(l+2) = (a_l x^2 - b_l) Q_l - Q_(l-2),
//
// two fused operations a step; t_l goes into the coefficients.
//
// P_mm ~ sin^m theta underflows near the poles, so values carry a power of two beside them until
// they are large enough to matter.
#pragma once

#include "convolve/simd.h"

#include <array>
#include <vector>

namespace ibl {

/// Real and imaginary parts of three channels: re r, im r, re g, im g, re b, im b.
inline constexpr int kParts = 6;
using Parts = std::array<double, kParts>;

/// f_lm of an RGB field for 0 <= m <= l <= degree.
struct Harmonics {
    int degree = 0;
    std::vector<Parts> coefficients; ///< m-major: [m][l - m]

    explicit Harmonics(int d = 0)
        : degree(d), coefficients(static_cast<std::size_t>(d + 1) * (d + 2) / 2) {}

    std::size_t index(int l, int m) const {
        return static_cast<std::size_t>(m) * (2 * degree + 3 - m) / 2 + (l - m);
    }
    Parts& at(int l, int m) { return coefficients[index(l, m)]; }
    const Parts& at(int l, int m) const { return coefficients[index(l, m)]; }
};

inline constexpr int kPairGroup = 8;

/// Ring pairs theta and pi - theta in order of growing sin theta, filled up to a multiple of
/// kPairGroup with the last of them.
struct RingPairs {
    int used = 0;                      ///< pairs that are wanted
    int pairs = 0;                     ///< with those that fill up
    std::vector<double> x;             ///< cos theta of the upper ring
    std::vector<double> sin;           ///< sin theta
    std::vector<long double> log2_sin; ///< log2 sin theta
    LaneVector<double> argument; ///< x^2, or -sin^2 theta in groups near the pole (legendre.cpp)
};

/// The pairs at the given thetas, one or more, ascending in [0, pi / 2].
RingPairs makePairs(std::vector<double> thetas);

/// The pairs (r, rings - 1 - r) of an even number of rings at theta = pi (r + 0.5) / rings.
RingPairs makeRings(int rings);

/// Least multiple of kLanes that holds fields of this degree as rings (more than degree + 1) and
/// twice which is a good length for Fourier transforms.
int ringsFor(int degree);

/// f_lm = sum over rings of weight_r g_m(theta_r) P_lm(theta_r) for `count` orders from `first` and
/// l = m .. degree, with the weights pi / rings * sin theta_r. `columns` holds g_m,
/// [m][part][ring].
void legendreAnalysis(const RingPairs& pairs, const double* columns, int first, int count,
                      Harmonics& harmonics);

/// g_m(theta) = sum over l = m .. degree of k_l f_lm P_lm(theta) for `count` orders from `first`;
/// `scale` holds k_l. `columns` receives [m][even, odd][part][pair]: g_m is even + odd on the upper
/// ring of a pair and even - odd on the lower one.
void legendreSynthesis(const RingPairs& pairs, const Harmonics& harmonics, const double* scale,
                       int degree, int first, int count, double* columns);

} // namespace ibl
