#include "convolve/prefilter.h"

#include "convolve/analysis.h"
#include "convolve/error_bound.h"
#include "convolve/narrow.h"
#include "convolve/plan.h"
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

/// A power of two that brings the probe's largest value near 1, so that neither suns nor denormals
/// leave the range of the sums. Throws on values that are not finite.
double scaleOf(const Image& probe, int threads) {
    std::vector<float> rows(probe.height, 0.0f);
    parallelFor(probe.height, threads, [&](std::size_t j) {
        const float* p = probe.row(static_cast<int>(j));
        float most = 0, finite = 0;
        for (std::size_t i = 0; i < probe.rowFloats(); ++i) {
            most = std::max(most, std::abs(p[i]));
            finite += 0 * p[i]; // NaN unless every value is finite
        }
        rows[j] = finite == 0 ? most : std::numeric_limits<float>::quiet_NaN();
    });
    float most = 0;
    for (const float row : rows) {
        if (!std::isfinite(row)) {
            throw Error(ExitCode::input,
                        "probe: has pixels that are not finite; repair them first");
        }
        most = std::max(most, row);
    }
    return most > 0 ? std::ldexp(1.0, -std::ilogb(most)) : 1;
}

/// What an output's rows are made from; absent parts are null.
struct Ingredients {
    const SmoothField* field = nullptr;
    const std::vector<Peak>* peaks = nullptr;
    const LobeCore* core = nullptr;
    const Image* area = nullptr; ///< area-filtered map, by the core's inner mass
};

struct Probe {
    const Image& image;
    double scale;
    bool negative;
};

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
    for (std::size_t i = 0; parts.core && i < count; ++i) {
        addCore(*parts.core, probe.image, probe.scale, makeAxis(points.u[i], points.v[i]),
                &values[3 * i]);
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
            value /= probe.scale;
            if (parts.area)
                value += parts.core->inner_mass * parts.area->at(points.column[t], y)[c];
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
    std::optional<Harmonics> whole;   ///< of the whole probe, for Method::narrow
    std::vector<double> power;        ///< of `clamped`
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
    const double scale = scaleOf(image, threads);
    Engine engine{
        {image, scale, false}, measureProbe(image, scale, threads), {}, {}, {}, {}, {}, 0, 0};
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
        const double all = peakThreshold(engine.statistics, 0);
        engine.whole = analyse(analyseRows(image, scale, all, degree, threads), degree, threads);
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

/// The direct sum: the core of a lobe of which no part is smooth.
PrefilterResult directSum(const Engine& engine, const PrefilterRequest& request, int threads) {
    const Stopwatch watch;
    PrefilterResult result = emptyResult(request);
    const LobeCore core = makeWholeCore(request.lobe);
    const Footprint footprint = footprintOf(request.lobe, texelAngle(request));
    Ingredients parts;
    parts.core = &core;
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
    fillMap(engine.probe, request, footprintOf(request.lobe, texelAngle(request)), parts, threads,
            result.map.image, norm);
    result.band_limit = degree;
    result.peaks_split = static_cast<int>(engine.peaks.size());
    const SpectrumError error = spectrumError(lobe.k, engine.power, engine.clamped_energy, degree);
    const double size = norm.root() * engine.probe.scale;
    result.error_bound = relative(error.bound, size, norm.texels());
    result.error_estimate = relative(error.estimate, size, 0);
    result.seconds_spatial = watch.seconds() - result.seconds_synthesis;
    return result;
}

PrefilterResult byCore(const Engine& engine, const PrefilterRequest& request, const LobePlan& lobe,
                       double max_error, int threads) {
    const Stopwatch watch;
    PrefilterResult result = emptyResult(request);
    const double texel = texelAngle(request), diameter = 2 * lobeWidth(request.lobe);
    const Footprint footprint = footprintOf(request.lobe, texel);
    const double spacing = footprint.scale * texel / footprint.samples;
    const double inner = diameter < spacing ? 0.5 * spacing : 0;
    const LobeCore core = makeCore(request.lobe, lobe.k, inner, 1e-3 * max_error);
    const SmoothField field = synthesise(*engine.whole, lobe.k, lobe.degree, threads);
    result.seconds_synthesis = watch.seconds();
    Panorama area;
    Ingredients parts;
    parts.field = &field;
    parts.core = &core;
    if (inner > 0) {
        area =
            resample({Layout::latlong, engine.probe.image}, request.layout, request.size, threads);
        parts.area = &area.image;
    }
    MapNorm norm;
    fillMap(engine.probe, request, footprint, parts, threads, result.map.image, norm);
    result.band_limit = lobe.degree;
    // What the taper and the core's rim leave is a thousandth of the asked error, by construction.
    // The footprint's quadrature has no bound of its own yet, and is the larger part where texels
    // are much larger than the lobe.
    result.error_bound = max_error;
    result.error_estimate = 0.1 * max_error;
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
            result =
                byCore(engine, request, engine.plan.lobes[i], options.max_error, options.threads);
        }
        result.seconds_analysis = engine.seconds;
        results.push_back(std::move(result));
    }
    return results;
}

} // namespace ibl
