// Times of lobes too narrow for a band limit, each with its error at some of the texels: the
// brightest, and others spread over the map. Means over whole texels are held against the contour
// integrals of tests/support/contour_oracle.h, values of wider lobes, which are taken at the
// texel's centre or from a shrunk footprint, against direct sums over all pixels. Above what the
// quality asks, or above its own bound, the error fails the benchmark.
//
// Besides a small builtin:sky with its sun the lat-long probes in the folder IBLTOOL_BENCH_PROBES
// are run, if it is set; their texels take seconds each.
#include "convolve/direct.h"
#include "convolve/prefilter.h"
#include "convolve/texels.h"
#include "panorama/builtin.h"
#include "panorama/layouts.h"
#include "panorama/probe_file.h"
#include "panorama/resample.h"
#include "support/contour_oracle.h"

#include "bench_support.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <numeric>
#include <span>

namespace {

using namespace ibl;

/// The function of a lobe of h = sin^2(t/2), from its definition.
std::function<double(double h)> lobeFunction(const Lobe& lobe) {
    if (lobe.kernel == Kernel::phong)
        return [n = lobe.parameter](double h) { return std::exp(n * std::log1p(-2 * h)); };
    const double a2 = std::pow(lobe.parameter, 4);
    return
        [a2](double h) { return std::max(0.0, 1 - 2 * h) * a2 / std::pow(a2 + (1 - a2) * h, 2); };
}

struct Difference {
    double rmse = 0;
    double worst = 0; ///< over the greater of the texel and the map's mean
};

/// At the `bright` brightest texels and at `spread` others.
Difference difference(const Image& probe, const PrefilterRequest& request, const Image& map,
                      std::size_t bright, std::size_t spread) {
    const Image area =
        resample({Layout::latlong, probe}, Layout::faces, request.size, 0, Enlarging::hold).image;
    const oracle::Potential potential = oracle::makePotential(lobeFunction(request.lobe));
    const DirectSum direct = makeDirectSum(request.lobe, probe, 1);
    const MapExtent extent{Layout::faces, map.width, map.height, texelAngle(request)};
    const Footprint footprint = footprintOf(request.lobe, extent.texel, kAnyDegree);
    const auto expectedAt = [&](int x, int row) {
        std::array<double, 3> value{};
        if (footprint.scale == 1) {
            value = oracle::contourChange(probe, potential, row / request.size, x,
                                          row % request.size, request.size);
            for (int c = 0; c < 3; ++c)
                value[static_cast<std::size_t>(c)] += area.at(x, row)[c];
            return value;
        }
        const int samples = footprint.scale > 0 ? footprint.samples + 6 : 1;
        const RowPoints points = texelPoints(extent, x, row, {footprint.scale, samples});
        for (std::size_t i = 0; i < points.u.size(); ++i) {
            double sum[3] = {0, 0, 0};
            addDirect(direct, makeAxis(points.u[i], points.v[i]), sum);
            for (std::size_t c = 0; c < 3; ++c)
                value[c] += points.share[i] * sum[c];
        }
        return value;
    };
    std::vector<std::size_t> texels(static_cast<std::size_t>(map.height) * map.width);
    std::iota(texels.begin(), texels.end(), 0u);
    std::ranges::sort(texels, std::greater(), [&](std::size_t t) { return map.pixels[3 * t + 1]; });
    std::vector<std::size_t> chosen(texels.begin(), texels.begin() + bright);
    for (std::size_t i = 0; i < spread; ++i)
        chosen.push_back(texels[(2 * i + 1) * texels.size() / (2 * spread)]);
    const double mean = std::accumulate(map.pixels.begin(), map.pixels.end(), 0.0) /
                        static_cast<double>(map.pixels.size());
    double error = 0, norm = 0;
    Difference result;
    for (const std::size_t t : chosen) {
        const int x = static_cast<int>(t) % map.width, row = static_cast<int>(t) / map.width;
        const std::array<double, 3> value = expectedAt(x, row);
        for (int c = 0; c < 3; ++c) {
            const double expected = value[static_cast<std::size_t>(c)];
            const double off = map.at(x, row)[c] - expected;
            error += off * off;
            norm += expected * expected;
            result.worst = std::max(result.worst, std::abs(off) / std::max(expected, mean));
        }
    }
    result.rmse = std::sqrt(error / norm);
    return result;
}

void narrow(benchmark::State& state, const Image& probe, const PrefilterRequest& request,
            Quality quality, std::size_t bright, std::size_t spread) {
    PrefilterResult result;
    for (auto _ : state)
        result =
            prefilter({Layout::latlong, probe}, std::span(&request, 1), optionsFor(quality))[0];
    const Difference off = difference(probe, request, result.map.image, bright, spread);
    state.counters["degree"] = result.band_limit;
    state.counters["bound"] = result.error_bound;
    state.counters["worst"] = off.worst;
    holdError(state, "error", off.rmse,
              std::min(optionsFor(quality).max_error, result.error_bound));
}

void addCases(const std::string& name, const std::shared_ptr<const Image>& probe, int size,
              std::size_t bright, std::size_t spread) {
    for (const Lobe lobe : {Lobe{Kernel::ggx, 0.005}, Lobe{Kernel::ggx, 0.03},
                            Lobe{Kernel::ggx, 0.06}, Lobe{Kernel::phong, 1e5}}) {
        for (const Quality quality : {Quality::standard, Quality::high}) {
            const QualityRow& row = kQualities[static_cast<std::size_t>(quality)];
            char label[120];
            std::snprintf(label, sizeof label, "narrow/%s/%s_%g/%d/%s", name.c_str(),
                          lobe.kernel == Kernel::ggx ? "ggx" : "phong", lobe.parameter, size,
                          std::string(row.name).c_str());
            benchmark::RegisterBenchmark(
                label,
                [=](benchmark::State& state) {
                    narrow(state, *probe, {lobe, Layout::faces, size}, quality, bright, spread);
                })
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime()
                ->Iterations(1);
        }
    }
}

} // namespace

int main(int argc, char** argv) {
    addCases("sky", std::make_shared<Image>(builtinProbe("builtin:sky", 32).image), 16, 2, 10);
    if (const char* folder = std::getenv("IBLTOOL_BENCH_PROBES")) {
        std::vector<std::filesystem::path> files;
        for (const auto& entry : std::filesystem::directory_iterator(folder)) {
            const auto extension = entry.path().extension();
            if (extension == ".exr" || extension == ".hdr") files.push_back(entry.path());
        }
        std::ranges::sort(files);
        for (const std::filesystem::path& file : files) {
            const auto probe = std::make_shared<Image>(readProbe(file.string()).panorama.image);
            for (const int size : {64, 256})
                addCases(file.stem().string(), probe, size, 2, 4);
        }
    }
    return ibl::runBenchmarks(argc, argv);
}
