#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/prefiltering.h"
#include "cli/session.h"

#include "core/error.h"

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
};

std::vector<PrefilterRequest> requestsOf(const SpecularOptions& options) {
    const int size = options.size.value_or(options.to == Layout::latlong ? 512 : 256);
    if (options.levels) {
        if (*options.levels > maxLevels(size)) {
            throw Error(ExitCode::usage, "--levels " + std::to_string(*options.levels) +
                                             ": a chain of size " + std::to_string(size) +
                                             " has at most " + std::to_string(maxLevels(size)) +
                                             " levels; ask for fewer");
        }
        if (options.output.output == "-") {
            throw Error(
                ExitCode::usage,
                "-: a chain is several files and does not fit standard output; name a file");
        }
        return chainRequests(options.kernel, *options.levels, options.to, size);
    }
    const bool ggx = options.kernel == Kernel::ggx;
    const std::optional<double>& parameter = ggx ? options.roughness : options.exponent;
    if (!parameter || (ggx ? options.exponent : options.roughness)) {
        throw Error(ExitCode::usage, ggx ? "--kernel ggx wants --roughness or --levels"
                                         : "--kernel phong wants --exponent or --levels");
    }
    return {{{options.kernel, *parameter}, options.to, size}};
}

void runSpecular(const SpecularOptions& options) {
    Session session("specular", options.common);
    const WriteOptions how = writeOptions(options.output, options.common);
    const std::vector<PrefilterRequest> requests = requestsOf(options);
    const Image latlong = latlongOf(session.readProbe(options.probe), session.threads());
    const auto results = runPrefilter(session, latlong, requests, options.quality);
    session.stage("write", [&] {
        for (std::size_t k = 0; k < results.size(); ++k) {
            const std::string name = options.levels
                                         ? levelName(options.output.output, static_cast<int>(k))
                                         : options.output.output;
            session.write(name, results[k].map, how);
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
           [o = options.get()](const std::string& name) {
               o->kernel = name == "ggx" ? Kernel::ggx : Kernel::phong;
           },
           "Lobe: ggx (default) or phong")
        ->check(CLI::IsMember({"ggx", "phong"}))
        ->type_name("NAME")
        ->group("Lobe");
    CLI::Option* roughness =
        app->add_option("--roughness", options->roughness,
                        "Perceptual roughness of a ggx lobe, 0 to 1 (alpha is its square)")
            ->check(CLI::Range(0.0, 1.0))
            ->type_name("R")
            ->group("Lobe");
    CLI::Option* exponent =
        app->add_option("--exponent", options->exponent, "Exponent of a phong lobe cos^n, 0 to 1e6")
            ->check(CLI::Range(0.0, 1e6))
            ->type_name("N")
            ->excludes(roughness)
            ->group("Lobe");
    app->add_option("--levels", options->levels,
                    "A chain: roughness 0 to 1 in K levels, each half the size of the one before; "
                    "for phong the exponent is 2 / roughness^4 - 2")
        ->check(CLI::Range(1, 16))
        ->type_name("K")
        ->excludes(roughness)
        ->excludes(exponent)
        ->group("Lobe");
    bindImageOutput(*app, options->output);
    bindTarget(*app, options->to, options->size, "256; lat-long 512");
    bindQuality(*app, options->quality);
    bindCommon(*app, options->common);
    return {app, [options] { runSpecular(*options); }};
}

} // namespace ibl
