#include "convolve/synthesis.h"

#include "convolve/fft.h"
#include "convolve/theta_resample.h"
#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kRingsAtOnce = 2 * kLanes;
constexpr int kMGroup = 2 * kLanes;

typedef float Pixel __attribute__((vector_size(16)));

/// g_m(theta_r) of all m on `rings` rings: [m][part][ring].
std::vector<double> synthesiseRingSpectra(const Harmonics& harmonics,
                                          const std::vector<double>& scale, int degree, int rings,
                                          int threads) {
    const RingGeometry coarse = makeRings(ringsFor(degree));
    const ThetaResample plan = makeThetaResample(coarse.rings, rings, degree, RingSource::samples);
    std::vector<double> result(static_cast<std::size_t>(degree + 1) * kParts * rings);
    const std::ptrdiff_t column = static_cast<std::ptrdiff_t>(kParts) * coarse.rings;
    parallelFor(degree / kMGroup + 1, threads, [&](std::size_t group) {
        const int first = static_cast<int>(group) * kMGroup;
        const int end = std::min(first + kMGroup, degree + 1);
        std::vector<double> columns(static_cast<std::size_t>(kMGroup * column));
        for (int m = first; m < end; ++m) {
            legendreSynthesis(coarse, harmonics, scale.data(), degree, m,
                              columns.data() + (m - first) * column);
        }
        thetaResample(plan, columns.data(), end - first,
                      result.data() + static_cast<std::ptrdiff_t>(first) * kParts * rings);
    });
    return result;
}

/// Rings first .. first + kRingsAtOnce - 1 of the field, one channel: real rings A (the first
/// eight) and B share a complex transform, X_m = A_m + i B_m, X_-m = conj A_m + i conj B_m.
void loadRing(const std::vector<double>& spectra, int degree, int rings, int first, int channel,
              int columns, ComplexLanes* data) {
    std::fill(data, data + columns, ComplexLanes{});
    for (int m = 0; m <= degree; ++m) {
        const double* re = spectra.data() +
                           (static_cast<std::ptrdiff_t>(m) * kParts + 2 * channel) * rings + first;
        const double* im = re + rings;
        Lanes are, aim, bre, bim;
        for (int lane = 0; lane < kLanes; ++lane) {
            are[lane] = re[lane];
            aim[lane] = m == 0 ? 0 : im[lane];
            bre[lane] = re[kLanes + lane];
            bim[lane] = m == 0 ? 0 : im[kLanes + lane];
        }
        // Real and imaginary parts swapped, so that the forward transform is the inverse.
        data[m] = {aim + bre, are - bim};
        if (m > 0) data[columns - m] = {bre - aim, are + bim};
    }
}

void fillMargins(SmoothField& field) {
    constexpr int kMargin = SmoothField::kMargin;
    const std::size_t row = field.rowFloats();
    const auto at = [&](int r, int c) {
        return field.samples.data() + (r + kMargin) * row +
               static_cast<std::size_t>(c + kMargin) * 4;
    };
    for (int r = 0; r < field.rings; ++r) {
        std::copy_n(at(r, field.columns - kMargin), 4 * kMargin, at(r, -kMargin));
        std::copy_n(at(r, 0), 4 * kMargin, at(r, field.columns));
    }
    // Past a pole the rings come back on the other side.
    const int half = field.columns / 2;
    for (int r = 0; r < kMargin; ++r) {
        for (int c = -kMargin; c < field.columns + kMargin; ++c) {
            const int opposite = (c + half + field.columns) % field.columns;
            std::copy_n(at(r, opposite), 4, at(-1 - r, c));
            std::copy_n(at(field.rings - 1 - r, opposite), 4, at(field.rings + r, c));
        }
    }
}

/// Weights of 8-point Lagrange interpolation at 3 + t of the points 0 .. 7, t in [0, 1].
IBL_INLINE void lagrangeWeights(double t, float* weights) {
    constexpr int kTaps = SmoothField::kTaps;
    constexpr double kInverse[kTaps] = {-1.0 / 5040, 1.0 / 720, -1.0 / 240, 1.0 / 144,
                                        -1.0 / 144,  1.0 / 240, -1.0 / 720, 1.0 / 5040};
    double below[kTaps], above[kTaps]; // products of (t + 3 - i) over the points on either side
    below[0] = 1;
    above[kTaps - 1] = 1;
    for (int i = 1; i < kTaps; ++i) {
        below[i] = below[i - 1] * (t + 3 - (i - 1));
        above[kTaps - 1 - i] = above[kTaps - i] * (t + 3 - (kTaps - i));
    }
    for (int i = 0; i < kTaps; ++i)
        weights[i] = float(below[i] * above[i] * kInverse[i]);
}

} // namespace

