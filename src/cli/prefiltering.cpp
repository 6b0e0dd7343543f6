#include "cli/prefiltering.h"

#include "convolve/reading_error.h"
#include "core/error.h"
#include "panorama/latlong_moments.h"
#include "panorama/square_maps.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>

namespace ibl {
namespace {

std::vector<std::string> qualityNames() {
    std::vector<std::string> names;
    for (const QualityRow& row : kQualities)
        names.emplace_back(row.name);
    return names;
}

Quality qualityFromName(const std::string& name) {
    return std::find_if(kQualities.begin(), kQualities.end(),
                        [&](const QualityRow& row) { return row.name == name; })
        ->quality;
}

nlohmann::ordered_json jsonOf(const PrefilterRequest& request, const PrefilterResult& result) {
    nlohmann::ordered_json json;
    json["layout"] = layoutName(request.layout);
    json["size"] = request.size;
    const KernelRow& kernel = kernelRow(request.lobe.kernel);
    json["kernel"] = kernel.name;
    if (kernel.parameter == KernelParameter::roughness) json["roughness"] = request.lobe.parameter;
    if (kernel.parameter == KernelParameter::exponent) json["exponent"] = request.lobe.parameter;
    json["error_bound"] = result.error_bound;
    json["error_estimate"] = result.error_estimate;
    if (result.worst_bound) json["worst_texel_bound"] = *result.worst_bound;
    json["band_limit"] = result.band_limit;
    json["peaks_split"] = result.peaks_split;
    json["seconds"] = {{"analysis", result.seconds_analysis},
                       {"synthesis", result.seconds_synthesis},
                       {"spatial", result.seconds_spatial}};
    return json;
}

/// Which map, where there are several.
std::string whichOf(std::span<const PrefilterResult> results, std::size_t i) {
    return results.size() > 1 ? " of map " + std::to_string(i) : "";
}

/// `which` as whichOf gives it.
void requireError(const ProbeToPrefilter& probe, const PrefilterResult& result,
                  const std::string& which, double asked) {
    if (result.error_bound <= asked) return;
    const std::string read =
        probe.source ? "read into " + std::to_string(probe.latlong.image.height) + " rows and "
                     : "";
    char text[320];
    std::snprintf(
        text, sizeof text,
        "--max-error %g cannot be met: %swith harmonics up to degree %d and %d bright pixels "
        "apart the bound of the relative RMSE%s is %.3g (estimate %.2g); allow a larger error%s",
        asked, read.c_str(), result.band_limit, result.peaks_split, which.c_str(),
        result.error_bound, result.error_estimate,
        probe.source ? "" : ", or use --quality reference");
    throw Error(ExitCode::accuracy, text);
}

/// Says of which map the bound is the farthest above the quality's error, if of any.
void noteError(Session& session, std::span<const PrefilterResult> results, Quality quality) {
    const QualityRow& row = *std::ranges::find(kQualities, quality, &QualityRow::quality);
    const auto worst = std::ranges::max_element(results, {}, &PrefilterResult::error_bound);
    if (worst == results.end() || worst->error_bound <= row.max_error) return;
    const std::string which = whichOf(results, worst - results.begin());
    char text[160];
    std::snprintf(text, sizeof text,
                  "not proven: the error bound%s is %.3g (estimate %.2g), not %g; --max-error "
                  "would refuse it",
                  which.c_str(), worst->error_bound, worst->error_estimate, row.max_error);
    session.note("--quality " + std::string(row.name), text);
}

double errorOf(const QualityOptions& quality) {
    return quality.max_error.value_or(optionsFor(quality.quality).max_error);
}

/// Rows beyond which no lat-long is read that keeps the probe's resolution without. Square maps, at
/// the price of a polygon a pixel, are read into fewer where they are large and no more is asked
/// for.
int mostRows(const Panorama& probe, double error) {
    const bool large = isSquareMap(probe.layout) && probe.image.height > 512;
    const bool fewer = large && error > optionsFor(Quality::high).max_error;
    return std::max(latlongHeight(probe), fewer ? 1024 : 2048);
}

/// By which the error of reading falls, about, from one lat-long to one of twice as many rows.
constexpr double kRowsFall = 13;

/// The rows that a probe is first read into: its own number halved or doubled, even and from 256
/// on, from where on the error falls as it should.
int firstRows(const Panorama& probe) {
    int rows = latlongHeight(probe);
    while (rows < 256 || rows % 2 == 1)
        rows *= 2;
    while (rows >= 512 && rows % 4 == 0)
        rows /= 2;
    return rows;
}

} // namespace

void bindQuality(CLI::App& app, QualityOptions& options) {
    std::string rows;
    for (const QualityRow& row : kQualities) {
        rows +=
            (rows.empty() ? "" : "; ") + std::string(row.name) + ": " + std::string(row.summary);
    }
    CLI::Option* quality =
        app.add_option_function<std::string>(
               "--quality",
               [&options](const std::string& name) { options.quality = qualityFromName(name); },
               "Accuracy against speed (default standard). " + rows)
            ->check(CLI::IsMember(qualityNames()))
            ->type_name("NAME")
            ->group("Accuracy");
    app.add_option("--max-error", options.max_error,
                   "Relative RMSE to keep instead of a quality's, from 1e-6 to 1")
        ->check(inRange(1e-6, 1.0))
        ->excludes(quality)
        ->type_name("E")
        ->group("Accuracy");
}

namespace {

/// A lat-long for a probe of another layout, with so many rows that reading it takes four tenths of
/// the error asked for, if that can be (near weights take up to six: nearRules).
Panorama readFor(const Panorama& probe, std::span<const PrefilterRequest> requests, double asked,
                 bool reference, int threads) {
    const double allowed = 0.4 * asked;
    const auto read = [&](int rows) { return latlongOfMoments(probe, rows, threads); };
    const auto errorOfReading = [&](const Panorama& latlong) {
        double error = 0;
        for (const ReadingError& e :
             readingErrors(latlong.image, probe, requests, reference, threads))
            error = std::max(error, e.bound);
        return error;
    };
    int rows = firstRows(probe);
    Panorama latlong = read(rows);
    double error = errorOfReading(latlong);
    const int most = mostRows(probe, asked);
    while (error > allowed && 2 * rows <= most) {
        for (; error > allowed && 2 * rows <= most; error /= kRowsFall)
            rows *= 2;
        latlong = read(rows);
        error = errorOfReading(latlong);
    }
    // Twice as many as ever only if they are enough and these are hardly.
    if (error > 0.5 * asked && error / kRowsFall <= allowed && !isSquareMap(probe.layout))
        latlong = read(2 * rows);
    return latlong;
}

} // namespace

ProbeToPrefilter toPrefilter(Session& session, Panorama&& probe,
                             std::span<const PrefilterRequest> requests,
                             const QualityOptions& quality) {
    if (probe.layout == Layout::latlong) return {std::move(probe), std::nullopt};
    Panorama latlong = session.stage("resample", [&] {
        return readFor(probe, requests, errorOf(quality),
                       quality.quality == Quality::reference && !quality.max_error,
                       session.threads());
    });
    return {std::move(latlong), std::move(probe)};
}

PrefilterRequest asSeenByCoefficients(int order) {
    return {{Kernel::phong, static_cast<double>(order) * order}};
}

std::vector<PrefilterResult> runPrefilter(Session& session, const ProbeToPrefilter& probe,
                                          std::span<const PrefilterRequest> requests,
                                          const QualityOptions& quality) {
    PrefilterOptions options = optionsFor(quality.quality, session.threads());
    if (quality.max_error) options.max_error = *quality.max_error;
    options.progress = session.progress("convolve");
    if (probe.source) options.source = &*probe.source;
    std::vector<PrefilterResult> results =
        session.stage("convolve", [&] { return prefilter(probe.latlong, requests, options); });
    auto& maps = session.results()["maps"] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < results.size(); ++i) {
        if (quality.max_error)
            requireError(probe, results[i], whichOf(results, i), *quality.max_error);
        maps.push_back(jsonOf(requests[i], results[i]));
    }
    if (!quality.max_error && !options.reference) noteError(session, results, quality.quality);
    return results;
}

