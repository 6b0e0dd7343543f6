#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/session.h"

#include "panorama/layouts.h"
#include "panorama/resample.h"

#include <memory>

namespace ibl {
namespace {

struct ConvertOptions {
    CommonOptions common;
    ProbeOptions probe;
    ImageOutputOptions output;
    Layout to = Layout::faces;
    std::optional<int> size;
};

/// The size at which a layout holds about what the source holds: a lat-long's row is as high as a
/// face's texel at a quarter turn for two faces' edges, and a square map has about as many texels
/// as the cube of half its edge.
int matchingSize(const Panorama& source, Layout to) {
    const int size = *layoutSize(source.layout, source.image.width, source.image.height);
    const auto isCube = [](Layout l) { return isCubeFamily(l) || l == Layout::exrCube; };
    if (isCube(source.layout) == isCube(to)) return size;
    return isCube(source.layout) ? 2 * size : std::max(1, size / 2);
}

void runConvert(const ConvertOptions& options) {
    Session session("convert", options.common);
    const WriteOptions how = writeOptions(options.output, options.common, options.to);
    const Panorama source = session.readProbe(options.probe);
    const int size = options.size.value_or(matchingSize(source, options.to));
    const Panorama result = session.stage(
        "resample", [&] { return resample(source, options.to, size, session.threads()); });
    session.stage("write", [&] { session.write(options.output.output, result, how); });
    session.results() = {{"layout", layoutName(options.to)}, {"size", size}};
    session.finish();
}

} // namespace

Command bindConvert(CLI::App& root) {
    CLI::App* app = root.add_subcommand("convert", "Convert a probe between layouts and formats");
    auto options = std::make_shared<ConvertOptions>();
    bindProbe(*app, options->probe);
    bindImageOutput(*app, options->output);
    bindTarget(*app, options->to, options->size, "what keeps the probe's resolution");
    bindCommon(*app, options->common);
    return {app, [options] { runConvert(*options); }};
}

} // namespace ibl
