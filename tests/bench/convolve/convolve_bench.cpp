// Times of the prefilter's stages and of whole prefilters, each with the error it makes.
#include "convolve/analysis.h"
#include "convolve/prefilter.h"
#include "convolve/synthesis.h"
#include "panorama/builtin.h"

#include <benchmark/benchmark.h>

#include <cmath>
#include <limits>
#include <map>

namespace {

using namespace ibl;

constexpr double kNoThreshold = std::numeric_limits<double>::infinity();

const Image& sky(int height) {
    static std::map<int, Image> probes;
    if (!probes.contains(height)) probes[height] = builtinProbe("builtin:sky", height).image;
    return probes[height];
}

double relativeRmse(const Image& a, const Image& b) {
    double error = 0, norm = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i) {
        error += std::pow(double{a.pixels[i]} - b.pixels[i], 2);
        norm += std::pow(double{b.pixels[i]}, 2);
    }
    return std::sqrt(error / norm);
}

void rows(benchmark::State& state) {
    const int height = static_cast<int>(state.range(0)), degree = static_cast<int>(state.range(1));
    for (auto _ : state) {
        benchmark::DoNotOptimize(analyseRows(sky(height), 1, kNoThreshold, degree, 0));
    }
}
BENCHMARK(rows)->Args({512, 255})->Args({1024, 255})->Args({1024, 511})->UseRealTime();

void analysis(benchmark::State& state) {
    const int degree = static_cast<int>(state.range(0));
    const RowSpectrum spectrum = analyseRows(sky(512), 1, kNoThreshold, degree, 0);
    for (auto _ : state)
        benchmark::DoNotOptimize(analyse(spectrum, degree, 0));
}
BENCHMARK(analysis)->Arg(255)->Arg(511)->Arg(1023)->Unit(benchmark::kMillisecond)->UseRealTime();

void synthesis(benchmark::State& state) {
    const int degree = static_cast<int>(state.range(0));
    const Harmonics f = analyse(analyseRows(sky(512), 1, kNoThreshold, degree, 0), degree, 0);
    const std::vector<double> k(degree + 1, 1.0);
    for (auto _ : state)
        benchmark::DoNotOptimize(synthesise(f, k, degree, 0));
}
BENCHMARK(synthesis)->Arg(255)->Arg(511)->Arg(1023)->Unit(benchmark::kMillisecond)->UseRealTime();

/// One lobe at a quality; `error` is the relative RMSE against 1e-7 by the same engine, whose own
/// agreement with the oracle the unit tests hold.
void lobe(benchmark::State& state, const Lobe& which) {
    const double asked = std::pow(10.0, -static_cast<double>(state.range(0)));
    const PrefilterRequest request{which, Layout::faces, 64};
    PrefilterResult result;
    for (auto _ : state)
        result = prefilter(sky(512), std::span(&request, 1), {asked, false, 0})[0];
    const PrefilterResult exact = prefilter(sky(512), std::span(&request, 1), {1e-7, false, 0})[0];
    state.counters["error"] = relativeRmse(result.map.image, exact.map.image);
    state.counters["estimate"] = result.error_estimate;
    state.counters["bound"] = result.error_bound;
    state.counters["degree"] = result.band_limit;
    state.counters["peaks"] = result.peaks_split;
}
BENCHMARK_CAPTURE(lobe, lambert, Lobe{Kernel::lambert, 0})
    ->DenseRange(3, 5)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(lobe, ggx_025, Lobe{Kernel::ggx, 0.25})
    ->DenseRange(3, 5)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(lobe, phong_100, Lobe{Kernel::phong, 100})
    ->DenseRange(3, 5)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void chain(benchmark::State& state) {
    std::vector<PrefilterRequest> requests;
    for (int k = 0; k < 9; ++k) {
        requests.push_back({{Kernel::ggx, k / 8.0}, Layout::faces, 256 >> k});
    }
    std::vector<PrefilterResult> results;
    for (auto _ : state) {
        results = prefilter(sky(static_cast<int>(state.range(0))), requests, {1e-4, false, 0});
    }
    double estimate = 0;
    for (const PrefilterResult& result : results)
        estimate = std::max(estimate, result.error_estimate);
    state.counters["estimate"] = estimate;
    state.counters["analysis_s"] = results[0].seconds_analysis;
}
BENCHMARK(chain)->Arg(512)->Arg(1024)->Unit(benchmark::kMillisecond)->UseRealTime();

} // namespace

BENCHMARK_MAIN();
