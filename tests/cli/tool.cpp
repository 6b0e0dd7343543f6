#include "cli/tool.h"

#include "image/read.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace ibl {
namespace {

std::string newFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "ibltool-test-XXXXXX").string();
    if (!mkdtemp(name.data())) throw std::runtime_error("cannot make " + name);
    return name;
}

[[noreturn]] void execute(const std::vector<std::string>& command,
                          const std::filesystem::path& folder,
                          const std::vector<std::string>& environment,
                          const std::array<std::filesystem::path, 3>& streams) {
    const auto redirect = [](const std::filesystem::path& file, int flags, int to) {
        const int from = open(file.c_str(), flags, 0600);
        if (from < 0 || dup2(from, to) < 0) _exit(126);
    };
    redirect(streams[0], O_RDONLY, 0);
    redirect(streams[1], O_WRONLY, 1);
    redirect(streams[2], O_WRONLY, 2);
    if (chdir(folder.c_str()) != 0) _exit(126);
    for (const std::string& setting : environment)
        putenv(const_cast<char*>(setting.c_str()));
    std::vector<char*> argv;
    for (const std::string& word : command)
        argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    execvp(argv[0], argv.data());
    _exit(127);
}

} // namespace

ToolResult runProgram(const std::vector<std::string>& command, const std::filesystem::path& folder,
                      const std::string& input, const std::vector<std::string>& environment) {
    const Scratch streams;
    const std::array<std::filesystem::path, 3> files{streams / "in", streams / "out",
                                                     streams / "err"};
    writeFile(files[0], input);
    writeFile(files[1], "");
    writeFile(files[2], "");
    const pid_t child = fork();
    if (child == 0) execute(command, folder, environment, files);
    int status = 0;
    rusage usage{};
    if (child < 0 || wait4(child, &status, 0, &usage) != child) {
        throw std::runtime_error("cannot run " + command[0]);
    }
    ToolResult result;
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.out = readFile(files[1]);
    result.err = readFile(files[2]);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    result.cpu_seconds = seconds(usage.ru_utime) + seconds(usage.ru_stime);
    return result;
}

ToolResult runTool(const std::vector<std::string>& arguments, const std::filesystem::path& folder,
                   const std::string& input, const std::vector<std::string>& environment) {
    std::vector<std::string> command{IBLTOOL_PROGRAM};
    command.insert(command.end(), arguments.begin(), arguments.end());
    return runProgram(command, folder, input, environment);
}

Scratch::Scratch() : path_(newFolder()) {}

Scratch::~Scratch() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
}

std::vector<std::string> Scratch::names() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path_)) {
        names.push_back(std::filesystem::relative(entry.path(), path_).string());
    }
    std::sort(names.begin(), names.end());
    return names;
}

std::string readFile(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::runtime_error("cannot read " + path.string());
    return {std::istreambuf_iterator<char>(file), {}};
}

void writeFile(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream file(path, std::ios::binary);
    file << bytes;
    if (!file.flush()) throw std::runtime_error("cannot write " + path.string());
}

std::string testData(const std::string& name) {
    return std::string(IBLTOOL_SOURCE_DIR) + "/testdata/" + name;
}

Image pictureOf(const Scratch& scratch, const std::string& command, std::vector<std::string> words,
                const std::string& out) {
    words.insert(words.begin(), command);
    words.insert(words.end(), {"-o", out});
    const ToolResult result = runTool(words, scratch.path());
    EXPECT_EQ(result.exit_code, 0) << result.err;
    ReadOptions options;
    options.keep_alpha = true;
    return readImage((scratch / out).string(), options).image;
}

void expectRefused(const ToolResult& result, int exit_code, const std::string& said) {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(result.err.rfind("ibltool: ", 0), 0u) << result.err;
    EXPECT_EQ(std::count(result.err.begin(), result.err.end(), '\n'), 1) << result.err;
    EXPECT_NE(result.err.find(said), std::string::npos)
        << "'" << said << "' is not in: " << result.err;
    EXPECT_EQ(result.out, "");
}

} // namespace ibl
