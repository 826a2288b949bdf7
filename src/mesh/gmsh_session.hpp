// One exclusive, silent use of gmsh, which keeps its state in globals.
#pragma once

#include <mutex>
#include <string>
#include <utility>
#include <vector>

namespace quern {

/// Holds gmsh for the life of the object: an empty current model, nothing printed, one thread, errors thrown.
///
/// Sessions of different threads wait for each other. gmsh is initialised by the first session of a process
/// and finalised at its end, unless the caller's program has initialised it: then it stays the caller's.
/// Options and the current model are given back as they were found.
class GmshSession {
  public:
    GmshSession();
    ~GmshSession();
    GmshSession(const GmshSession&) = delete;
    GmshSession& operator=(const GmshSession&) = delete;

    /// Sets a numerical option until the end of the session.
    void set(const std::string& option, double value);

  private:
    std::lock_guard<std::mutex> lock_;
    std::string previous_model_;
    std::vector<std::pair<std::string, double>> previous_options_;
};

/// The text of the exception in flight; gmsh throws strings and numbers besides std::exception. Call it
/// inside a catch block only.
std::string current_gmsh_error();

}  // namespace quern
