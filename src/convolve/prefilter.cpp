#include "convolve/prefilter.h"

#include "convolve/analysis.h"
#include "convolve/direct.h"
#include "convolve/error_bound.h"
#include "convolve/narrow.h"
#include "convolve/plan.h"
#include "convolve/probe_scale.h"
#include "convolve/synthesis.h"
#include "convolve/texels.h"
#include "core/error.h"
#include "core/parallel.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <string>

namespace ibl {
namespace {

class Stopwatch {
public:
    double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    }

private:
    std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void checkRequests(const Image& probe, std::span<const PrefilterRequest> requests,
                   const PrefilterOptions& options) {
    if (probe.width < 1 || probe.height < 1 || probe.channels != 3) {
        throw Error(ExitCode::usage, "probe: not an RGB image of at least 1x1 pixels; give one");
    }
    if (!(options.max_error > 0)) {
        throw Error(ExitCode::usage, "error: not above 0; give a positive relative error");
    }
    for (const PrefilterRequest& request : requests) {
        checkLobe(request.lobe);
        if (request.size < 1 || request.size > 16384) {
            throw Error(ExitCode::usage, "size: " + std::to_string(request.size) +
                                             " is not in [1, 16384]; give a size in that range");
        }
    }
}

/// What Method::narrow adds to the harmonics.
struct NarrowParts {
    double area_share; ///< of the next
    Image area;        ///< the area-filtered probe without its peaks
    Image whole_area;  ///< and with them; as `area` when there are none
    const std::vector<Peak>& peaks;
};

/// What an output's rows are made from; absent parts are null.
struct Ingredients {
    const SmoothField* field = nullptr;
    const std::vector<Peak>* peaks = nullptr;
    const DirectLobe* direct = nullptr;
    const NarrowParts* narrow = nullptr;
};

struct Probe {
    const Image& image;
    double scale;
    bool negative;
};

void addNarrowRow(const Probe& probe, const PrefilterRequest& request, const Footprint& footprint,
                  const NarrowParts& parts, const RowPoints& points, int y,
                  std::vector<double>& texels) {
    std::vector<double> of_peaks(texels.size());
    for (std::size_t t = 0; t < points.column.size(); ++t) {
        const float *area = parts.area.at(points.column[t], y),
                    *whole = parts.whole_area.at(points.column[t], y);
        for (int c = 0; c < 3; ++c) {
            texels[3 * t + c] = parts.area_share * probe.scale * area[c];
            of_peaks[3 * t + c] = probe.scale * (double{whole[c]} - double{area[c]});
        }
    }
    if (parts.peaks.empty()) return;
    addNarrowPeaks(parts.peaks, probe.image, request.lobe, texelAngle(request), footprint, points,
                   of_peaks, texels);
}

/// Fills row y of the map.
void fillRow(const Probe& probe, const PrefilterRequest& request, const Footprint& footprint,
             const Ingredients& parts, int y, Image& map, MapNorm& norm) {
    const RowPoints points = rowPoints(request.layout, map.width, map.height, y, footprint);
    const std::size_t count = points.u.size();
    std::vector<double> values(3 * count, 0.0);
    if (parts.field) {
        std::vector<float> smooth(3 * count);
        sampleField(*parts.field, points.u.data(), points.v.data(), static_cast<int>(count),
                    smooth.data());
        std::ranges::copy(smooth, values.begin());
    }
    if (parts.peaks) {
        addPeaks(*parts.peaks, probe.image.width, probe.image.height, request.lobe, points.u,
                 points.v, values.data());
    }
    for (std::size_t i = 0; parts.direct && i < count; ++i) {
        addDirect(*parts.direct, probe.image, probe.scale, makeAxis(points.u[i], points.v[i]),
                  &values[3 * i]);
    }
    std::vector<double> narrow(3 * points.column.size(), 0.0);
    if (parts.narrow) {
        addNarrowRow(probe, request, footprint, *parts.narrow, points, y, narrow);
    }
    float* out = map.row(y);
    std::fill(out, out + map.rowFloats(), 0.0f);
    for (std::size_t t = 0; t < points.column.size(); ++t) {
        float* texel = out + std::size_t{3} * points.column[t];
        for (int c = 0; c < 3; ++c) {
            double value = 0;
            for (int s = 0; s < points.per_texel; ++s) {
                const std::size_t i = t * points.per_texel + s;
                value += points.share[i] * values[3 * i + c];
            }
            value = (value + narrow[3 * t + c]) / probe.scale;
            // Rounding and the truncated tails may leave a little below zero beside a sun; a mean
            // of non-negative radiance is not.
            if (!probe.negative) value = std::max(0.0, value);
            texel[c] = static_cast<float>(value);
            norm.add(points.solid_angle[t], value);
        }
    }
}

void fillMap(const Probe& probe, const PrefilterRequest& request, const Footprint& footprint,
             const Ingredients& parts, int threads, Image& map, MapNorm& norm) {
    std::vector<MapNorm> rows(map.height);
    parallelFor(map.height, threads, [&](std::size_t y) {
        fillRow(probe, request, footprint, parts, static_cast<int>(y), map, rows[y]);
    });
    for (const MapNorm& row : rows)
        norm.add(row);
}

/// All that the requests share.
struct Engine {
    Probe probe;
    ProbeStatistics statistics;
    Plan plan;
    std::vector<Peak> peaks;
    std::optional<Harmonics> clamped; ///< of the probe without its peaks, for Method::harmonics
    std::vector<Peak> narrow_peaks;
    std::optional<Harmonics> narrow; ///< of the probe without these, for Method::narrow
    std::vector<double> power;       ///< of `clamped`
    double clamped_energy = 0;
    double seconds = 0;
};

int narrowDegreeOf(const Plan& plan) {
    int degree = -1;
    for (const LobePlan& lobe : plan.lobes) {
        if (lobe.method == Method::narrow) degree = std::max(degree, lobe.degree);
    }
    return degree;
}

bool uses(const Plan& plan, Method method) {
    return std::ranges::any_of(plan.lobes, [&](const LobePlan& l) { return l.method == method; });
}

Engine analyseProbe(const Image& image, std::span<const PrefilterRequest> requests,
                    const PrefilterOptions& options) {
    const Stopwatch watch;
    const int threads = options.threads;
    const double scale = probeScale(image, threads);
    Engine engine{
        {image, scale, false}, measureProbe(image, scale, threads), {}, {}, {}, {}, {}, {}, 0, 0};
    engine.probe.negative = engine.statistics.negative;
    if (options.reference) return engine;
    engine.plan = makePlan(engine.statistics, requests, options.max_error, image.width, threads);
    const Plan& plan = engine.plan;
    if (uses(plan, Method::harmonics)) {
        engine.peaks = splitPeaks(engine.statistics, plan.threshold);
        engine.clamped_energy = clampedEnergy(engine.statistics, plan.threshold);
        const RowSpectrum rows = analyseRows(image, scale, plan.threshold, plan.degree, threads);
        engine.clamped = analyse(rows, plan.degree, threads);
        engine.power = powerSpectrum(*engine.clamped);
    }
    if (const int degree = narrowDegreeOf(plan); degree >= 0) {
        engine.narrow_peaks = splitPeaks(engine.statistics, plan.narrow_threshold);
        engine.narrow = analyse(analyseRows(image, scale, plan.narrow_threshold, degree, threads),
                                degree, threads);
    }
    engine.seconds = watch.seconds();
    return engine;
}

PrefilterResult emptyResult(const PrefilterRequest& request) {
    PrefilterResult result;
    const V2i extent = layoutExtent(request.layout, request.size);
    result.map = {request.layout, Image(extent.x, extent.y)};
    return result;
}

PrefilterResult areaFiltered(const Engine& engine, const PrefilterRequest& request, int threads) {
    const Stopwatch watch;
    PrefilterResult result;
    result.map =
        resample({Layout::latlong, engine.probe.image}, request.layout, request.size, threads);
    result.seconds_spatial = watch.seconds();
    result.error_bound = result.error_estimate = kFloatRounding;
    return result;
}

PrefilterResult directSum(const Engine& engine, const PrefilterRequest& request, int threads) {
    const Stopwatch watch;
    PrefilterResult result = emptyResult(request);
    const DirectLobe direct = makeDirectLobe(request.lobe);
    const Footprint footprint = footprintOf(request.lobe, texelAngle(request), kAnyDegree);
    Ingredients parts;
    parts.direct = &direct;
    MapNorm norm;
    fillMap(engine.probe, request, footprint, parts, threads, result.map.image, norm);
    result.seconds_spatial = watch.seconds();
    result.error_bound = result.error_estimate = kFloatRounding;
    return result;
}

PrefilterResult byHarmonics(const Engine& engine, const PrefilterRequest& request,
                            const LobePlan& lobe, double max_error, int threads) {
    const Stopwatch watch;
    PrefilterResult result = emptyResult(request);
    const std::vector<double> beyond = energyBeyond(engine.power, engine.clamped_energy);
    const double allowed = 0.5 * max_error * referenceNorm(engine.statistics, lobe.k);
    const int degree = std::min(lobe.degree, leastDegree(lobe.k, lobe.degree, allowed, beyond));
    const SmoothField field = synthesise(*engine.clamped, lobe.k, degree, threads);
    result.seconds_synthesis = watch.seconds();
    Ingredients parts;
    parts.field = &field;
    parts.peaks = &engine.peaks;
    MapNorm norm;
    // Peaks have no highest degree.
    const int highest = engine.peaks.empty() ? degree : kAnyDegree;
    const Footprint footprint = footprintOf(request.lobe, texelAngle(request), highest);
    fillMap(engine.probe, request, footprint, parts, threads, result.map.image, norm);
    result.band_limit = degree;
    result.peaks_split = static_cast<int>(engine.peaks.size());
    const SpectrumError error = spectrumError(lobe.k, engine.power, engine.clamped_energy, degree);
    const double size = norm.root() * engine.probe.scale;
    result.error_bound = relative(error.bound, size, norm.texels());
    result.error_estimate = relative(error.estimate, size, 0);
    result.seconds_spatial = watch.seconds() - result.seconds_synthesis;
    return result;
}

PrefilterResult byArea(const Engine& engine, const PrefilterRequest& request, const LobePlan& lobe,
                       int threads) {
    const Stopwatch watch;
    PrefilterResult result = emptyResult(request);
    const NarrowLobe narrow = makeNarrowLobe(request.lobe, lobe.degree);
    const SmoothField field = synthesise(*engine.narrow, narrow.k, lobe.degree, threads);
    result.seconds_synthesis = watch.seconds();
    const double scale = engine.probe.scale, threshold = engine.plan.narrow_threshold;
    const auto areaOf = [&](Image probe) {
        return resample({Layout::latlong, std::move(probe)}, request.layout, request.size, threads)
            .image;
    };
    NarrowParts of_narrow{narrow.area, {}, areaOf(engine.probe.image), engine.narrow_peaks};
    of_narrow.area = engine.narrow_peaks.empty()
                         ? of_narrow.whole_area
                         : areaOf(clampedProbe(engine.probe.image, scale, threshold));
    Ingredients parts;
    parts.field = &field;
    parts.narrow = &of_narrow;
    const double texel = texelAngle(request);
    MapNorm norm;
    fillMap(engine.probe, request, footprintOf(request.lobe, texel, lobe.degree), parts, threads,
            result.map.image, norm);
    result.band_limit = lobe.degree;
    const std::vector<double> power = powerSpectrum(*engine.narrow);
    const double error =
        narrowError(narrow, power, clampedEnergy(engine.statistics, threshold), texel);
    result.peaks_split = static_cast<int>(engine.narrow_peaks.size());
    result.error_estimate = relative(error, norm.root() * scale, 0);
    result.error_bound = kBoundOverEstimate * result.error_estimate;
    result.seconds_spatial = watch.seconds() - result.seconds_synthesis;
    return result;
}

} // namespace

PrefilterOptions optionsFor(Quality quality, int threads) {
    for (const QualityRow& row : kQualities) {
        if (row.quality == quality) return {row.max_error, quality == Quality::reference, threads};
    }
    return {};
}

std::vector<PrefilterResult> prefilter(const Image& latlong,
                                       std::span<const PrefilterRequest> requests,
                                       const PrefilterOptions& options) {
    checkRequests(latlong, requests, options);
    const Engine engine = analyseProbe(latlong, requests, options);
    std::vector<PrefilterResult> results;
    for (std::size_t i = 0; i < requests.size(); ++i) {
        const PrefilterRequest& request = requests[i];
        PrefilterResult result;
        if (isMirror(request.lobe)) {
            result = areaFiltered(engine, request, options.threads);
        } else if (options.reference) {
            result = directSum(engine, request, options.threads);
        } else if (engine.plan.lobes[i].method == Method::harmonics) {
            result = byHarmonics(engine, request, engine.plan.lobes[i], options.max_error,
                                 options.threads);
        } else {
            result = byArea(engine, request, engine.plan.lobes[i], options.threads);
        }
        result.seconds_analysis = engine.seconds;
        results.push_back(std::move(result));
    }
    return results;
}

} // namespace ibl
