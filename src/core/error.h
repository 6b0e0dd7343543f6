// The one error type of the program.
//
// It is thrown where the fact is known and caught once, in main, which prints
// `ibltool: MESSAGE` on one line of standard error and exits with the code. A message reads
// `SUBJECT: what is wrong; what to do`, where the subject is a file or an option.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace ibl {

/// Exit codes that pipelines rely on.
enum class ExitCode {
    done = 0,
    usage = 1,    ///< the command line cannot be understood
    input = 2,    ///< an input cannot be read or used
    missing = 3,  ///< something needed is not on this machine (an EGL device, a module)
    output = 4,   ///< an output cannot be written
    accuracy = 5, ///< the asked error cannot be met
};

class Error : public std::runtime_error {
public:
    /// Control characters in the message (a hostile file name, say) are replaced, so that it stays
    /// one line.
    Error(ExitCode code, std::string_view message);

    ExitCode code() const { return code_; }

private:
    ExitCode code_;
};

/// Errors of an input: `subject: problem`.
Error inputError(std::string_view subject, std::string_view problem);
/// Errors of an output: `subject: problem`.
Error outputError(std::string_view subject, std::string_view problem);

} // namespace ibl
