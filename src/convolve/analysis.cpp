#include "convolve/analysis.h"

#include "convolve/fft.h"
#include "convolve/theta_resample.h"
#include "core/parallel.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace ibl {
namespace {

constexpr double kPi = std::numbers::pi;

/// Two real rows share a complex transform, so a vector holds twice as many rows as lanes.
constexpr int kRowsAtOnce = 2 * kLanes;

/// Pixels of rows first .. first + kRowsAtOnce - 1, one channel: the first eight rows as real
/// parts, the others as imaginary parts.
void loadRows(const Image& probe, int first, int channel, double scale, double threshold,
              ComplexLanes* data) {
    for (int lane = 0; lane < kRowsAtOnce; ++lane) {
        const int j = first + lane;
        Lanes ComplexLanes::*const part = lane < kLanes ? &ComplexLanes::re : &ComplexLanes::im;
        const float* in = j < probe.height ? probe.row(j) + channel : nullptr;
        for (int i = 0; i < probe.width; ++i) {
            const double value =
                in ? scale * in[static_cast<std::ptrdiff_t>(i) * probe.channels] : 0.0;
            (data[i].*part)[lane % kLanes] = std::clamp(value, -threshold, threshold);
        }
    }
}

struct RowTask {
    const Image& probe;
    const FftPlan& plan;
    const std::vector<std::complex<double>>& factors; ///< per m: area and half-pixel phase
    double scale;
    double threshold;
};

void storeLanes(const Lanes& value, int count, double* out) {
    for (int lane = 0; lane < count; ++lane)
        out[lane] = value[lane];
}

void analyseRowBlock(const RowTask& task, int first, RowSpectrum& result) {
    const int w = task.probe.width;
    LaneVector<ComplexLanes> data(w), work(fftWorkspace(task.plan));
    const int upper = std::clamp(result.rows - first, 0, kLanes);
    const int lower = std::clamp(result.rows - first - kLanes, 0, kLanes);
    for (int channel = 0; channel < 3; ++channel) {
        loadRows(task.probe, first, channel, task.scale, task.threshold, data.data());
        fft(task.plan, data.data(), work.data());
        for (int m = 0; m <= result.degree; ++m) {
            // X = A + iB with A, B the transforms of real rows: A = (X_m + conj X_-m) / 2, ...
            const ComplexLanes &p = data[m % w], &q = data[(w - m % w) % w];
            const Lanes are = 0.5 * (p.re + q.re), aim = 0.5 * (p.im - q.im);
            const Lanes bre = 0.5 * (p.im + q.im), bim = 0.5 * (q.re - p.re);
            const std::complex<double> f = task.factors[m];
            double* out = result.values.data() +
                          (static_cast<std::ptrdiff_t>(m) * kParts + 2 * channel) * result.rows +
                          first;
            storeLanes(are * f.real() - aim * f.imag(), upper, out);
            storeLanes(are * f.imag() + aim * f.real(), upper, out + result.rows);
            storeLanes(bre * f.real() - bim * f.imag(), lower, out + kLanes);
            storeLanes(bre * f.imag() + bim * f.real(), lower, out + result.rows + kLanes);
        }
    }
}

} // namespace

RowSpectrum analyseRows(const Image& probe, double scale, double threshold, int degree,
                        int threads) {
    RowSpectrum result{probe.height, degree, {}};
    result.values.resize(static_cast<std::size_t>(degree + 1) * kParts * probe.height);
    const FftPlan plan = makeFftPlan(probe.width);
    std::vector<std::complex<double>> factors(static_cast<std::size_t>(degree + 1));
    for (int m = 0; m <= degree; ++m) {
        const double x = kPi * m / probe.width;
        factors[m] = std::polar(2 * kPi / probe.width * (m == 0 ? 1 : std::sin(x) / x), -x);
    }
    const RowTask task{probe, plan, factors, scale, threshold};
    const std::size_t blocks = (probe.height + kRowsAtOnce - 1) / kRowsAtOnce;
    parallelFor(blocks, threads, [&](std::size_t block) {
        analyseRowBlock(task, static_cast<int>(block) * kRowsAtOnce, result);
    });
    return result;
}

Harmonics analyse(const RowSpectrum& rows, int degree, int threads) {
    Harmonics harmonics(degree);
    const RingGeometry rings = makeRings(ringsFor(degree));
    const ThetaResample plan =
        makeThetaResample(rows.rows, rings.rings, degree + 1, RingSource::pixel_rows);
    constexpr int kGroup = 2 * kLanes;
    const std::size_t groups = degree / kGroup + 1;
    parallelFor(groups, threads, [&](std::size_t group) {
        const int first = static_cast<int>(group) * kGroup;
        const int end = std::min(first + kGroup, degree + 1);
        const std::ptrdiff_t column = static_cast<std::ptrdiff_t>(kParts) * rings.rings;
        std::vector<double> resampled(static_cast<std::size_t>(kGroup * column));
        thetaResample(plan, rows.column(first), end - first, resampled.data());
        for (int m = first; m < end; ++m) {
            legendreAnalysis(rings, resampled.data() + (m - first) * column, m, harmonics);
        }
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
