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
constexpr int kTaps = Interpolant::kTaps;

typedef float Pixel __attribute__((vector_size(16)));
typedef float TwoPixels __attribute__((vector_size(32)));

int gridRings(int degree) {
    const double least = kOversampling * (degree + 0.5) / kRingsAtOnce;
    return kRingsAtOnce * goodFftLength(static_cast<int>(std::ceil(least)));
}

/// 1 / phi^ for waves of 0 .. degree periods on a circle of so many samples; 1 where the samples
/// are to be the field's values.
std::vector<double> gains(int degree, int samples, bool interpolated) {
    std::vector<double> result(static_cast<std::size_t>(degree + 1), 1.0);
    for (int k = 0; interpolated && k <= degree; ++k)
        result[k] = 1 / windowTransform(static_cast<double>(k) / samples);
    return result;
}

/// Rings theta and pi - theta from their even and odd parts: [m][part][ring].
IBL_MULTIVERSION
void ringsOfPairs(const RingPairs& pairs, const double* pairs_of, int orders, double* rings_of) {
    const int used = pairs.used;
    const std::ptrdiff_t half = static_cast<std::ptrdiff_t>(kParts) * pairs.pairs;
    for (int m = 0; m < orders; ++m, pairs_of += 2 * half) {
        for (int part = 0; part < kParts; ++part, rings_of += 2 * used) {
            const double *even = pairs_of + part * pairs.pairs, *odd = even + half;
            double* lower = rings_of + 2 * used - 1;
            for (int p = 0; p < used; ++p) {
                rings_of[p] = even[p] + odd[p];
                lower[-p] = even[p] - odd[p];
            }
        }
    }
}

/// g_m(theta_r) of all m on `rings` rings, columns together, each wave in theta times its gain.
LaneVector<double> synthesiseRingSpectra(const Harmonics& harmonics,
                                         const std::vector<double>& scale, int degree, int rings,
                                         const std::vector<double>& gain, int threads) {
    const int coarse = ringsFor(degree);
    const RingPairs pairs = makeRings(coarse);
    ThetaResample plan = makeThetaResample(coarse, rings, degree, RingSource::samples);
    for (int k = -degree; k <= degree; ++k)
        plan.factors[k + degree] *= gain[std::abs(k)];
    const ColumnLayout together = columnsTogether(degree + 1);
    LaneVector<double> result(static_cast<std::size_t>(together.block) * rings / kLanes);
    parallelFor(degree / kColumnsAtOnce + 1, threads, [&](std::size_t group) {
        const int first = static_cast<int>(group) * kColumnsAtOnce;
        const int orders = std::min(kColumnsAtOnce, degree + 1 - first);
        LaneVector<double> even_odd(static_cast<std::size_t>(orders) * 2 * kParts * pairs.pairs);
        LaneVector<double> columns(static_cast<std::size_t>(orders) * kParts * coarse);
        legendreSynthesis(pairs, harmonics, scale.data(), degree, first, orders, even_odd.data());
        ringsOfPairs(pairs, even_odd.data(), orders, columns.data());
        thetaResample(plan, columns.data(), columnsApart(coarse), orders,
                      result.data() + static_cast<std::ptrdiff_t>(first) * kParts * kLanes,
                      together);
    });
    return result;
}

/// Two blocks of rings A and B of one channel share a complex transform: X_m = A_m + i B_m, X_-m =
/// conj A_m + i conj B_m. Real and imaginary parts are swapped, so that the forward transform is
/// the inverse.
IBL_MULTIVERSION
void loadRings(const double* upper, const double* lower, const std::vector<double>& gain,
               int columns, int channel, ComplexLanes* data) {
    const int degree = static_cast<int>(gain.size()) - 1;
    std::fill(data + degree + 1, data + columns - degree, ComplexLanes{});
    for (int m = 0; m <= degree; ++m) {
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(m) * kParts + 2 * channel;
        const Lanes *a = reinterpret_cast<const Lanes*>(upper) + at,
                    *b = reinterpret_cast<const Lanes*>(lower) + at;
        const double g = gain[m], g_im = m == 0 ? 0 : g;
        const Lanes are = g * a[0], aim = g_im * a[1], bre = g * b[0], bim = g_im * b[1];
        data[m] = {aim + bre, are - bim};
        if (m > 0) data[columns - m] = {bre - aim, are + bim};
    }
}

