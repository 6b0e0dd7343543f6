// The man pages and --help name the same commands and options, both ways.
#include "cli/tool.h"

#include <gtest/gtest.h>

#include <regex>
#include <set>

namespace ibl {
namespace {

const std::vector<std::string> kCommands = {"convert", "diffuse", "specular", "brdf", "lights",
                                            "render",  "tonemap", "bake",     "info"};

std::set<std::string> matches(const std::string& text, const std::string& pattern) {
    const std::regex expression(pattern);
    std::set<std::string> found;
    for (std::sregex_iterator it(text.begin(), text.end(), expression), end; it != end; ++it) {
        found.insert((*it)[1]);
    }
    return found;
}

std::string page(const std::string& name) {
    return readFile(std::string(IBLTOOL_SOURCE_DIR) + "/man/" + name + ".1");
}

/// Options that a page documents: the tagged paragraphs of its OPTIONS section.
std::set<std::string> documented(const std::string& text) {
    const std::size_t begin = text.find(".SH OPTIONS");
    const std::size_t end = text.find(".SH ", begin + 1);
    const std::string plain =
        std::regex_replace(text.substr(begin, end - begin), std::regex(R"(\\-)"), "-");
    std::set<std::string> options;
    const std::regex tag(R"(\.TP\n([^\n]*))");
    for (std::sregex_iterator it(plain.begin(), plain.end(), tag), last; it != last; ++it) {
        for (const std::string& option : matches((*it)[1], "(--[a-z][a-z-]*)")) {
            options.insert(option);
        }
    }
    return options;
}

TEST(Manual, EveryOptionOfTheHelpIsInThePageAndTheOtherWay) {
    const Scratch scratch;
    for (const std::string& command : kCommands) {
        const std::string help = runTool({command, "--help"}, scratch.path()).out;
        // An option's own line begins with it, after two blanks and perhaps a short name.
        auto offered = matches(help, R"((?:^|\n)  (?:-[a-z],)?(--[a-z][a-z-]*))");
        EXPECT_EQ(offered.erase("--help"), 1u) << help;
        EXPECT_GT(offered.size(), 5u) << help;
        EXPECT_EQ(offered, documented(page("ibltool-" + command))) << command;
    }
}

TEST(Manual, TheOverviewNamesEveryCommand) {
    const Scratch scratch;
    const std::string overview = page("ibltool");
    const std::string help = runTool({"--help"}, scratch.path()).out;
    const std::size_t list = help.find("Subcommands:");
    ASSERT_NE(list, std::string::npos) << help;
    const auto offered = matches(help.substr(list), R"(\n  ([a-z]+) )");
    EXPECT_EQ(offered, std::set<std::string>(kCommands.begin(), kCommands.end()));
    for (const std::string& command : kCommands) {
        EXPECT_NE(overview.find("ibltool\\-" + command), std::string::npos) << command;
    }
}

TEST(Manual, PagesHaveTheirSectionsAndNoFaults) {
    const Scratch scratch;
    for (const std::string& command : kCommands) {
        const std::string text = page("ibltool-" + command);
        for (const char* section :
             {"NAME", "SYNOPSIS", "DESCRIPTION", "OPTIONS", "EXAMPLES", "EXIT STATUS"}) {
            const std::string heading = section;
            EXPECT_TRUE(text.find(".SH " + heading) != std::string::npos ||
                        text.find(".SH \"" + heading + "\"") != std::string::npos)
                << command << " " << section;
        }
        const ToolResult lint =
            runProgram({"mandoc", "-T", "lint", "-W", "warning",
                        std::string(IBLTOOL_SOURCE_DIR) + "/man/ibltool-" + command + ".1"},
                       scratch.path());
        EXPECT_EQ(lint.exit_code, 0) << lint.out << lint.err;
    }
}

} // namespace
} // namespace ibl
