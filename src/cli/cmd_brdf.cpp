#include "cli/arguments.h"
#include "cli/commands.h"
#include "cli/session.h"

#include "convolve/split_sum.h"

#include <nlohmann/json.hpp>

#include <memory>

namespace ibl {
namespace {

struct BrdfOptions {
    CommonOptions common;
    ImageOutputOptions output;
    SplitSumOptions table;
};

void runBrdf(const BrdfOptions& options) {
    Session session("brdf", options.common);
    const WriteOptions how = writeOptions(options.output, options.common);
    SplitSumOptions table = options.table;
    table.threads = session.threads();
    const SplitSumTable result = session.stage("integrate", [&] { return splitSumTable(table); });
    auto& json = session.results();
    json["size"] = table.size;
    json["terms"] = table.multiscatter ? "multiscatter" : "split-sum";
    json["channels"] = {table.multiscatter ? "bias" : "scale",
                        table.multiscatter ? "total" : "bias", table.cloth ? "cloth" : "zero"};
    json["error_estimate"] = result.error_estimate;
    session.stage("write", [&] { session.write(options.output.output, result.image, how); });
    session.finish();
}

} // namespace

Command bindBrdf(CLI::App& root) {
    CLI::App* app =
        root.add_subcommand("brdf", "Split-sum table (DFG): reflectance by N.V and roughness");
    auto options = std::make_shared<BrdfOptions>();
    app->add_option_function<std::string>(
           "--terms",
           [o = options.get()](const std::string& name) {
               o->table.multiscatter = name == "multiscatter";
           },
           "Red and green: split-sum (default) is scale and bias, F0 scale + bias; multiscatter is "
           "bias and total, mix(bias, total, F0)")
        ->check(CLI::IsMember({"split-sum", "multiscatter"}))
        ->type_name("NAME")
        ->group("Table");
    app->add_flag("--cloth", options->table.cloth,
                  "Blue: the cloth lobe's reflectance (Charlie, Neubelt's visibility), else 0")
        ->group("Table");
    app->add_option("--size", options->table.size, "Edge of the table in texels")
        ->check(inRange(1, 4096))
        ->type_name("N")
        ->capture_default_str()
        ->group("Table");
    bindImageOutput(*app, options->output);
    bindCommon(*app, options->common);
    return {app, [options] { runBrdf(*options); }};
}

} // namespace ibl
