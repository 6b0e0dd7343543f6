#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/prefiltering.h"
#include "cli/session.h"

#include <memory>

namespace ibl {
namespace {

struct DiffuseOptions {
    CommonOptions common;
    ProbeOptions probe;
    ImageOutputOptions output;
    QualityOptions quality;
    Layout to = Layout::faces;
    std::optional<int> size;
};

void runDiffuse(const DiffuseOptions& options) {
    Session session("diffuse", options.common);
    const WriteOptions how = writeOptions(options.output, options.common, options.to);
    const Image latlong = latlongOf(session.readProbe(options.probe), session.threads());
    const bool is_latlong = options.to == Layout::latlong;
    const PrefilterRequest request{
        {Kernel::lambert, 0}, options.to, options.size.value_or(is_latlong ? 128 : 64)};
    const auto results = runPrefilter(session, latlong, {&request, 1}, options.quality);
    session.stage("write", [&] { session.write(options.output.output, results[0].map, how); });
    session.finish();
}

} // namespace

Command bindDiffuse(CLI::App& root) {
    CLI::App* app =
        root.add_subcommand("diffuse", "Irradiance map (irradiance / pi: a constant stays itself)");
    auto options = std::make_shared<DiffuseOptions>();
    bindProbe(*app, options->probe);
    bindImageOutput(*app, options->output);
    bindTarget(*app, options->to, options->size, "64; lat-long 128");
    bindQuality(*app, options->quality);
    bindCommon(*app, options->common);
    return {app, [options] { runDiffuse(*options); }};
}

} // namespace ibl
