#include "cli/prefiltering.h"

#include "core/error.h"
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

void requireError(const PrefilterResult& result, double asked) {
    if (result.error_bound <= asked) return;
    char text[240];
    std::snprintf(
        text, sizeof text,
        "--max-error %g cannot be met: with harmonics up to degree %d and %d bright pixels "
        "apart the bound of the relative RMSE is %.2g (estimate %.2g); allow a larger error, or "
        "use --quality reference",
        asked, result.band_limit, result.peaks_split, result.error_bound, result.error_estimate);
    throw Error(ExitCode::accuracy, text);
}

double errorOf(const QualityOptions& quality) {
    return quality.max_error.value_or(optionsFor(quality.quality).max_error);
}

/// How many times finer than the probe its lat-long is. Pixels of other layouts have their edges
/// across a lat-long's: as many of these as the probe has leave an error of 7e-4 to 4e-3 in diffuse
/// maps of faces of 16 texels, 6e-5 to 3e-4 of 64 and 2e-5 to 9e-5 of 128 (pisa, studio, sunset),
/// this many 1e-5 to 5e-5 and about 1e-5. Square maps are read at the price of a polygon a pixel.
int readingFactor(const Panorama& probe, double error) {
    int most = error < 1e-4 ? 2048 : error < 1e-3 ? 1024 : 256;
    if (isSquareMap(probe.layout)) most = std::min(most, 256);
    const int height = latlongHeight(probe);
    int factor = 1;
    while (factor < 16 && 2 * factor * height <= most)
        factor *= 2;
    return factor;
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

Panorama toPrefilter(Panorama&& probe, int threads, const QualityOptions& quality) {
    if (probe.layout == Layout::latlong) return std::move(probe);
    const int finer = readingFactor(probe, errorOf(quality));
    return {Layout::latlong, latlongOf(std::move(probe), threads, Enlarging::hold, finer)};
}

std::vector<PrefilterResult> runPrefilter(Session& session, const Panorama& latlong,
                                          std::span<const PrefilterRequest> requests,
                                          const QualityOptions& quality) {
    PrefilterOptions options = optionsFor(quality.quality, session.threads());
    if (quality.max_error) options.max_error = *quality.max_error;
    options.progress = session.progress("convolve");
    std::vector<PrefilterResult> results =
        session.stage("convolve", [&] { return prefilter(latlong, requests, options); });
    auto& maps = session.results()["maps"] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < results.size(); ++i) {
        if (quality.max_error) requireError(results[i], *quality.max_error);
        maps.push_back(jsonOf(requests[i], results[i]));
    }
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
