#include "convolve/prefilter.h"

#include "convolve/analysis.h"
#include "convolve/direct_map.h"
#include "convolve/error_bound.h"
#include "convolve/evaluate.h"
#include "convolve/fill_map.h"
#include "convolve/peak_map.h"
#include "convolve/plan.h"
#include "convolve/reading_error.h"
#include "convolve/synthesis.h"
#include "convolve/texels.h"
#include "core/error.h"
#include "core/stopwatch.h"
#include "panorama/conventions.h"
#include "panorama/layouts.h"
#include "panorama/resample.h"
#include "panorama/square_maps.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

namespace ibl {
namespace {

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

/// All that the requests share.
struct Engine {
    PlacedProbe probe;
    ProbeStatistics statistics;
    Plan plan;
    std::vector<Peak> peaks;
    std::optional<Harmonics> clamped; ///< of the probe without its peaks, for Method::harmonics
    std::vector<double> power;        ///< of `clamped`
    double clamped_energy = 0;
    std::optional<Harmonics> whole;  ///< of the probe with its peaks, for Method::narrow
    std::vector<double> whole_power; ///< of `whole`
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

Engine analyseProbe(const Panorama& panorama, ProbeStatistics statistics, Plan plan,
                    const PrefilterOptions& options) {
    const Stopwatch watch;
    const int threads = options.threads;
    const Image& image = panorama.image;
    const double scale = statistics.scale;
    Engine engine{{panorama, options.source, image, scale, statistics.negative},
                  std::move(statistics),
                  std::move(plan),
                  {},
                  {},
                  {},
                  0,
                  {},
                  {},
                  0};
    if (uses(engine.plan, Method::harmonics)) {
        const double threshold = engine.plan.threshold;
        const int degree = engine.plan.degree;
        engine.peaks = splitPeaks(engine.statistics, threshold);
        engine.clamped_energy = clampedEnergy(engine.statistics, threshold);
        const RowSpectrum rows = analyseRows(image, scale, threshold, degree, threads);
        engine.clamped = analyse(rows, degree, threads);
        engine.power = powerSpectrum(*engine.clamped);
    }
    if (const int degree = narrowDegreeOf(engine.plan); degree >= 0) {
        engine.whole =
            analyse(analyseRows(image, scale, kNoThreshold, degree, threads), degree, threads);
        engine.whole_power = powerSpectrum(*engine.whole);
    }
    engine.seconds = watch.seconds();
    return engine;
}

PrefilterResult areaFiltered(const Panorama& probe, const PrefilterRequest& request, int threads) {
    const Stopwatch watch;
    PrefilterResult result;
    // Of pixels as areas where the map enlarges them too: what the lobe tends to as it narrows.
    result.map = resample(probe, request.layout, request.size, threads, Enlarging::hold);
    result.seconds_spatial = watch.seconds();
    result.error_bound = result.error_estimate = kFloatRounding;
    result.worst_bound = kFloatRounding;
    return result;
}

/// The relative error of a map by harmonics. Where texels whose horizons run along pixels' edges
/// would take it beyond the asked one, and are few, they are summed directly.
RelativeError errorOfHarmonics(const Engine& engine, const PrefilterRequest& request,
                               const Footprint& footprint, const SpectrumError& error,
                               const MapNorm& norm, double max_error, int threads, Panorama& map) {
    const double size = norm.root() * engine.probe.scale;
    const RelativeError elsewhere = relativeError(error, size, norm.texels());
    const bool is_ring = request.lobe.kernel == Kernel::charlie;
    if (!is_ring && !endsInStep(request.lobe)) return elsewhere;
    const TexelsAlongEdges along = texelsAlongEdges(request, threads);
    const double times = is_ring ? kRingTimes : std::numeric_limits<double>::infinity();
    const RelativeError all = relativeError(error, size, norm.texels(), {along.share, times});
    const double count = static_cast<double>(along.at.size());
    if (all.bound <= max_error || footprint.scale > 0 ||
        !isSummedSoon(engine.probe, request, count)) {
        return all;
    }
    sumDirectly(engine.probe, request, along.at, threads, map);
    return elsewhere;
}

PrefilterResult byHarmonics(const Engine& engine, const PrefilterRequest& request,
                            const LobePlan& lobe, double max_error, int threads) {
    const Stopwatch watch;
    PrefilterResult result = emptyResult(request);
    const std::vector<double> beyond = energyBeyond(engine.power, engine.clamped_energy);
    const double allowed = allowedNorm(engine.statistics, request, lobe.k, max_error);
    const int degree = std::min(lobe.degree, leastDegree(lobe.k, lobe.degree, allowed, beyond));
    const double texel = texelAngle(request);
    const Footprint of_peaks = footprintOf(request.lobe, texel, kAnyDegree);
    const bool apart = isCrossedByHorizons(request.lobe, of_peaks);
    const Footprint footprint = engine.peaks.empty() || apart
                                    ? footprintOf(request.lobe, texel, degree)
                                    : of_peaks; // they have no highest degree
    Ingredients parts{engine.probe.scale, engine.probe.negative};
    SmoothField field;
    MapValues at_points;
    const Image& map = result.map.image;
    if (evaluationIsCheaper(degree, mapPoints(request.layout, map, footprint))) {
        at_points = evaluateMap(*engine.clamped, lobe.k, degree, request.layout, map.width,
                                map.height, footprint, threads);
        parts.at_points = &at_points;
    } else {
        field = synthesise(*engine.clamped, lobe.k, degree, threads);
        parts.field = &field;
    }
    result.seconds_synthesis = watch.seconds();
    const Image& probe = engine.probe.image;
    Image peak_map;
    std::optional<PeakSum> peaks;
    double outlines_error = 0;
    if (apart && !engine.peaks.empty()) {
        peak_map = peakMap(engine.peaks, engine.probe.scale, probe.width, probe.height, request,
                           of_peaks, threads);
        outlines_error = kPeakMapError;
        parts.map = &peak_map;
    } else {
        peaks = makePeakSum(engine.peaks, probe.width, probe.height, request.lobe);
        parts.peaks = &*peaks;
    }
    MapNorm norm;
    fillMap(request, footprint, parts, threads, result.map, norm);
    result.band_limit = degree;
    result.peaks_split = static_cast<int>(engine.peaks.size());
    const SpectrumError error = spectrumError(lobe.k, engine.power, engine.clamped_energy, degree);
    const RelativeError relative_error =
        errorOfHarmonics(engine, request, footprint, error, norm, max_error, threads, result.map);
    const bool by_points = norm.root() > 0 && (footprint.samples > 1 || isBallMap(request.layout));
    double within = by_points ? kFootprintError : 0;
    if (!engine.peaks.empty() && isSquareMap(request.layout) && texel > kFewTexels)
        within = std::max(within, kPeakInSquareTexel);
    result.error_bound = std::hypot(relative_error.bound + within, outlines_error);
    result.error_estimate = std::hypot(relative_error.estimate, within / 3, outlines_error / 3);
    const double mean = norm.absolute() * engine.probe.scale / (12 * kPi);
    result.worst_bound = relative(error.pointwise, mean) + 10 * (within + outlines_error) +
                         roundingOfBrightest(result.map.image, norm);
    result.seconds_spatial = watch.seconds() - result.seconds_synthesis;
    return result;
}

PrefilterResult inTwoParts(const Engine& engine, const PrefilterRequest& request,
                           const LobePlan& lobe, double max_error, int threads) {
    const Stopwatch watch;
    PrefilterResult result = emptyResult(request);
    const double texel = texelAngle(request);
    const LobeSplit split = splitLobe(request.lobe, lobe.k, lobe.degree, lobe.allowed);
    Ingredients parts{engine.probe.scale, engine.probe.negative};
    SmoothField field;
    if (split.degree > 0) {
        field = synthesise(*engine.whole, split.k, split.degree, threads);
        parts.field = &field;
    }
    result.seconds_synthesis = watch.seconds();
    const Footprint near_footprint = footprintOf(request.lobe, texel, kAnyDegree);
    const NearRules& rules = nearRulesFor(engine.probe, request.lobe, max_error);
    const Image near = nearMapOf(engine.probe, split.near, rules, request, near_footprint, threads);
    parts.map = &near;
    MapNorm norm;
    fillMap(request, footprintOf(request.lobe, texel, split.degree), parts, threads, result.map,
            norm);
    result.band_limit = split.degree;
    if (split.degree > 0) {
        const SpectrumError error =
            spectrumError(split.k, engine.whole_power, engine.statistics.energy, split.degree);
        const RelativeError far =
            relativeError(error, norm.root() * engine.probe.scale, norm.texels());
        result.error_bound = far.bound + kFootprintError;
        result.error_estimate = far.estimate;
    }
    // Half of the error is what may be left (allowedNorm).
    const double beyond_reach = 2 * kBeyondReach * 0.5 * max_error;
    result.error_bound = std::hypot(result.error_bound, rules.error) + beyond_reach;
    result.error_estimate = std::hypot(result.error_estimate, rules.error / 3, beyond_reach / 3);
    result.seconds_spatial = watch.seconds() - result.seconds_synthesis;
    return result;
}

PrefilterResult byMethod(const Engine& engine, const PrefilterRequest& request,
                         const LobePlan& lobe, const PrefilterOptions& options) {
    switch (lobe.method) {
    case Method::area:
        return areaFiltered(options.source ? *options.source : engine.probe.panorama, request,
                            options.threads);
    case Method::harmonics:
        return byHarmonics(engine, request, lobe, options.max_error, options.threads);
    default:
        return inTwoParts(engine, request, lobe, options.max_error, options.threads);
    }
}

/// Narrow lobes' near pixels have an error that no band limit makes less: told before the work.
void requireReachable(std::span<const Plan> plans, double max_error) {
    const double least = nearRules(max_error).error;
    const auto narrow = [](const LobePlan& lobe) { return lobe.method == Method::narrow; };
    const bool any = std::ranges::any_of(
        plans, [&](const Plan& plan) { return std::ranges::any_of(plan.lobes, narrow); });
    if (!any || least < max_error) return;
    char text[160];
    std::snprintf(
        text, sizeof text,
        "--max-error %g cannot be met: of lobes as narrow as this the bound of the relative "
        "RMSE is %g at least; allow a larger error",
        max_error, least);
    throw Error(ExitCode::accuracy, text);
}

/// Adds to the results' errors what reading the probe into this lat-long left.
void addReading(const Image& latlong, const Panorama& source,
                std::span<const PrefilterRequest> requests, bool reference, int threads,
                std::vector<PrefilterResult>& results) {
    const std::vector<ReadingError> errors =
        readingErrors(latlong, source, requests, reference, threads);
    for (std::size_t i = 0; i < errors.size(); ++i) {
        results[i].error_bound += errors[i].bound;
        results[i].error_estimate = std::hypot(results[i].error_estimate, errors[i].estimate);
        if (results[i].worst_bound) *results[i].worst_bound += errors[i].worst;
    }
}

} // namespace

PrefilterOptions optionsFor(Quality quality, int threads) {
    for (const QualityRow& row : kQualities) {
        if (row.quality == quality) return {row.max_error, quality == Quality::reference, threads};
    }
    return {};
}

std::vector<PrefilterResult> prefilter(const Panorama& latlong,
                                       std::span<const PrefilterRequest> requests,
                                       const PrefilterOptions& options) {
    checkRequests(latlong.image, requests, options);
    const Stopwatch watch;
    ProbeStatistics statistics = measureProbe(latlong.image, options.threads);
    if (options.source) // one that keeps moments is below zero beside bright pixels
        statistics.negative =
            std::ranges::any_of(options.source->image.pixels, [](float p) { return p < 0; });
    const double seconds_measuring = watch.seconds();
    std::size_t rows = 0;
    for (const PrefilterRequest& request : requests)
        rows += layoutExtent(request.layout, request.size).y;
    Progress progress(options.progress, rows);
    std::vector<PrefilterResult> results(requests.size());
    if (options.reference) {
        const Engine engine = analyseProbe(latlong, statistics, {}, options);
        for (std::size_t i = 0; i < requests.size(); ++i) {
            results[i] = isMirror(requests[i].lobe)
                             ? areaFiltered(options.source ? *options.source : latlong, requests[i],
                                            options.threads)
                             : directMap(engine.probe, requests[i], options.threads, progress);
            results[i].seconds_analysis = seconds_measuring;
        }
        if (options.source)
            addReading(latlong.image, *options.source, requests, options.reference, options.threads,
                       results);
        return results;
    }
    PrefilterOptions planned = options;
    planned.max_error = std::max(0.25 * options.max_error,
                                 options.max_error - kFootprintError - 2 * kFloatRounding);
    const std::vector<Plan> plans = makePlans(statistics, requests, planned.max_error,
                                              latlong.image.width, options.source, options.threads);
    requireReachable(plans, options.max_error);
    for (const Plan& plan : plans) {
        const Engine engine = analyseProbe(latlong, statistics, plan, options);
        for (std::size_t k = 0; k < plan.lobes.size(); ++k) {
            const PrefilterRequest& request = requests[plan.requests[k]];
            PrefilterResult& result = results[plan.requests[k]];
            result = byMethod(engine, request, plan.lobes[k], planned);
            if (result.error_bound > options.max_error &&
                isSummedSoon(engine.probe, request, texelCount(request))) {
                result = directMap(engine.probe, request, options.threads, progress);
            }
            result.seconds_analysis = seconds_measuring + engine.seconds;
        }
    }
    if (options.source)
        addReading(latlong.image, *options.source, requests, options.reference, options.threads,
                   results);
    return results;
}

} // namespace ibl
