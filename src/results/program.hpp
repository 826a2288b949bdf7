// Other programs on PATH.
#pragma once

#include <string>
#include <vector>

namespace quern {

/// Full path of an executable on PATH; empty if there is none.
std::string find_program(const std::string& name);

/// Runs a program silently and waits; true if it ended with status 0.
bool run_program(const std::vector<std::string>& arguments);

}  // namespace quern
