#include "convolve/analysis.h"

#include "convolve/fft.h"
#include "convolve/theta_resample.h"
#include "core/parallel.h"
#include "image/pixel_lanes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;

/// Two real rows share a complex transform, so a vector holds twice as many rows as lanes.
constexpr int kRowsAtOnce = 2 * kLanes;

struct RowTask {
    const Image& probe;
    const PrunedFft& plan;
    const std::vector<std::complex<double>>& factors; ///< per m: area and half-pixel phase
    double scale;
    double threshold;
};

/// Rows `rows` of one channel, scaled and clamped: the first kLanes as real parts, the others as
/// imaginary parts.
template <int Channel>
IBL_INLINE void loadRows(const RowTask& task, const float* const* rows, ComplexLanes* data) {
    const Lanes most = Lanes{} + task.threshold;
    const auto clamped = [&](const Lanes& raw) {
        const Lanes value = raw * task.scale, above = value > most ? most : value;
        return above < -most ? -most : above;
    };
    const int width = task.probe.width;
    int i = 0;
    for (; i + kLanes <= width; i += kLanes) {
        Lanes re[kLanes], im[kLanes];
        for (int lane = 0; lane < kLanes; ++lane) {
            re[lane] = clamped(loadPixels<Channel>(rows[lane] + 3 * i));
            im[lane] = clamped(loadPixels<Channel>(rows[lane + kLanes] + 3 * i));
        }
        transpose(re);
        transpose(im);
        for (int k = 0; k < kLanes; ++k)
            data[task.plan.slot(i + k)] = {re[k], im[k]};
    }
    for (; i < width; ++i) {
        Lanes re, im;
        for (int lane = 0; lane < kLanes; ++lane) {
            re[lane] = rows[lane][3 * i + Channel];
            im[lane] = rows[lane + kLanes][3 * i + Channel];
        }
        data[task.plan.slot(i)] = {clamped(re), clamped(im)};
    }
}

IBL_MULTIVERSION
void loadChannel(const RowTask& task, const float* const* rows, int channel, ComplexLanes* data) {
    if (channel == 0)
        loadRows<0>(task, rows, data);
    else if (channel == 1)
        loadRows<1>(task, rows, data);
    else
        loadRows<2>(task, rows, data);
}

/// From X = A + iB, A and B the transforms of real rows: A = (X_m + conj X_-m) / 2, ... `spectrum`
/// holds X_m from m = -degree on, `out` and `out_lower` a block of rows each.
IBL_MULTIVERSION
void separateRows(const RowTask& task, const ComplexLanes* spectrum, int degree, int channel,
                  double* out, double* out_lower) {
    for (int m = 0; m <= degree; ++m) {
        const ComplexLanes &p = spectrum[degree + m], &q = spectrum[degree - m];
        const Lanes are = 0.5 * (p.re + q.re), aim = 0.5 * (p.im - q.im);
        const Lanes bre = 0.5 * (p.im + q.im), bim = 0.5 * (q.re - p.re);
        const std::complex<double> f = task.factors[m];
        const std::ptrdiff_t at = static_cast<std::ptrdiff_t>(m) * kParts + 2 * channel;
        Lanes* upper = reinterpret_cast<Lanes*>(out) + at;
        Lanes* lower = reinterpret_cast<Lanes*>(out_lower) + at;
        upper[0] = are * f.real() - aim * f.imag();
        upper[1] = are * f.imag() + aim * f.real();
        lower[0] = bre * f.real() - bim * f.imag();
        lower[1] = bre * f.imag() + bim * f.real();
    }
}

void analyseRowBlock(const RowTask& task, int block, const std::vector<float>& zeros,
                     RowSpectrum& result) {
    const float* rows[kRowsAtOnce];
    for (int i = 0; i < kRowsAtOnce; ++i) {
        const int j = block * kRowsAtOnce + i;
        rows[i] = j < task.probe.height ? task.probe.row(j) : zeros.data();
    }
    LaneVector<ComplexLanes> data(task.probe.width), work(fftWorkspace(task.plan.part)),
        spectrum(2 * result.degree + 1);
    const std::ptrdiff_t lanes = columnsTogether(result.degree + 1).block;
    double* out = result.values.data() + 2 * block * lanes;
    for (int channel = 0; channel < 3; ++channel) {
        loadChannel(task, rows, channel, data.data());
        prunedFft(task.plan, data.data(), work.data(), spectrum.data());
        separateRows(task, spectrum.data(), result.degree, channel, out, out + lanes);
    }
}

} // namespace

RowSpectrum analyseRows(const Image& probe, double scale, double threshold, int degree,
                        int threads) {
    const std::size_t blocks = (probe.height + kRowsAtOnce - 1) / kRowsAtOnce;
    RowSpectrum result{probe.height, degree, {}};
    result.values.resize(2 * blocks * columnsTogether(degree + 1).block);
    const PrunedFft plan = makePrunedFft(probe.width, degree);
    std::vector<std::complex<double>> factors(static_cast<std::size_t>(degree + 1));
    for (int m = 0; m <= degree; ++m) {
        const double x = kPi * m / probe.width;
        factors[m] = std::polar(2 * kPi / probe.width * (m == 0 ? 1 : std::sin(x) / x), -x);
    }
    const RowTask task{probe, plan, factors, scale, threshold};
    const std::vector<float> zeros(probe.rowFloats());
    parallelFor(blocks, threads, [&](std::size_t block) {
        analyseRowBlock(task, static_cast<int>(block), zeros, result);
    });
    return result;
}

Harmonics analyse(const RowSpectrum& rows, int degree, int threads) {
    Harmonics harmonics(degree);
    const int count = ringsFor(degree);
    const RingPairs rings = makeRings(count);
    const ThetaResample plan =
        makeThetaResample(rows.rows, count, degree + 1, RingSource::pixel_rows);
    parallelFor(degree / kColumnsAtOnce + 1, threads, [&](std::size_t group) {
        const int first = static_cast<int>(group) * kColumnsAtOnce;
        const int orders = std::min(kColumnsAtOnce, degree + 1 - first);
        LaneVector<double> resampled(static_cast<std::size_t>(kColumnsAtOnce) * kParts * count);
        const double* columns = rows.values.data() + first * kParts * kLanes;
        thetaResample(plan, columns, columnsTogether(rows.degree + 1), orders, resampled.data(),
                      columnsApart(count));
        legendreAnalysis(rings, resampled.data(), first, orders, harmonics);
    });
    return harmonics;
}

std::vector<double> powerSpectrum(const Harmonics& harmonics) {
    std::vector<double> power(static_cast<std::size_t>(harmonics.degree + 1), 0.0);
    for (int m = 0; m <= harmonics.degree; ++m) {
        for (int l = m; l <= harmonics.degree; ++l) {
            double sum = 0;
            for (const double part : harmonics.at(l, m))
                sum += part * part;
            power[l] += (m == 0 ? 1 : 2) * sum;
        }
    }
    return power;
}

} // namespace ibl