int maxLevels(int size) {
    return static_cast<int>(std::bit_width(static_cast<unsigned>(size)));
}

CLI::Option* bindRoughnessMap(CLI::App& app, RoughnessMap& map) {
    std::vector<std::string> names;
    std::string rows;
    for (const RoughnessMapRow& row : kRoughnessMaps) {
        names.emplace_back(row.name);
        rows += (rows.empty() ? "" : "; ") + names.back() + ": " + std::string(row.formula);
    }
    return app
        .add_option_function<std::string>(
            "--roughness-map",
            [&map](const std::string& name) {
                map = std::ranges::find(kRoughnessMaps, name, &RoughnessMapRow::name)->map;
            },
            "Roughness of level k of the chain, lod = k / (K - 1) (default linear). " + rows)
        ->check(CLI::IsMember(names))
        ->type_name("NAME")
        ->group("Lobe");
}

double levelRoughness(RoughnessMap map, int k, int levels) {
    if (levels == 1) return 0;
    const double lod = static_cast<double>(k) / (levels - 1);
    switch (map) {
    case RoughnessMap::square:
        return lod * lod;
    case RoughnessMap::filament:
        return 1 - std::sqrt(1 - lod);
    case RoughnessMap::linear:
        break;
    }
    return lod;
}

std::vector<PrefilterRequest> chainRequests(Kernel kernel, int levels, RoughnessMap map,
                                            Layout layout, int size) {
    const KernelRow& row = kernelRow(kernel);
    if (row.parameter == KernelParameter::none) {
        throw Error(ExitCode::usage, "--kernel " + std::string(row.name) +
                                         " has no roughness to make a chain of; leave out "
                                         "--levels");
    }
    std::vector<PrefilterRequest> requests{{{Kernel::ggx, 0}, layout, size}};
    for (int k = 1; k < levels; ++k) {
        const double roughness = levelRoughness(map, k, levels);
        Lobe lobe{kernel, roughness};
        if (row.parameter == KernelParameter::exponent) {
            lobe.parameter = std::clamp(2 / std::pow(roughness, 4) - 2, row.least, row.most);
        } else if (roughness < row.least) {
            char text[160];
            std::snprintf(text, sizeof text,
                          "--levels %d: level %d has roughness %.3g and %s begins at %g; ask for "
                          "fewer levels or another --roughness-map",
                          levels, k, roughness, std::string(row.name).c_str(), row.least);
            throw Error(ExitCode::usage, text);
        }
        requests.push_back({lobe, layout, size >> k});
    }
    return requests;
}

