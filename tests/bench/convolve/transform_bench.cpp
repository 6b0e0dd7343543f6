// Times of the transform's stages on one thread, each with the error it makes. Cases are named by
// the band limit, or the rows, that they run with.
#include "convolve/analysis.h"
#include "convolve/evaluate.h"
#include "convolve/synthesis.h"
#include "convolve/theta_resample.h"
#include "panorama/builtin.h"

#include "bench_support.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>

namespace {

using namespace ibl;
using Complex = std::complex<double>;
constexpr double kPi = std::numbers::pi;
constexpr double kNoThreshold = std::numeric_limits<double>::infinity();

const Image& sky(int height) {
    static std::map<int, Image> probes;
    if (!probes.contains(height)) probes[height] = builtinProbe("builtin:sky", height).image;
    return probes[height];
}

/// Largest error of some rows' Fourier coefficients over the row's sum of |L|, by the sum over
/// pixels in long double.
double rowsError(const Image& probe, const RowSpectrum& rows) {
    double worst = 0;
    const auto pi = std::numbers::pi_v<long double>;
    for (const int j : {0, probe.height / 3, probe.height - 1}) {
        for (const int m : {0, 1, rows.degree / 2, rows.degree}) {
            std::complex<long double> sum = 0;
            long double size = 0;
            for (int i = 0; i < probe.width; ++i) {
                const auto turn = static_cast<long>(i) * m % probe.width;
                sum += std::polar<long double>(1, -2 * pi * turn / probe.width) *
                       static_cast<long double>(probe.at(i, j)[1]);
                size += std::abs(probe.at(i, j)[1]);
            }
            const long double x = pi * m / probe.width, width = 2 * pi / probe.width;
            sum *= std::polar<long double>(width * (m == 0 ? 1 : std::sin(x) / x), -x);
            const double* value = rows.values.data() +
                                  j / kLanes * columnsTogether(rows.degree + 1).block +
                                  (m * kParts + 2) * kLanes + j % kLanes;
            const auto re = static_cast<double>(sum.real()), im = static_cast<double>(sum.imag());
            worst = std::max(worst, std::hypot(value[0] - re, value[kLanes] - im) /
                                        static_cast<double>(size * width));
        }
    }
    return worst;
}

void rows(benchmark::State& state) {
    const int height = static_cast<int>(state.range(0)), degree = static_cast<int>(state.range(1));
    RowSpectrum spectrum;
    const Image& probe = sky(height);
    for (auto _ : state)
        spectrum = analyseRows(probe, 1, kNoThreshold, degree, 1);
    holdError(state, "error", rowsError(probe, spectrum), 1e-15);
    state.counters["ns_pixel"] =
        benchmark::Counter(2e-9 * height * height, benchmark::Counter::kIsIterationInvariantRate |
                                                       benchmark::Counter::kInvert);
}
BENCHMARK(rows)
    ->Args({512, 255})
    ->Args({1024, 255})
    ->Args({2048, 255})
    ->Args({4096, 255})
    ->Args({1024, 511})
    ->Unit(benchmark::kMillisecond);

/// A wave of degree k on `rings` rings, as the parity of the m-th column and the source have it.
double wave(int m, int k, double theta) {
    return m % 2 == 0 ? std::cos(k * theta) : std::sin(k * theta);
}

/// kColumnsAtOnce columns of samples of a wave each, brought from `in` to `out` rings.
void theta(benchmark::State& state) {
    const int degree = static_cast<int>(state.range(0)), in = ringsFor(degree), out = 2 * in;
    const ThetaResample plan = makeThetaResample(in, out, degree, RingSource::samples);
    LaneVector<double> from(static_cast<std::size_t>(kColumnsAtOnce) * kParts * in);
    LaneVector<double> to(static_cast<std::size_t>(kColumnsAtOnce) * kParts * out);
    for (int m = 0; m < kColumnsAtOnce; ++m) {
        for (int i = 0; i < kParts * in; ++i) {
            from[static_cast<std::size_t>(m) * kParts * in + i] =
                wave(m, degree - i / in, kPi * (i % in + 0.5) / in);
        }
    }
    for (auto _ : state) {
        thetaResample(plan, from.data(), columnsApart(in), kColumnsAtOnce, to.data(),
                      columnsApart(out));
        benchmark::DoNotOptimize(to.data());
    }
    double worst = 0;
    for (int m = 0; m < kColumnsAtOnce; ++m) {
        for (int i = 0; i < kParts * out; ++i) {
            const double exact = wave(m, degree - i / out, kPi * (i % out + 0.5) / out);
            worst = std::max(worst,
                             std::abs(to[static_cast<std::size_t>(m) * kParts * out + i] - exact));
        }
    }
    holdError(state, "error", worst, 1e-12);
}
BENCHMARK(theta)->Arg(255)->Arg(511)->Arg(1023)->Unit(benchmark::kMillisecond);

/// All orders' Legendre sums; the error is the largest of some sums against the standard library's
/// functions, over the root of the sum of their squares.
void legendreUp(benchmark::State& state) {
    const int degree = static_cast<int>(state.range(0));
    const Harmonics f = randomHarmonics(degree);
    const std::vector<double> ones(static_cast<std::size_t>(degree + 1), 1.0);
    const RingPairs pairs = makeRings(ringsFor(degree));
    const std::ptrdiff_t column = 2 * kParts * pairs.pairs;
    LaneVector<double> columns(static_cast<std::size_t>((degree + 1) * column));
    for (auto _ : state) {
        legendreSynthesis(pairs, f, ones.data(), degree, 0, degree + 1, columns.data());
        benchmark::DoNotOptimize(columns.data());
    }
    double worst = 0;
    for (const int m : {0, 1, degree / 3, degree / 2}) {
        for (const int p : {0, pairs.used / 3, pairs.used - 1}) {
            long double sum = 0, squares = 1e-30L;
            for (int l = m; l <= degree; l += 2) {
                const long double theta = kPi * (p + 0.5) / (2 * pairs.used);
                const long double value = std::sph_legendre(l, m, theta) * (m % 2 ? -1 : 1);
                sum += f.at(l, m)[2] * value;
                squares += value * value;
            }
            const double value = columns[m * column + 2 * pairs.pairs + p];
            worst =
                std::max(worst, static_cast<double>(std::abs(value - sum) / std::sqrt(squares)));
        }
    }
    holdError(state, "error", worst, 1e-12);
}
BENCHMARK(legendreUp)->Arg(255)->Arg(511)->Arg(1023)->Unit(benchmark::kMillisecond);

/// The other way; the error is that of the round trip, which is exact for fields whose degree is
/// below half the number of rings and weights that integrate them.
void legendreDown(benchmark::State& state) {
    const int degree = static_cast<int>(state.range(0));
    const RingPairs pairs = makeRings(ringsFor(degree));
    const std::ptrdiff_t column = 2 * kParts * pairs.used;
    LaneVector<double> columns(static_cast<std::size_t>((degree + 1) * column), 0.0);
    // One ring of one order: f_lm is then its weight times P_lm.
    const int order = degree / 3, ring = pairs.used / 2;
    columns[order * column + 2 * pairs.used * 2 + ring] = 1;
    Harmonics f(degree);
    for (auto _ : state)
        legendreAnalysis(pairs, columns.data(), 0, degree + 1, f);
    const double theta = kPi * (ring + 0.5) / (2 * pairs.used);
    const double weight = kPi / (2 * pairs.used) * std::sin(theta);
    double worst = 0;
    for (int l = order; l <= degree; ++l) {
        const auto exact = static_cast<double>(
            std::sph_legendre(l, order, static_cast<long double>(theta)) * (order % 2 ? -1 : 1));
        worst = std::max(worst, std::abs(f.at(l, order)[2] / weight - exact));
    }
    holdError(state, "error", worst, 1e-12);
}
BENCHMARK(legendreDown)->Arg(255)->Arg(511)->Arg(1023)->Unit(benchmark::kMillisecond);

struct Points {
    std::vector<double> u, v;
};

Points randomPoints(int n) {
    Uniform uniform;
    Points points;
    for (int i = 0; i < n; ++i) {
        points.u.push_back(0.5 + 0.5 * uniform());
        points.v.push_back(0.5 + 0.5 * uniform());
    }
    return points;
}

std::vector<double> pointwise(const Harmonics& f, int degree, const Points& points) {
    std::vector<double> result(3 * points.u.size());
    const std::vector<double> ones(static_cast<std::size_t>(degree + 1), 1.0);
    evaluateField(f, ones, degree, points.u.data(), points.v.data(), points.u.size(), 1,
                  result.data());
    return result;
}

/// Grid and interpolation of a field whose energy is as great in every degree, the hardest that
/// interpolation can meet; the error is relative RMS against sums at the points.
void grid(benchmark::State& state) {
    const int degree = static_cast<int>(state.range(0));
    Harmonics f = randomHarmonics(degree);
    const std::vector<double> ones(static_cast<std::size_t>(degree + 1), 1.0);
    SmoothField field;
    for (auto _ : state)
        field = synthesise(f, ones, degree, 1);
    const Points points = randomPoints(1000);
    std::vector<float> sampled(3 * points.u.size());
    sampleField(field, points.u.data(), points.v.data(), static_cast<int>(points.u.size()),
                sampled.data());
    const double error =
        relativeRms({sampled.begin(), sampled.end()}, pointwise(f, degree, points));
    holdError(state, "error", error, 2e-6);
    state.counters["bound"] = interpolationError(degree, degree);
}
BENCHMARK(grid)->Arg(255)->Arg(511)->Arg(1023)->Unit(benchmark::kMillisecond);

/// 100000 points of a grid; the error is of a field whose k-th degree has an amplitude of 1 / k^2.
void sampling(benchmark::State& state) {
    const int degree = static_cast<int>(state.range(0));
    std::vector<double> scale;
    for (int l = 0; l <= degree; ++l)
        scale.push_back(1.0 / ((l + 1.0) * (l + 1.0)));
    const Harmonics f = randomHarmonics(degree);
    const SmoothField field = synthesise(f, scale, degree, 1);
    const Points points = randomPoints(100000);
    std::vector<float> sampled(3 * points.u.size());
    for (auto _ : state) {
        sampleField(field, points.u.data(), points.v.data(), static_cast<int>(points.u.size()),
                    sampled.data());
        benchmark::DoNotOptimize(sampled.data());
    }
    std::vector<double> exact(3000);
    evaluateField(f, scale, degree, points.u.data(), points.v.data(), 1000, 1, exact.data());
    holdError(state, "error", relativeRms({sampled.begin(), sampled.begin() + 3000}, exact), 4e-7);
}
BENCHMARK(sampling)->Arg(255)->Arg(511)->Unit(benchmark::kMillisecond);

/// The points of a cube map of 4-texel faces by sums, and by grid and interpolation.
void points(benchmark::State& state, bool by_grid) {
    const int degree = static_cast<int>(state.range(0)), size = 4;
    Points texels;
    for (int face = 0; face < 6; ++face) {
        for (int i = 0; i < size * size; ++i) {
            const double a = (i % size + 0.5) / size * 2 - 1, b = (i / size + 0.5) / size * 2 - 1;
            const double x = face < 2 ? 1 - 2 * face : a;
            const double y = face < 2 ? a : face < 4 ? 5 - 2 * face : b;
            const double z = face < 4 ? b : 9 - 2 * face;
            texels.u.push_back(0.5 - std::atan2(x, z) / (2 * kPi));
            texels.v.push_back(std::acos(y / std::hypot(x, y, z)) / kPi);
        }
    }
    const Harmonics f = randomHarmonics(degree);
    const std::vector<double> ones(static_cast<std::size_t>(degree + 1), 1.0);
    std::vector<double> exact, grid;
    std::vector<float> sampled(3 * texels.u.size());
    for (auto _ : state) {
        if (by_grid) {
            const SmoothField field = synthesise(f, ones, degree, 1);
            sampleField(field, texels.u.data(), texels.v.data(), static_cast<int>(texels.u.size()),
                        sampled.data());
        } else {
            benchmark::DoNotOptimize(exact = pointwise(f, degree, texels));
        }
    }
}
BENCHMARK_CAPTURE(points, sums, false)->Arg(63)->Arg(255)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(points, grid, true)->Arg(63)->Arg(255)->Unit(benchmark::kMillisecond);

} // namespace

int main(int argc, char** argv) {
    return ibl::runBenchmarks(argc, argv);
}
