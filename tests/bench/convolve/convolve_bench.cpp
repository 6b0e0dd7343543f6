// Times of whole prefilters, files left out, on all threads, each with the error it makes.
//
// The error is the relative RMSE against the same request at 1e-7, whose agreement with the direct
// sum the unit tests hold. Above what was asked, or above its own bound, it fails the benchmark.
// Besides builtin:sky the probes (lat-longs) in the folder IBLTOOL_BENCH_PROBES are run, if it is
// set.
#include "convolve/prefilter.h"
#include "panorama/builtin.h"
#include "panorama/probe_file.h"

#include "bench_support.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <span>

namespace {

using namespace ibl;

const Image& sky(int height) {
    static std::map<int, Image> probes;
    if (!probes.contains(height)) probes[height] = builtinProbe("builtin:sky", height).image;
    return probes[height];
}

/// Relative RMSE over texels, each face's solid angles taken as one: the error's order is meant.
double relativeRmse(const Image& a, const Image& b) {
    return relativeRms({a.pixels.begin(), a.pixels.end()}, {b.pixels.begin(), b.pixels.end()});
}

/// One lobe at 10^-n.
void lobe(benchmark::State& state, const Lobe& which) {
    const double asked = std::pow(10.0, -static_cast<double>(state.range(0)));
    const PrefilterRequest request{which, Layout::faces, 64};
    const Image& probe = sky(512);
    PrefilterResult result;
    for (auto _ : state)
        result = prefilter({Layout::latlong, probe}, std::span(&request, 1), {asked, false, 0})[0];
    const PrefilterResult exact =
        prefilter({Layout::latlong, probe}, std::span(&request, 1), {1e-7, false, 0})[0];
    const double error = relativeRmse(result.map.image, exact.map.image);
    state.counters["estimate"] = result.error_estimate;
    state.counters["bound"] = result.error_bound;
    state.counters["degree"] = result.band_limit;
    state.counters["peaks"] = result.peaks_split;
    holdError(state, "error", error, std::min(asked, result.error_bound));
}
void qualities(benchmark::internal::Benchmark* benchmark) {
    benchmark->DenseRange(3, 5)->Unit(benchmark::kMillisecond)->UseRealTime();
}
BENCHMARK_CAPTURE(lobe, lambert, Lobe{Kernel::lambert, 0})->Apply(qualities);
BENCHMARK_CAPTURE(lobe, ggx_025, Lobe{Kernel::ggx, 0.25})->Apply(qualities);
BENCHMARK_CAPTURE(lobe, phong_100, Lobe{Kernel::phong, 100})->Apply(qualities);

std::vector<PrefilterRequest> chainRequests() {
    std::vector<PrefilterRequest> requests;
    for (int k = 0; k < 9; ++k)
        requests.push_back({{Kernel::ggx, k / 8.0}, Layout::faces, 256 >> k});
    return requests;
}

/// Nine levels of GGX from 256-texel faces at 1e-4; the error is the largest of a level that has
/// texels enough to speak of one.
void chain(benchmark::State& state, const Image& probe) {
    const std::vector<PrefilterRequest> requests = chainRequests();
    std::vector<PrefilterResult> results;
    for (auto _ : state)
        results = prefilter({Layout::latlong, probe}, requests, {1e-4, false, 0});
    const std::vector<PrefilterResult> exact =
        prefilter({Layout::latlong, probe}, requests, {1e-6, false, 0});
    double worst = 0;
    for (std::size_t i = 0; i + 3 < results.size(); ++i)
        worst = std::max(worst, relativeRmse(results[i].map.image, exact[i].map.image));
    state.counters["analysis_ms"] = 1e3 * results[0].seconds_analysis;
    holdError(state, "error", worst, 1e-4);
}

} // namespace

int main(int argc, char** argv) {
    for (const int height : {256, 512, 1024}) {
        benchmark::RegisterBenchmark(
            ("chain/sky/" + std::to_string(height)).c_str(),
            [height](benchmark::State& state) { chain(state, sky(height)); })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
    }
    std::vector<std::filesystem::path> files;
    if (const char* folder = std::getenv("IBLTOOL_BENCH_PROBES")) {
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            const auto extension = entry.path().extension();
            if (extension == ".exr" || extension == ".hdr") files.push_back(entry.path());
        }
        std::ranges::sort(files);
    }
    for (const std::filesystem::path& file : files) {
        benchmark::RegisterBenchmark(("chain/" + file.stem().string()).c_str(),
                                     [file](benchmark::State& state) {
                                         chain(state, readProbe(file.string()).panorama.image);
                                     })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
    }
    return ibl::runBenchmarks(argc, argv);
}
