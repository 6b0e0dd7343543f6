#include "cli/prefiltering.h"
#include "cli/render_options.h"

#include "core/error.h"
#include "panorama/resample.h"
#include "panorama/square_maps.h"
#include "render/probe_levels.h"

#include <nlohmann/json.hpp>

#include <bit>
#include <cmath>

namespace ibl {
namespace {

constexpr int kDiffuseEdge = 64;
constexpr int kTableSize = 128;
// Of a chain over all roughness: faces of 256 to 8 texels.
constexpr int kChainLevels = 6, kChainEdge = 256;
constexpr int kLargestEdge = 1024;

/// The face edge at which a lobe of that roughness is interpolated to about 1e-3 of its peak: the
/// texel is 0.18 alpha, a tenth of the lobe's deviation.
int lobeEdge(double roughness) {
    const double wanted = 11 / std::max(roughness * roughness, 1e-3);
    return std::clamp(static_cast<int>(std::bit_ceil(static_cast<unsigned>(wanted))), 16,
                      kChainEdge);
}

/// The requests of the lobe's maps; `specular` gets their roughnesses.
std::vector<PrefilterRequest> specularRequests(const Panorama& probe, const Material& material,
                                               SpecularMaps& specular) {
    if (material.own || !material.fixed) {
        specular.first = 0;
        specular.last = 1;
        return chainRequests(Kernel::ggx, kChainLevels, RoughnessMap::linear, Layout::faces,
                             kChainEdge);
    }
    const double roughness = material[Parameter::roughness].x;
    specular.first = specular.last = roughness;
    const int edge = roughness > 0 ? lobeEdge(roughness) : std::min(cubeEdge(probe), kLargestEdge);
    return {{{Kernel::ggx, roughness}, Layout::faces, edge}};
}

struct ReadMap {
    Panorama panorama;
    MapLabel label;
};

ReadMap readMap(Session& session, const std::string& path) {
    ProbeOptions options;
    options.input = path;
    ProbeFile file = session.readScreened(options);
    ReadMap map{std::move(file.panorama), std::move(file.metadata.label)};
    if (isSquareMap(map.panorama.layout)) {
        map.panorama = {Layout::latlong, latlongOf(std::move(map.panorama), session.threads(),
                                                   Enlarging::interpolate)};
    }
    return map;
}

Panorama readDiffuse(Session& session, const std::string& path) {
    ReadMap map = readMap(session, path);
    if (!map.label.kernel.empty() && map.label.kernel != kernelRow(Kernel::lambert).name) {
        throw inputError(path, "is no diffuse map but " + describe(map.label) +
                                   "; name what ibltool diffuse has written");
    }
    return std::move(map.panorama);
}

/// Throws unless a labelled level is the one that its name says, of the chain that level 0 began.
void checkLevel(const std::string& name, const MapLabel& label, int level, int levels) {
    if (!label.kernel.empty() && label.kernel != kernelRow(Kernel::ggx).name) {
        throw inputError(name,
                         "is " + describe(label) + "; --specular-map takes ggx, as bake writes it");
    }
    if (label.levels != levels || (levels > 0 && label.level != level)) {
        throw inputError(name, "is not of the chain that level 0 is of (" + describe(label) +
                                   "); write all levels again");
    }
    if (levels > 1 && label.roughness &&
        std::abs(*label.roughness - levelRoughness(RoughnessMap::linear, level, levels)) > 1e-6) {
        throw inputError(name, "is " + describe(label) +
                                   "; --specular-map takes roughness level / (levels - 1), "
                                   "--roughness-map linear");
    }
}

/// What `specular --levels K` and `bake` write, roughness k / (K - 1). Levels that an earlier,
/// longer chain has left are passed over where level 0 says how many there are.
SpecularMaps readSpecular(Session& session, const std::string& path) {
    if (isCubeContainer(path)) {
        throw inputError(path, "KTX and DDS containers are written but not read; give a chain of "
                               "EXR files");
    }
    SpecularMaps maps;
    int levels = 0;
    for (int k = 0; levels > 0 ? k < levels : fileOfMap(levelName(path, k)).has_value(); ++k) {
        const auto [level, label] = readMap(session, levelName(path, k));
        if (k == 0) levels = label.levels;
        checkLevel(levelName(path, k), label, k, levels);
        const int edge =
            k == 0 ? level.layout == Layout::latlong || level.layout == Layout::exrLatlong
                         ? std::max(1, level.image.height / 2)
                         : *layoutSize(level.layout, level.image.width, level.image.height)
                   : maps.levels[0].image.width >> k;
        if (edge == 0) {
            throw inputError(levelName(path, k), "is one level more than the first one's size "
                                                 "has; remove it");
        }
        maps.levels.push_back(resample(level, Layout::faces, edge, session.threads()));
    }
    if (maps.levels.size() < 2) {
        throw inputError(path, "wants two levels or more, " + levelName(path, 0) + ", " +
                                   levelName(path, 1) +
                                   "; make them with ibltool specular --levels");
    }
    maps.last = 1;
    return maps;
}

void requireUse(bool used, const char* option, const std::string& why) {
    if (!used) throw Error(ExitCode::usage, std::string(option) + " " + why + "; leave it out");
}

} // namespace

void bindMaps(CLI::App& app, MapArguments& arguments) {
    app.add_option("--diffuse-map", arguments.diffuse,
                   "Irradiance / pi, as diffuse and bake write it, instead of a convolution")
        ->type_name("FILE")
        ->group("Material");
    app.add_option("--specular-map", arguments.specular,
                   "GGX chain FILE_m0, FILE_m1 ..., as specular --levels and bake write it")
        ->type_name("FILE")
        ->group("Material");
}

RenderMaps prepareMaps(Session& session, const ProbeOptions& options, const MapArguments& arguments,
                       const Scene& scene, bool probe_needed) {
    const Material& material = scene.material;
    const MapNeeds needs = mapNeeds(material);
    requireUse(arguments.diffuse.empty() || needs.diffuse, "--diffuse-map",
               "is not read by this material");
    requireUse(arguments.specular.empty() || needs.specular, "--specular-map",
               "is not read by this material");
    const bool convolve_diffuse = needs.diffuse && arguments.diffuse.empty();
    const bool convolve_specular = needs.specular && arguments.specular.empty();

    RenderMaps maps;
    if (probe_needed || needsProbe(material, scene.background) || convolve_diffuse ||
        convolve_specular || needs.probe_levels) {
        maps.probe = session.readProbe(options);
        // Textures hold lat-longs and cubes.
        if (isSquareMap(maps.probe.layout)) {
            maps.probe = {Layout::latlong, latlongOf(std::move(maps.probe), session.threads(),
                                                     Enlarging::interpolate)};
        }
    }
    std::vector<PrefilterRequest> requests;
    if (convolve_specular) requests = specularRequests(maps.probe, material, maps.specular);
    if (convolve_diffuse) requests.push_back({{Kernel::lambert, 0}, Layout::faces, kDiffuseEdge});
    if (!requests.empty()) {
        const ProbeToPrefilter probe = toPrefilter(session, Panorama(maps.probe), requests, {});
        std::vector<PrefilterResult> results = runPrefilter(session, probe, requests, {});
        if (convolve_diffuse) {
            maps.diffuse = std::move(results.back().map);
            results.pop_back();
        }
        for (PrefilterResult& result : results)
            maps.specular.levels.push_back(std::move(result.map));
    }
    if (!arguments.diffuse.empty()) maps.diffuse = readDiffuse(session, arguments.diffuse);
    if (!arguments.specular.empty()) maps.specular = readSpecular(session, arguments.specular);
    if (needs.split_sum) {
        SplitSumOptions table{kTableSize, true, false, session.threads()};
        table.masking = material.specular.masking;
        if (!material.own && material.fixed) table.roughness = material[Parameter::roughness].x;
        maps.split_sum = session.stage("split-sum", [&] { return splitSumTable(table).image; });
    }
    if (needs.probe_levels) {
        maps.probe_levels =
            session.stage("levels", [&] { return probeLevels(maps.probe, session.threads()); });
    }
    return maps;
}

void RenderMaps::show(Scene& scene) const {
    scene.probe = probe.image.pixels.empty() ? nullptr : &probe;
    scene.diffuse = diffuse.image.pixels.empty() ? nullptr : &diffuse;
    scene.specular = specular.levels.empty() ? nullptr : &specular;
    scene.split_sum = split_sum.pixels.empty() ? nullptr : &split_sum;
    scene.probe_levels = probe_levels.empty() ? nullptr : &probe_levels;
}

} // namespace ibl
