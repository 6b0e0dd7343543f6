// From pixels to spherical-harmonic coefficients.
#pragma once

#include "convolve/legendre.h"
#include "image/image.h"

#include <limits>
#include <vector>

namespace ibl {

/// Fourier coefficients in azimuth of every row of a lat-long probe, a pixel an area:
///
///     g_m(j) = int L(psi, row j) exp(-i m psi) dpsi
///            = dpsi sinc(m dpsi/2) exp(-i m dpsi/2) sum_i L_ij exp(-i m i dpsi),  dpsi = 2 pi / W.
///
/// Right for every m, those above W/2 too.
struct RowSpectrum {
    int rows = 0;
    int degree = 0;
    LaneVector<double> values; ///< [block of kLanes rows][m][part][row in block], m = 0 .. degree
};

inline constexpr double kNoThreshold = std::numeric_limits<double>::infinity();

/// `probe` (RGB) times `scale`, clamped to +-threshold.
RowSpectrum analyseRows(const Image& probe, double scale, double threshold, int degree,
                        int threads);

/// f_lm up to `degree` <= rows.degree, exact but for rounding (theta_resample.h).
Harmonics analyse(const RowSpectrum& rows, int degree, int threads);

/// S_l = sum over m and channels of |f_lm|^2: the energy of each degree. Over all l it sums to the
/// integral of L^2 (Parseval).
std::vector<double> powerSpectrum(const Harmonics& harmonics);

} // namespace ibl
