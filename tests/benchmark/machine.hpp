// The machine: what it is, which core the program is on, how much memory the process has taken.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace quern::bench {

/// Processor, caches, memory, load, compiler, instruction set. `revision`: of the source, as told.
std::vector<std::pair<std::string, std::string>> describe_machine(const std::string& revision);

int n_cores();

/// One thread stays on the core where it is; several may go anywhere.
void set_threads(int threads);

/// Largest memory that the process has taken since its birth, over what it held then.
class MemoryPeak {
  public:
    MemoryPeak();
    double bytes() const;  ///< 0 where the system does not tell

  private:
    double before_ = 0.0;
};

}  // namespace quern::bench