void reportRoughness(Session& session, std::size_t first, int levels, RoughnessMap map) {
    for (int k = 0; k < levels; ++k) {
        session.results()["maps"][first + static_cast<std::size_t>(k)]["roughness"] =
            levelRoughness(map, k, levels);
    }
}

MapLabel labelOf(const Lobe& lobe) {
    const KernelRow& row = kernelRow(lobe.kernel);
    MapLabel label;
    label.kernel = row.name;
    const auto parameter = static_cast<float>(lobe.parameter);
    if (row.parameter == KernelParameter::roughness) label.roughness = parameter;
    if (row.parameter == KernelParameter::exponent) label.exponent = parameter;
    return label;
}

std::vector<MapLabel> chainLabels(Kernel kernel, RoughnessMap map,
                                  std::span<const PrefilterRequest> requests) {
    const int levels = static_cast<int>(requests.size());
    std::vector<MapLabel> labels;
    for (int k = 0; k < levels; ++k) {
        MapLabel& label = labels.emplace_back(labelOf(requests[static_cast<std::size_t>(k)].lobe));
        label.kernel = kernelRow(kernel).name; // level 0 is asked for as a mirror of GGX
        label.roughness = static_cast<float>(levelRoughness(map, k, levels));
        label.level = k;
        label.levels = levels;
    }
    return labels;
}

void writeChain(Session& session, const std::string& path, std::span<const PrefilterResult> levels,
                std::span<const MapLabel> labels, WriteOptions options) {
    for (std::size_t k = 0; k < levels.size(); ++k) {
        options.label = labels[k];
        session.write(levelName(path, static_cast<int>(k)), levels[k].map, options);
    }
    if (const auto left = fileOfMap(levelName(path, static_cast<int>(levels.size()))))
        session.note(*left, "is left of a longer chain; remove it and what else is");
}

std::optional<std::string> fileOfMap(const std::string& path) {
    for (const std::string& name : {path, probeFileNames(path, Layout::faces)[0]}) {
        std::error_code ignored;
        if (std::filesystem::exists(name, ignored)) return name;
    }
    return std::nullopt;
}

std::string levelName(const std::string& path, int level) {
    const std::filesystem::path whole(path);
    std::filesystem::path name = whole;
    name.replace_extension();
    name += "_m" + std::to_string(level);
    name += whole.extension();
    return name.string();
}

} // namespace ibl
