// The error ladder above types and asserts: bad input, a failed simulation, a failed output.
//
// Each carries one finished message; the command line prints it and ends with the exit code given here.
#pragma once

#include <stdexcept>
#include <string>

namespace quern {

/// What the user gave cannot be used (exit code 2). Raised at set-up only, never inside a step.
class InputError : public std::runtime_error {
  public:
    static constexpr int exit_code = 2;
    /// where: "file:line: key"; got and expected: what stands there and what should; hint: nearest valid
    /// name or a way out (may be empty).
    InputError(const std::string& where, const std::string& got, const std::string& expected,
               const std::string& hint = {})
        : std::runtime_error(where + ": got " + got + ", expected " + expected +
                             (hint.empty() ? std::string() : " (" + hint + ")")) {}
};

/// The run went wrong: instability, lost particle, no number (exit code 3).
class SimulationError : public std::runtime_error {
  public:
    static constexpr int exit_code = 3;
    using std::runtime_error::runtime_error;
};

/// A result could not be written (exit code 4).
class OutputError : public std::runtime_error {
  public:
    static constexpr int exit_code = 4;
    using std::runtime_error::runtime_error;
};

}  // namespace quern
