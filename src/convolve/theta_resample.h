// Exact change of the number of rings.
//
// On a great circle through the poles, theta runs over 2 pi and the m-th Fourier coefficient of a
// smooth field goes on past a pole with the sign (-1)^m. So it is a Fourier series in theta too,
// and moves to any other set of equispaced rings, larger or smaller, by two Fourier transforms.
//
// That makes both ends exact and cheap:
// - Analysis. f_lm = int g_m P_lm sin theta dtheta, where g_m is piecewise constant over the rows
// of
//   the probe. P_lm sin theta is a trigonometric polynomial of degree l + 1 and parity (-1)^(m+1),
//   so only the part of g_m (continued with that parity) of degree <= L + 1 matters, and its
//   Fourier coefficients are known in closed form: the rows' transform times sinc(k dtheta / 2).
//   Brought to R >= L + 2 rings, the sum over rings is then the integral, exactly, whatever the
//   number of rows: one Legendre sum over R rings in place of one or more Gauss points in every row
//   (for 1024 rows and L = 256, 3 to 12 times fewer Legendre functions), and right for probes of
//   any coarseness.
// - Synthesis. Legendre sums on R rings, then interpolated to as many rings as the output needs.
//
// A pair of columns, one even and one odd over the circle, shares one transform.
#pragma once

#include "convolve/fft.h"
#include "convolve/legendre.h"

namespace ibl {

enum class RingSource {
    pixel_rows, ///< means over rows of a probe; keep what matters against P_lm sin theta
    samples,    ///< samples of a smooth field
};

struct ThetaResample {
    int in = 0;
    int out = 0;
    int degree = 0;
    RingSource source = RingSource::samples;
    PrunedFft forward;
    FftPlan backward;
    std::vector<std::complex<double>> factors; ///< of k = -degree .. degree
};

/// From `in` rings to `out` rings (theta = pi (r + 0.5) / n), keeping Fourier degrees up to
/// `degree` (less than `in` for samples). 2 `out` > 2 `degree`; `out` is a multiple of kLanes.
ThetaResample makeThetaResample(int in, int out, int degree, RingSource source);

/// Where the values g_m of kLanes successive rings stand: block b of rings of part p of the i-th
/// column at b * block + (i * kParts + p) * part.
struct ColumnLayout {
    std::ptrdiff_t part;
    std::ptrdiff_t block;
};

/// Columns one after another, [m][part][ring].
inline ColumnLayout columnsApart(int rings) {
    return {rings, kLanes};
}

/// All columns' values on kLanes rings together, [ring block][m][part][lane].
inline ColumnLayout columnsTogether(int columns) {
    return {kLanes, static_cast<std::ptrdiff_t>(kLanes) * kParts * columns};
}

inline constexpr int kColumnsAtOnce = 2 * kLanes;

/// Resamples `count` <= kColumnsAtOnce columns of consecutive m, the first of them even.
void thetaResample(const ThetaResample& plan, const double* columns, ColumnLayout from, int count,
                   double* result, ColumnLayout to);

} // namespace ibl