SmoothField synthesise(const Harmonics& harmonics, const std::vector<double>& scale, int degree,
                       int threads) {
    SmoothField field;
    const int wanted = static_cast<int>(std::ceil(0.5 * kSamplesPerWavelength * (degree + 1)));
    field.rings = std::max(kRingsAtOnce, ringsFor(wanted));
    field.columns = 2 * field.rings;
    const std::vector<double> spectra =
        synthesiseRingSpectra(harmonics, scale, degree, field.rings, threads);
    const std::size_t row = field.rowFloats();
    field.samples.resize(row * (field.rings + 2 * SmoothField::kMargin));
    const FftPlan plan = makeFftPlan(field.columns);
    parallelFor(field.rings / kRingsAtOnce, threads, [&](std::size_t block) {
        const int first = static_cast<int>(block) * kRingsAtOnce;
        LaneVector<ComplexLanes> data(field.columns), work(fftWorkspace(plan));
        for (int channel = 0; channel < 3; ++channel) {
            loadRing(spectra, degree, field.rings, first, channel, field.columns, data.data());
            fft(plan, data.data(), work.data());
            for (int lane = 0; lane < kRingsAtOnce; ++lane) {
                float* out = field.samples.data() + (first + lane + SmoothField::kMargin) * row +
                             4 * SmoothField::kMargin + channel;
                for (int i = 0; i < field.columns; ++i) {
                    const ComplexLanes& value = data[i];
                    out[4 * static_cast<std::ptrdiff_t>(i)] = static_cast<float>(
                        lane < kLanes ? value.im[lane] : value.re[lane - kLanes]);
                }
            }
        }
    });
    fillMargins(field);
    return field;
}

double interpolationError(int l, int degree) {
    // The remainder of 8-point interpolation midway between points, of a wave of k radians a sample
    // in each of two directions: prod (i + 1/2)^2 k^8 / 8!, and never more than about 2.
    const int rings =
        std::max(kRingsAtOnce,
                 ringsFor(static_cast<int>(std::ceil(0.5 * kSamplesPerWavelength * (degree + 1)))));
    const double k = kPi * l / rings;
    const double product = 0.5 * 1.5 * 2.5 * 3.5;
    return std::min(2.0, 2 * product * product / 40320 * std::pow(k, 8));
}

IBL_MULTIVERSION
void sampleField(const SmoothField& field, const double* u, const double* v, int n, float* out) {
    constexpr int kTaps = SmoothField::kTaps;
    const std::size_t row = field.rowFloats();
    for (int i = 0; i < n; ++i) {
        const double x = u[i] * field.columns, y = v[i] * field.rings - 0.5;
        const int column = static_cast<int>(std::floor(x)), ring = static_cast<int>(std::floor(y));
        float wx[kTaps], wy[kTaps];
        lagrangeWeights(x - column, wx);
        lagrangeWeights(y - ring, wy);
        // Tap 0 is sample (ring - 3, column - 3), with the margin (ring + 1, column + 1); u = 1 is
        // column `columns`, whose last tap is columns + 4 and so is taken as column 0.
        const int start = (column >= field.columns ? column - field.columns : column) + 1;
        const float* tap = field.samples.data() + static_cast<std::size_t>(ring + 1) * row +
                           static_cast<std::size_t>(start) * 4;
        Pixel sum = {};
        for (int j = 0; j < kTaps; ++j, tap += row) {
            Pixel line = {};
            for (int k = 0; k < kTaps; ++k) {
                Pixel p;
                __builtin_memcpy(&p, tap + 4 * k, sizeof p);
                line += wx[k] * p;
            }
            sum += wy[j] * line;
        }
        for (int channel = 0; channel < 3; ++channel)
            out[3 * i + channel] = sum[channel];
    }
}

} // namespace ibl
