#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/prefiltering.h"
#include "cli/session.h"
#include "cli/sh_json.h"

#include "convolve/sh_window.h"
#include "core/error.h"

#include <nlohmann/json.hpp>

#include <map>
#include <memory>

namespace ibl {
namespace {

enum class ShWindow { none, automatic };

struct ShOptions {
    std::string file;
    int order = 3;
    ShConvention convention = ShConvention::radiance;
    std::optional<ShWindow> window;
};

struct DiffuseOptions {
    CommonOptions common;
    ProbeOptions probe;
    ImageOutputOptions output;
    QualityOptions quality;
    Layout to = Layout::faces;
    std::optional<int> size;
    ShOptions sh;
};

/// Refuses what has no effect: options of the map without -o, of the coefficients without --sh.
void checkOutputs(const CLI::App& app, const DiffuseOptions& options) {
    const bool map = !options.output.output.empty(), sh = !options.sh.file.empty();
    if (!map && !sh) {
        throw Error(ExitCode::usage, "--output: missing; name a file for the map with -o, or one "
                                     "for coefficients with --sh");
    }
    if (options.output.output == "-" && options.sh.file == "-") {
        throw Error(ExitCode::usage, "--sh -: standard output is the map's already; name a file");
    }
    const auto refuse = [&](std::initializer_list<const char*> names, const char* without) {
        for (const char* name : names) {
            if (app.count(name) > 0) {
                throw Error(ExitCode::usage, std::string(name) + ": has no effect without " +
                                                 without + "; leave it out or add " + without);
            }
        }
    };
    if (!map) {
        refuse(
            {"--format", "--type", "--compression", "--to", "--size", "--quality", "--max-error"},
            "-o");
    }
    if (!sh) refuse({"--sh-order", "--sh-convention", "--sh-window"}, "--sh");
    if (options.sh.convention == ShConvention::filament && options.sh.order > 3) {
        throw Error(ExitCode::usage, "--sh-order " + std::to_string(options.sh.order) +
                                         ": filament takes 3 bands or fewer; ask for fewer");
    }
}

std::string coefficientsText(Session& session, const Image& latlong, const ShOptions& sh,
                             const std::string& source) {
    ShCoefficients coefficients = toConvention(
        session.stage("project",
                      [&] { return projectProbe(latlong, sh.order, session.threads()); }),
        sh.convention);
    const bool windowed = sh.window.value_or(sh.convention == ShConvention::radiance
                                                 ? ShWindow::none
                                                 : ShWindow::automatic) == ShWindow::automatic;
    double lambda = 0;
    if (windowed) {
        lambda = session.stage("window", [&] { return leastDamping(coefficients, source); });
        coefficients = damp(coefficients, lambda);
        session.results()["sh_lambda"] = lambda;
    }
    return shJson(coefficients, source, windowed, lambda);
}

void runDiffuse(const CLI::App& app, const DiffuseOptions& options) {
    Session session("diffuse", options.common);
    checkOutputs(app, options);
    const bool has_map = !options.output.output.empty();
    WriteOptions how;
    if (has_map) how = writeOptions(options.output, options.common, options.to);
    how.smooth = true;
    const bool is_latlong = options.to == Layout::latlong;
    const PrefilterRequest request{
        {Kernel::lambert, 0}, options.to, options.size.value_or(is_latlong ? 128 : 64)};
    std::vector<PrefilterRequest> seen;
    if (has_map) seen.push_back(request);
    if (!options.sh.file.empty()) seen.push_back(asSeenByCoefficients(options.sh.order));
    const ProbeToPrefilter probe =
        toPrefilter(session, session.readProbe(options.probe), seen, options.quality);
    std::vector<PrefilterResult> results;
    if (has_map) results = runPrefilter(session, probe, {&request, 1}, options.quality);
    const std::string sh =
        options.sh.file.empty()
            ? ""
            : coefficientsText(session, probe.latlong.image, options.sh, options.probe.input);
    session.stage("write", [&] {
        how.label = labelOf({Kernel::lambert, 0});
        if (has_map) session.write(options.output.output, results[0].map, how);
        if (!sh.empty()) session.writeText(options.sh.file, sh);
    });
    session.finish();
}

void bindSh(CLI::App& app, ShOptions& options) {
    app.add_option("--sh", options.file,
                   "JSON file of spherical-harmonic coefficients to write, - for standard output")
        ->type_name("FILE")
        ->group("Coefficients");
    app.add_option("--sh-order", options.order, "Bands, 1 to 20 (N^2 coefficients)")
        ->check(inRange(1, kMaxShOrder))
        ->type_name("N")
        ->capture_default_str()
        ->group("Coefficients");
    const std::map<std::string, ShConvention> conventions{{"radiance", ShConvention::radiance},
                                                          {"irradiance", ShConvention::irradiance},
                                                          {"filament", ShConvention::filament}};
    app.add_option_function<std::string>(
           "--sh-convention",
           [&options, conventions](const std::string& name) {
               options.convention = conventions.at(name);
           },
           "radiance (default; three.js), irradiance, or filament (at most 3 bands)")
        ->check(CLI::IsMember({"radiance", "irradiance", "filament"}))
        ->type_name("NAME")
        ->group("Coefficients");
    const std::map<std::string, ShWindow> windows{{"none", ShWindow::none},
                                                  {"auto", ShWindow::automatic}};
    app.add_option_function<std::string>(
           "--sh-window",
           [&options, windows](const std::string& name) { options.window = windows.at(name); },
           "none, or auto: the least damping that leaves nothing negative (default: none "
           "for radiance, else auto)")
        ->check(CLI::IsMember({"none", "auto"}))
        ->type_name("NAME")
        ->group("Coefficients");
}

} // namespace

Command bindDiffuse(CLI::App& root) {
    CLI::App* app =
        root.add_subcommand("diffuse", "Irradiance map (irradiance / pi: a constant stays itself)");
    auto options = std::make_shared<DiffuseOptions>();
    bindProbe(*app, options->probe);
    bindImageOutput(*app, options->output);
    app->get_option("--output")->required(false);
    bindTarget(*app, options->to, options->size, "64; lat-long 128");
    bindSh(*app, options->sh);
    bindQuality(*app, options->quality);
    bindCommon(*app, options->common);
    return {app, [app, options] { runDiffuse(*app, *options); }};
}

} // namespace ibl