/// The rings' spectra transformed and handed on: `take(first, channels)` with the kRingsAtOnce
/// rings from `first`, the first kLanes in the imaginary parts, the others in the real ones.
template <class Take>
void transformRings(const LaneVector<double>& spectra, const std::vector<double>& gain, int rings,
                    int threads, const Take& take) {
    const int columns = 2 * rings;
    const FftPlan plan = makeFftPlan(columns);
    const std::ptrdiff_t block_size = columnsTogether(static_cast<int>(gain.size())).block;
    parallelFor(rings / kRingsAtOnce, threads, [&](std::size_t block) {
        LaneVector<ComplexLanes> data(static_cast<std::size_t>(3 * columns)),
            work(fftWorkspace(plan));
        const double* upper = spectra.data() + 2 * static_cast<std::ptrdiff_t>(block) * block_size;
        const ComplexLanes* channels[3];
        for (int channel = 0; channel < 3; ++channel) {
            ComplexLanes* values = data.data() + static_cast<std::ptrdiff_t>(channel) * columns;
            loadRings(upper, upper + block_size, gain, columns, channel, values);
            fft(plan, values, work.data());
            channels[channel] = values;
        }
        take(static_cast<int>(block) * kRingsAtOnce, channels);
    });
}

/// kLanes rings of one column: rows become pixels. Converted before they are transposed, doubles
/// would go from memory to half a register: the compiler then sees no wide register to clear, but
/// the processor does, and all code for the baseline after that runs several times slower.
IBL_INLINE void storeColumn(const Lanes& r, const Lanes& g, const Lanes& b, float* out,
                            std::size_t row) {
    Lanes pixels[kLanes] = {r, g, b, Lanes{}};
    transpose(pixels);
    for (int lane = 0; lane < kLanes; ++lane) {
        const Pixel pixel = __builtin_convertvector(pixels[lane], Pixel);
        __builtin_memcpy(out + lane * row, &pixel, sizeof(Pixel));
    }
}

IBL_MULTIVERSION
void storeRings(const ComplexLanes* const* channels, int columns, float* out, std::size_t row) {
    const ComplexLanes *r = channels[0], *g = channels[1], *b = channels[2];
    for (int i = 0; i < columns; ++i, out += 4) {
        storeColumn(r[i].im, g[i].im, b[i].im, out, row);
        storeColumn(r[i].re, g[i].re, b[i].re, out + kLanes * row, row);
    }
}

