// The subcommands. Each file cmd_NAME.cpp holds a plain options struct, a function that binds it to
// the command line, and a function that runs it.
#pragma once

#include <CLI/CLI.hpp>

#include <functional>

namespace ibl {

/// A subcommand as parsed: `run` is called when `app` was named on the command line.
struct Command {
    CLI::App* app;
    std::function<void()> run;
};

Command bindConvert(CLI::App& root);
Command bindDiffuse(CLI::App& root);
Command bindSpecular(CLI::App& root);
Command bindBrdf(CLI::App& root);
Command bindLights(CLI::App& root);
Command bindRender(CLI::App& root);
Command bindTonemap(CLI::App& root);
Command bindBake(CLI::App& root);
Command bindInfo(CLI::App& root);

} // namespace ibl
