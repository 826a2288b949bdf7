#include "src/study/study_progress.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "src/results/progress.hpp"

namespace quern {

void StudyProgress::ended(const std::string& name, const RunEnd& end, double seconds) {
    ++n_ended_;
    const double passed = std::chrono::duration<double>(Clock::now() - start_).count();
    const double left = passed / static_cast<double>(n_ended_) * static_cast<double>(n_to_run_ - n_ended_);
    const std::string line = fmt::format("{}/{}  {} left  {}: {} in {:.2f} s", n_ended_, n_to_run_,
                                         make_duration(left), name, end.outcome, seconds);
    if (terminal_)
        fmt::print(stderr, "\r{}\x1b[K", line);
    else
        fmt::print(stderr, "{}\n", line);
    if (terminal_ && end.outcome == "failed") fmt::print(stderr, "\n");
    if (end.outcome == "failed") fmt::print(stderr, "  {}\n", end.message);
    std::fflush(stderr);
}

void StudyProgress::finish() const {
    if (terminal_ && n_ended_ > 0) fmt::print(stderr, "\n");
}

}  // namespace quern
