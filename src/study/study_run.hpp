// One run of a study: its place, its settings, and whether it has been done.
#pragma once

#include <string>
#include <vector>

#include "src/study/processes.hpp"

namespace quern {

/// Exit code of a run or a study that was asked to stop.
constexpr int interrupted_exit_code = 130;

/// What all runs of a study share.
struct StudyBase {
    std::string program;  ///< path of quern itself
    std::string deck;
    int threads = 1;  ///< of each run
};

struct StudyRun {
    std::string name;                    ///< of its folder
    std::string directory;               ///< of its results
    std::vector<std::string> overrides;  ///< of the deck
    std::string hash;                    ///< of its resolved deck
};

/// How a run ended.
struct RunEnd {
    std::string outcome = "missing";  ///< "done", "failed", "interrupted"; "missing": not started
    int exit_code = 0;                ///< of the process, or 0
    std::string message;              ///< of a failed run
};

/// Done: its summary says so, and its deck resolves to the same text.
bool is_done(const StudyRun& run);

/// Makes the folder of the run, without a summary that could pass for the new one.
ProcessJob make_job(const StudyBase& base, const StudyRun& run);

/// What to say of a run whose process has ended.
RunEnd end_of(const StudyRun& run, const ProcessEnd& end);

}  // namespace quern
