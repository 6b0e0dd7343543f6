#include "cli/prefiltering.h"

#include "core/error.h"

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
    switch (request.lobe.kernel) {
    case Kernel::lambert:
        json["kernel"] = "lambert";
        break;
    case Kernel::ggx:
        json["kernel"] = "ggx";
        json["roughness"] = request.lobe.parameter;
        break;
    case Kernel::phong:
        json["kernel"] = "phong";
        json["exponent"] = request.lobe.parameter;
        break;
    }
    json["error_bound"] = result.error_bound;
    json["error_estimate"] = result.error_estimate;
    json["band_limit"] = result.band_limit;
    json["peaks_split"] = result.peaks_split;
    json["seconds"] = {{"analysis", result.seconds_analysis},
                       {"synthesis", result.seconds_synthesis},
                       {"spatial", result.seconds_spatial}};
    return json;
}

void requireError(const PrefilterResult& result, double asked) {
    if (result.error_estimate <= asked) return;
    char text[160];
    std::snprintf(text, sizeof text,
                  "--max-error %g cannot be met: the estimated relative RMSE is %.2g; ask for more "
                  "or use --quality reference",
                  asked, result.error_estimate);
    throw Error(ExitCode::accuracy, text);
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
        ->check(CLI::Range(1e-6, 1.0))
        ->excludes(quality)
        ->type_name("E")
        ->group("Accuracy");
}

std::vector<PrefilterResult> runPrefilter(Session& session, const Image& latlong,
                                          std::span<const PrefilterRequest> requests,
                                          const QualityOptions& quality) {
    PrefilterOptions options = optionsFor(quality.quality, session.threads());
    if (quality.max_error) options.max_error = *quality.max_error;
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

std::vector<PrefilterRequest> chainRequests(Kernel kernel, int levels, Layout layout, int size) {
    std::vector<PrefilterRequest> requests;
    for (int k = 0; k < levels; ++k) {
        const double roughness = levels == 1 ? 0 : static_cast<double>(k) / (levels - 1);
        PrefilterRequest request{{Kernel::ggx, roughness}, layout, size >> k};
        if (kernel == Kernel::phong && k > 0) {
            const double exponent = 2 / std::pow(roughness, 4) - 2;
            request.lobe = {Kernel::phong, std::clamp(exponent, 0.0, 1e6)};
        }
        requests.push_back(request);
    }
    return requests;
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
