#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/session.h"

#include "lights/lights_json.h"
#include "lights/median_cut.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace ibl {
namespace {

struct LightsOptions {
    CommonOptions common;
    ProbeOptions probe;
    int count = 64;
    std::string method = "median";
    std::string output = "-";
};

void runLights(const LightsOptions& options) {
    Session session("lights", options.common);
    const Image latlong = latlongOf(session.readProbe(options.probe), session.threads());
    const std::vector<Light> lights =
        session.stage("cut", [&] { return medianCut(latlong, options.count, session.threads()); });
    if (lights.empty()) {
        session.note(options.probe.input, "black: no lights");
    } else if (static_cast<int>(lights.size()) < options.count) {
        session.note(options.probe.input, "only " + std::to_string(lights.size()) + " of " +
                                              std::to_string(options.count) +
                                              " lights: no more pixels have energy");
    }
    session.results()["lights"] = lights.size();
    session.writeText(options.output, lightsJson(lights, options.probe.input, options.method));
    session.finish();
}

} // namespace

Command bindLights(CLI::App& root) {
    CLI::App* app = root.add_subcommand("lights", "Directional lights by median cut, as JSON");
    auto options = std::make_shared<LightsOptions>();
    bindProbe(*app, options->probe);
    app->add_option("-n,--count", options->count, "How many lights, 1 to 65536")
        ->check(CLI::Range(1, 65536))
        ->type_name("N")
        ->capture_default_str();
    app->add_option("--method", options->method, "How the probe is cut: median (Debevec 2005)")
        ->check(CLI::IsMember({"median"}))
        ->type_name("NAME")
        ->capture_default_str();
    app->add_option("-o,--output", options->output, "JSON file to write, - for standard output")
        ->type_name("OUT")
        ->capture_default_str()
        ->group("Output");
    bindCommon(*app, options->common);
    return {app, [options] { runLights(*options); }};
}

} // namespace ibl
