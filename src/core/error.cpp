#include "core/error.h"

namespace ibl {
namespace {

std::string oneLine(std::string_view text) {
    std::string line(text);
    for (char& c : line) {
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
    }
    return line;
}

std::string joined(std::string_view subject, std::string_view problem) {
    return std::string(subject) + ": " + std::string(problem);
}

} // namespace

Error::Error(ExitCode code, std::string_view message)
    : std::runtime_error(oneLine(message)), code_(code) {}

Error inputError(std::string_view subject, std::string_view problem) {
    return Error(ExitCode::input, joined(subject, problem));
}

Error outputError(std::string_view subject, std::string_view problem) {
    return Error(ExitCode::output, joined(subject, problem));
}

} // namespace ibl
