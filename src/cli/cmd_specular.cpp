#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/prefiltering.h"
#include "cli/session.h"

#include "core/error.h"

#include <algorithm>
#include <cstdio>
#include <memory>

namespace ibl {
namespace {

struct SpecularOptions {
    CommonOptions common;
    ProbeOptions probe;
    ImageOutputOptions output;
    QualityOptions quality;
    Layout to = Layout::faces;
    std::optional<int> size;
    Kernel kernel = Kernel::ggx;
    std::optional<double> roughness;
    std::optional<double> exponent;
    std::optional<int> levels;
    RoughnessMap roughness_map = RoughnessMap::linear;
};

std::vector<std::string> kernelNames() {
    std::vector<std::string> names;
    for (const KernelRow& row : kKernels)
        names.emplace_back(row.name);
    return names;
}

std::string kernelHelp() {
    std::string rows;
    for (const KernelRow& row : kKernels)
        rows +=
            (rows.empty() ? "" : "; ") + std::string(row.name) + ": " + std::string(row.summary);
    return rows;
}

/// The kernels of a kind of parameter, with its range: "ggx 0 to 1, charlie 0.05 to 1".
std::string rangesOf(KernelParameter parameter) {
    std::string text;
    for (const KernelRow& row : kKernels) {
        if (row.parameter != parameter) continue;
        char range[64];
        std::snprintf(range, sizeof range, " %g to %g", row.least, row.most);
        text += (text.empty() ? "" : ", ") + std::string(row.name) + range;
    }
    return text;
}

Kernel kernelFromName(const std::string& name) {
    return std::ranges::find(kKernels, name, &KernelRow::name)->kernel;
}

/// The lobe that --kernel and its parameter ask for.
Lobe lobeOf(const SpecularOptions& options) {
    const KernelRow& row = kernelRow(options.kernel);
    const std::string name(row.name);
    if (row.parameter == KernelParameter::none) {
        if (options.roughness || options.exponent)
            throw Error(ExitCode::usage, "--kernel " + name +
                                             " has no parameter; leave out --roughness and "
                                             "--exponent");
        return {options.kernel, 0};
    }
    const bool rough = row.parameter == KernelParameter::roughness;
    const std::optional<double>& parameter = rough ? options.roughness : options.exponent;
    if (!parameter || (rough ? options.exponent : options.roughness)) {
        throw Error(ExitCode::usage, "--kernel " + name + " wants " +
                                         (rough ? "--roughness" : "--exponent") + " or --levels");
    }
    const Lobe lobe{options.kernel, *parameter};
    checkLobe(lobe);
    return lobe;
}

std::vector<PrefilterRequest> requestsOf(const SpecularOptions& options, const WriteOptions& how) {
    const int size = options.size.value_or(options.to == Layout::latlong ? 512 : 256);
    if (options.levels) {
        if (*options.levels > maxLevels(size)) {
            throw Error(ExitCode::usage, "--levels " + std::to_string(*options.levels) +
                                             ": a chain of size " + std::to_string(size) +
                                             " has at most " + std::to_string(maxLevels(size)) +
                                             " levels; ask for fewer");
        }
        if (options.output.output == "-" && !isCubeContainer("-", how)) {
            throw Error(
                ExitCode::usage,
                "-: a chain is several files and does not fit standard output; name a file");
        }
        return chainRequests(options.kernel, *options.levels, options.roughness_map, options.to,
                             size);
    }
    return {{lobeOf(options), options.to, size}};
}

void runSpecular(const SpecularOptions& options) {
    Session session("specular", options.common);
    WriteOptions how = writeOptions(options.output, options.common, options.to);
    const std::vector<PrefilterRequest> requests = requestsOf(options, how);
    how.smooth = options.levels || !isMirror(requests[0].lobe);
    const ProbeToPrefilter probe =
        toPrefilter(session, session.readProbe(options.probe), requests, options.quality);
    const auto results = runPrefilter(session, probe, requests, options.quality);
    if (options.levels) reportRoughness(session, 0, *options.levels, options.roughness_map);
    session.stage("write", [&] {
        const std::string& output = options.output.output;
        if (options.levels && isCubeContainer(output, how)) {
            std::vector<const Image*> levels;
            for (const PrefilterResult& level : results)
                levels.push_back(&level.map.image);
            session.write(output, levels, how);
            return;
        }
        if (options.levels) {
            writeChain(session, output, results,
                       chainLabels(options.kernel, options.roughness_map, requests), how);
        } else {
            how.label = labelOf(requests[0].lobe);
            session.write(output, results[0].map, how);
        }
    });
    session.finish();
}

} // namespace

Command bindSpecular(CLI::App& root) {
    CLI::App* app =
        root.add_subcommand("specular", "Specular prefilter: one lobe or a chain of levels");
    auto options = std::make_shared<SpecularOptions>();
    bindProbe(*app, options->probe);
    app->add_option_function<std::string>(
           "--kernel",
           [o = options.get()](const std::string& name) { o->kernel = kernelFromName(name); },
           "Lobe (default ggx). " + kernelHelp())
        ->check(CLI::IsMember(kernelNames()))
        ->type_name("NAME")
        ->group("Lobe");
    CLI::Option* roughness = app->add_option("--roughness", options->roughness,
                                             "Perceptual roughness (alpha is its square): " +
                                                 rangesOf(KernelParameter::roughness))
                                 ->check(inRange(0.0, 1.0))
                                 ->type_name("R")
                                 ->group("Lobe");
    CLI::Option* exponent = app->add_option("--exponent", options->exponent,
                                            "Exponent: " + rangesOf(KernelParameter::exponent))
                                ->check(inRange(0.0, 1e6))
                                ->type_name("N")
                                ->excludes(roughness)
                                ->group("Lobe");
    CLI::Option* levels =
        app->add_option("--levels", options->levels,
                        "A chain: roughness 0 (the probe, area-filtered) to 1 in K levels, each "
                        "half the size of the one before; exponents are 2 / roughness^4 - 2")
            ->check(inRange(1, 16))
            ->type_name("K")
            ->excludes(roughness)
            ->excludes(exponent)
            ->group("Lobe");
    bindRoughnessMap(*app, options->roughness_map)->needs(levels);
    bindImageOutput(*app, options->output);
    bindTarget(*app, options->to, options->size, "256; lat-long 512");
    bindQuality(*app, options->quality);
    bindCommon(*app, options->common);
    return {app, [options] { runSpecular(*options); }};
}

} // namespace ibl