/// kRingsAtOnce rings of one channel, one after another.
IBL_MULTIVERSION
void storePlane(const ComplexLanes* values, int columns, double* out) {
    for (int i = 0; i < columns; i += kLanes) {
        Lanes upper[kLanes], lower[kLanes];
        for (int k = 0; k < kLanes; ++k) {
            upper[k] = values[i + k].im;
            lower[k] = values[i + k].re;
        }
        transpose(upper);
        transpose(lower);
        for (int lane = 0; lane < kLanes; ++lane) {
            __builtin_memcpy(out + lane * columns + i, &upper[lane], sizeof(Lanes));
            __builtin_memcpy(out + (kLanes + lane) * columns + i, &lower[lane], sizeof(Lanes));
        }
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

IBL_INLINE TwoPixels weightsAt(const Interpolant& taps, double t) {
    const TwoPixels s = TwoPixels{} + static_cast<float>(2 * t - 1);
    TwoPixels weights = {};
    for (int n = 0; n < Interpolant::kTerms; ++n) {
        TwoPixels term;
        __builtin_memcpy(&term, taps.terms[n].data(), sizeof term);
        weights = weights * s + term;
    }
    return weights;
}

IBL_INLINE Pixel sampleAt(const SmoothField& field, const Interpolant& taps, double u, double v) {
    const std::size_t row = field.rowFloats();
    const double x = u * field.columns, y = v * field.rings - 0.5;
    const int column = static_cast<int>(std::floor(x)), ring = static_cast<int>(std::floor(y));
    const TwoPixels wx = weightsAt(taps, x - column), wy = weightsAt(taps, y - ring);
    const TwoPixels across[kTaps / 2] = {__builtin_shufflevector(wx, wx, 0, 0, 0, 0, 1, 1, 1, 1),
                                         __builtin_shufflevector(wx, wx, 2, 2, 2, 2, 3, 3, 3, 3),
                                         __builtin_shufflevector(wx, wx, 4, 4, 4, 4, 5, 5, 5, 5),
                                         __builtin_shufflevector(wx, wx, 6, 6, 6, 6, 7, 7, 7, 7)};
    // Tap 0 is sample (ring - 3, column - 3), with the margin (ring + 1, column + 1); u = 1 is
    // column `columns`, whose last tap is columns + 4 and so is taken as column 0.
    const int start = (column >= field.columns ? column - field.columns : column) + 1;
    const float* tap = field.samples.data() + static_cast<std::size_t>(ring + 1) * row +
                       static_cast<std::size_t>(start) * 4;
    TwoPixels sum = {};
    for (int j = 0; j < kTaps; ++j, tap += row) {
        TwoPixels line = {};
        for (int k = 0; k < kTaps / 2; ++k) {
            TwoPixels pixels;
            __builtin_memcpy(&pixels, tap + 8 * k, sizeof pixels);
            line += across[k] * pixels;
        }
        sum += wy[j] * line;
    }
    return __builtin_shufflevector(sum, sum, 0, 1, 2, 3) +
           __builtin_shufflevector(sum, sum, 4, 5, 6, 7);
}

} // namespace

SmoothField synthesise(const Harmonics& harmonics, const std::vector<double>& scale, int degree,
                       int threads) {
    SmoothField field;
    field.rings = gridRings(degree);
    field.columns = 2 * field.rings;
    const std::vector<double> gain = gains(degree, field.columns, true);
    const LaneVector<double> spectra =
        synthesiseRingSpectra(harmonics, scale, degree, field.rings, gain, threads);
    const std::size_t row = field.rowFloats();
    field.samples.resize(row * (field.rings + 2 * SmoothField::kMargin));
    transformRings(spectra, gain, field.rings, threads,
                   [&](int first, const ComplexLanes* const* channels) {
                       float* out = field.samples.data() + (first + SmoothField::kMargin) * row +
                                    4 * SmoothField::kMargin;
                       storeRings(channels, field.columns, out, row);
                   });
    fillMargins(field);
    return field;
}

void synthesiseGrid(const Harmonics& harmonics, const std::vector<double>& scale, int degree,
                    int rings, int threads, double* out) {
    const int columns = 2 * rings;
    const std::vector<double> gain = gains(degree, columns, false);
    const LaneVector<double> spectra =
        synthesiseRingSpectra(harmonics, scale, degree, rings, gain, threads);
    transformRings(spectra, gain, rings, threads,
                   [&](int first, const ComplexLanes* const* channels) {
                       for (int channel = 0; channel < 3; ++channel) {
                           const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(channel) * rings;
                           storePlane(channels[channel], columns, out + (row + first) * columns);
                       }
                   });
}

double interpolationError(int l, int degree) {
    // Error of one direction and of the other, as a part of the highest frequency.
    const double part = kOversampling * l / gridRings(degree);
    const int step =
        std::min(Interpolant::kSteps, static_cast<int>(std::ceil(part * Interpolant::kSteps)));
    return 2 * interpolant().error[step];
}

IBL_MULTIVERSION
void sampleField(const SmoothField& field, const double* u, const double* v, int n, float* out) {
    const Interpolant& taps = interpolant();
    for (int i = 0; i < n; ++i) {
        const Pixel value = sampleAt(field, taps, u[i], v[i]);
        for (int channel = 0; channel < 3; ++channel)
            out[3 * i + channel] = value[channel];
    }
}

} // namespace ibl
