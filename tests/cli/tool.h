// Runs the tool as a user does and tells what it said.
#pragma once

#include "image/image.h"

#include <filesystem>
#include <string>
#include <vector>

namespace ibl {

struct ToolResult {
    int exit_code = -1; ///< 128 + signal if it was ended by one
    std::string out;
    std::string err;
    double cpu_seconds = 0; ///< user and system
};

/// Runs `ibltool ARGUMENTS` in `folder`, with `input` on standard input and the settings of
/// `environment` (NAME=VALUE) added.
ToolResult runTool(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                   const std::string& input = {}, const std::vector<std::string>& environment = {});

/// Runs any program in the same way.
ToolResult runProgram(const std::vector<std::string>& command, const std::filesystem::path& folder,
                      const std::string& input = {},
                      const std::vector<std::string>& environment = {});

/// A folder of its own for a test, removed with it.
class Scratch {
public:
    Scratch();
    ~Scratch();
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

    /// Names of what is in it, sorted.
    std::vector<std::string> names() const;

private:
    std::filesystem::path path_;
};

std::string readFile(const std::filesystem::path& path);
void writeFile(const std::filesystem::path& path, const std::string& bytes);

/// A file of the tree's testdata.
std::string testData(const std::string& name);

/// The picture that `ibltool COMMAND WORDS -o OUT` makes, with alpha if it has some.
Image pictureOf(const Scratch& scratch, const std::string& command, std::vector<std::string> words,
                const std::string& out);

/// Expects a refusal: the exit code, exactly one line on standard error that begins with
/// "ibltool: " and contains `said`, and nothing on standard output.
void expectRefused(const ToolResult& result, int exit_code, const std::string& said);

} // namespace ibl
