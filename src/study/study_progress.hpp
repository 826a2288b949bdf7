// How far a study is, for the one who waits.
#pragma once

#include <chrono>
#include <cstddef>
#include <string>

#include "src/study/study_run.hpp"

namespace quern {

/// On a terminal one line that is rewritten, otherwise a line a run; on standard error.
class StudyProgress {
  public:
    StudyProgress(std::size_t n_to_run, bool terminal) : n_to_run_(n_to_run), terminal_(terminal) {}
    void ended(const std::string& name, const RunEnd& end, double seconds);
    void finish() const;  ///< leaves the line of the terminal

  private:
    using Clock = std::chrono::steady_clock;
    std::size_t n_to_run_, n_ended_ = 0;
    bool terminal_;
    Clock::time_point start_ = Clock::now();
};

}  // namespace quern
