#include "cli/commands.h"

#include "core/error.h"
#include "core/heap.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <exception>
#include <iostream>
#include <new>
#include <string>
#include <vector>

namespace ibl {
namespace {

constexpr const char* kFooter =
    "IN is a file, - for standard input, builtin:sky, builtin:compass or builtin:furnace.\n"
    "Exit status: 0 done, 1 usage, 2 input, 3 something is not on this machine, 4 output,\n"
    "5 the asked error cannot be met. See ibltool(1).";

/// What CLI11 says of a wrong number of values, "--size: At Most 1 required but received 2", in
/// terms of what was typed.
std::string countMessage(const std::string& message) {
    const std::size_t colon = message.find(": At ");
    unsigned wanted = 0, given = 0;
    if (colon == message.npos ||
        std::sscanf(message.c_str() + colon, ": At %*s %u required but received %u", &wanted,
                    &given) != 2) {
        return message;
    }
    const std::string name = message.substr(0, colon);
    if (given > wanted && given % wanted == 0) return name + ": is given more than once";
    return name + ": takes " + std::to_string(wanted) + (wanted == 1 ? " value" : " values") +
           ", not " + std::to_string(given);
}

/// The first word that no option took.
std::string extraMessage(const CLI::App& root) {
    const std::vector<std::string> words = root.remaining(true);
    const auto option = std::ranges::find_if(
        words, [](const std::string& word) { return word.size() > 1 && word.starts_with('-'); });
    const bool has_command = !root.get_subcommands().empty();
    if (option != words.end() && (has_command || option == words.begin()))
        return *option + ": there is no such option";
    if (!has_command) return words.front() + ": there is no such command";
    return words.front() + ": is one word too many";
}

/// CLI11's message on one line, with the command whose help explains it.
std::string usageMessage(const CLI::App& root, const CLI::ParseError& error) {
    std::string command = "ibltool";
    for (const CLI::App* app : root.get_subcommands())
        command += " " + app->get_name();
    std::string message = error.what();
    const std::string conversion = "Could not convert: ";
    if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
        message = countMessage(message);
    } else if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
        message = extraMessage(root);
    } else if (message.starts_with(conversion)) { // "--eye = 0,zz,4"
        message.erase(0, conversion.size());
        const std::size_t sign = message.find(" = ");
        message = message.substr(0, sign) + ": '" + message.substr(sign + 3) + "' is no number";
    }
    while (!message.empty() && (message.back() == '\n' || message.back() == '.'))
        message.pop_back();
    return message + "; see " + command + " --help";
}

void runCommandLine(int argc, char** argv) {
    CLI::App root("Image-based lighting: converts, convolves and renders with HDR probes.",
                  "ibltool");
    root.set_version_flag("--version", "ibltool " IBLTOOL_VERSION);
    root.footer(kFooter);
    const std::vector<Command> commands = {
        bindConvert(root), bindDiffuse(root), bindSpecular(root), bindBrdf(root), bindLights(root),
        bindRender(root),  bindTonemap(root), bindBake(root),     bindInfo(root),
    };
    try {
        root.parse(argc, argv);
    } catch (const CLI::Success& answer) { // --help, --version
        root.exit(answer);
        return;
    } catch (const CLI::ParseError& error) {
        throw Error(ExitCode::usage, usageMessage(root, error));
    }
    if (root.get_subcommands().empty()) {
        throw Error(ExitCode::usage, "a subcommand is required; see ibltool --help");
    }
    for (const Command& command : commands) {
        if (command.app->parsed()) command.run();
    }
}

} // namespace
} // namespace ibl

int main(int argc, char** argv) {
    // A reader that has gone away and a limit on file sizes are outputs that cannot be written, not
    // reasons to vanish.
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGXFSZ, SIG_IGN);
    ibl::keepHeap();
    try {
        ibl::runCommandLine(argc, argv);
        std::cout.flush();
        if (!std::cout)
            throw ibl::outputError("-", "standard output cannot be written; is its disk full?");
        return 0;
    } catch (const ibl::Error& error) {
        std::fprintf(stderr, "ibltool: %s\n", error.what());
        return static_cast<int>(error.code());
    } catch (const std::bad_alloc&) {
        std::fprintf(stderr, "ibltool: not enough memory; ask for a smaller size\n");
        return static_cast<int>(ibl::ExitCode::missing);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "ibltool: internal error: %s\n", error.what());
        return static_cast<int>(ibl::ExitCode::missing);
    }
}
