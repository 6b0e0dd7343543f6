#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/prefiltering.h"
#include "cli/session.h"
#include "cli/sh_json.h"

#include "core/error.h"
#include "lights/cut_lights.h"
#include "lights/lights_json.h"

#include <nlohmann/json.hpp>

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace ibl {
namespace {

constexpr int kBands = 3; ///< of coefficients
constexpr std::array kFormats{"exr", "ktx2", "dds"};

struct BakeOptions {
    CommonOptions common;
    ProbeOptions probe;
    QualityOptions quality;
    std::optional<PixelType> type;
    std::string folder;
    std::string format = "exr";
    int size = 256;
    std::optional<int> levels;
    RoughnessMap roughness_map = RoughnessMap::linear;
    int lights = 64;
};

/// The folder of a bake: made if it is not there, and taken away again if nothing came of it.
class BakeFolder {
public:
    explicit BakeFolder(const std::string& path) : path_(path) {
        std::error_code problem;
        if (std::filesystem::exists(path_, problem) && !std::filesystem::is_directory(path_))
            throw outputError(path, "is a file; name a folder");
        made_ = std::filesystem::create_directory(path_, problem);
        if (problem)
            throw outputError(path, "the folder cannot be made (" + problem.message() +
                                        "); name one in a folder that is there and takes files");
    }
    ~BakeFolder() {
        std::error_code ignored; // a folder that holds something stays
        if (made_ && !kept_) std::filesystem::remove(path_, ignored);
    }
    BakeFolder(const BakeFolder&) = delete;
    BakeFolder& operator=(const BakeFolder&) = delete;

    std::string file(const std::string& name) const { return (path_ / name).string(); }
    void keep() { kept_ = true; }

private:
    std::filesystem::path path_;
    bool made_ = false;
    bool kept_ = false;
};

/// What is in the folder, for the program that loads it.
std::string manifest(const BakeOptions& options, const nlohmann::ordered_json& maps,
                     std::size_t lights) {
    nlohmann::ordered_json json;
    json["source"] = options.probe.input;
    json["axes"] = "right-handed, +Y up; faces +X -X +Y -Y +Z -Z as OpenGL samples them";
    json["radiance"] = "scene-linear; diffuse is irradiance / pi";
    const bool faces = options.format == "exr"; // otherwise a file with all faces and levels
    const auto files = [&](const std::string& map, const std::string& level) {
        nlohmann::ordered_json entry;
        if (faces) {
            entry["files"] = map + level + "_{px,nx,py,ny,pz,nz}.exr";
        } else {
            entry["file"] = map + "." + options.format;
        }
        return entry;
    };
    json["diffuse"] = files("diffuse", "");
    json["diffuse"]["size"] = maps[0]["size"];
    auto& levels = json["specular"] = nlohmann::ordered_json::array();
    for (std::size_t k = 1; k < maps.size(); ++k) {
        auto entry = files("specular", "_m" + std::to_string(k - 1));
        for (const char* key : {"size", "kernel", "roughness"})
            entry[key] = maps[k][key];
        levels.push_back(entry);
    }
    json["coefficients"] = {{"file", "sh.json"}, {"convention", "radiance"}, {"order", kBands}};
    json["lights"] = {{"file", "lights.json"}, {"count", lights}};
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

/// From the pixels that `lights` cuts.
LightSet cutLightsOf(const ProbeToPrefilter& probe, const LightRequest& request, int threads) {
    if (!probe.source) return cutLights(probe.latlong.image, request, threads);
    return cutLights(latlongOf(Panorama(*probe.source), threads), request, threads);
}

void runBake(const BakeOptions& options) {
    if (options.folder == "-") {
        throw Error(ExitCode::usage, "-o -: what is baked is a folder; name one");
    }
    Session session("bake", options.common);
    const int levels = options.levels.value_or(maxLevels(options.size));
    if (levels > maxLevels(options.size)) {
        throw Error(ExitCode::usage, "--levels " + std::to_string(levels) + ": a chain of size " +
                                         std::to_string(options.size) + " has at most " +
                                         std::to_string(maxLevels(options.size)) +
                                         " levels; ask for fewer");
    }
    // Irradiance holds nothing finer than a 64-texel face resolves.
    std::vector<PrefilterRequest> requests{
        {{Kernel::lambert, 0}, Layout::faces, std::min(options.size, 64)}};
    for (const PrefilterRequest& level :
         chainRequests(Kernel::ggx, levels, options.roughness_map, Layout::faces, options.size)) {
        requests.push_back(level);
    }
    std::vector<PrefilterRequest> seen = requests;
    seen.push_back(asSeenByCoefficients(kBands));
    const ProbeToPrefilter probe =
        toPrefilter(session, session.readProbe(options.probe), seen, options.quality);
    const auto results = runPrefilter(session, probe, requests, options.quality);
    LightRequest cuts;
    cuts.count = options.lights;
    LightSet lights =
        session.stage("cut", [&] { return cutLightsOf(probe, cuts, session.threads()); });
    lights.source = options.probe.input;

    const ShCoefficients sh = session.stage(
        "project", [&] { return projectProbe(probe.latlong.image, kBands, session.threads()); });

    BakeFolder folder(options.folder);
    WriteOptions how;
    how.smooth = true;
    how.type = options.type.value_or(PixelType::float32);
    how.threads = session.threads();
    session.stage("write", [&] {
        const std::span<const PrefilterResult> chain_levels = std::span(results).subspan(1);
        how.label = labelOf(requests[0].lobe);
        session.write(folder.file("diffuse." + options.format), results[0].map, how);
        const std::string specular = folder.file("specular." + options.format);
        if (isCubeContainer(specular)) {
            std::vector<const Image*> chain;
            for (const PrefilterResult& level : chain_levels)
                chain.push_back(&level.map.image);
            session.write(specular, chain, how);
        } else {
            writeChain(
                session, specular, chain_levels,
                chainLabels(Kernel::ggx, options.roughness_map, std::span(requests).subspan(1)),
                how);
        }
        session.writeText(folder.file("lights.json"), lightsJson(lights, session.threads()));
        session.writeText(folder.file("sh.json"), shJson(sh, options.probe.input, false, 0));
        session.writeText(folder.file("bake.json"),
                          manifest(options, session.results()["maps"], lights.lights.size()));
    });
    for (const char* format : kFormats) {
        const auto left = fileOfMap(folder.file("diffuse." + std::string(format)));
        if (left && format != options.format)
            session.note(*left, "is left of another format; remove it and what else is");
    }
    session.finish();
    folder.keep();
}

} // namespace

Command bindBake(CLI::App& root) {
    CLI::App* app =
        root.add_subcommand("bake", "All that an engine needs: diffuse map, coefficients, GGX "
                                    "chain and lights, with one analysis");
    auto options = std::make_shared<BakeOptions>();
    bindProbe(*app, options->probe);
    app->add_option("-o,--output", options->folder, "Folder to write into; made if it is not there")
        ->required()
        ->type_name("DIR")
        ->group("Output");
    app->add_option("--size", options->size, "Face edge of the chain's first level")
        ->check(inRange(1, kMaxSize))
        ->type_name("N")
        ->capture_default_str()
        ->group("Output");
    app->add_option("--levels", options->levels,
                    "Levels of the chain, roughness 0 to 1 (default: down to a face of 1 texel)")
        ->check(inRange(1, 16))
        ->type_name("K")
        ->group("Output");
    bindRoughnessMap(*app, options->roughness_map)->group("Output");
    app->add_option("--lights", options->lights, "How many median-cut lights, 1 to 65536")
        ->check(inRange(1, 65536))
        ->type_name("N")
        ->capture_default_str()
        ->group("Output");
    app->add_option("--format", options->format,
                    "Of the maps: exr, a file a face and level; ktx2 or dds, one cube map with "
                    "all levels")
        ->check(CLI::IsMember(std::vector<std::string>(kFormats.begin(), kFormats.end())))
        ->type_name("FORMAT")
        ->capture_default_str()
        ->group("Output");
    bindType(*app, options->type);
    bindQuality(*app, options->quality);
    bindCommon(*app, options->common);
    return {app, [options] { runBake(*options); }};
}

} // namespace ibl
