#include "src/study/study_run.hpp"

#include <fmt/format.h>
#include <string.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "src/results/output_file.hpp"
#include "src/study/run_files.hpp"

namespace quern {

namespace {

std::string log_file(const StudyRun& run) {
    return run.directory + ".log";
}

/// The run's own last word: its line "quern: error: ...".
std::string error_in(const std::string& file) {
    constexpr std::string_view mark = "quern: error: ";
    std::ifstream log(file);
    std::string message;
    for (std::string line; std::getline(log, line);)
        if (const std::size_t at = line.find(mark); at != std::string::npos)
            message = line.substr(at + mark.size());
    return message;
}

}  // namespace

bool is_done(const StudyRun& run) {
    const RunSummary summary(run.directory);
    return summary.text("outcome") == "done" && summary.text("deck_hash") == run.hash;
}

ProcessJob make_job(const StudyBase& base, const StudyRun& run) {
    create_directory(run.directory);
    std::error_code error;
    std::filesystem::remove(run.directory + "/summary.json", error);
    if (error) throw_output_error(run.directory + "/summary.json", "remove the old file", error.value());
    ProcessJob job{
        {base.program, "run", base.deck, "-o", run.directory, "--threads", fmt::format("{}", base.threads)},
        log_file(run)};
    for (const std::string& one : run.overrides) {
        job.arguments.push_back("--set");
        job.arguments.push_back(one);
    }
    return job;
}

RunEnd end_of(const StudyRun& run, const ProcessEnd& end) {
    RunEnd result;
    result.exit_code = std::max(0, end.code);
    if (end.code == 0 && is_done(run)) {
        result.outcome = "done";
    } else if (end.code == interrupted_exit_code || end.signal == SIGTERM || end.signal == SIGINT) {
        result.outcome = "interrupted";
    } else {
        result.outcome = "failed";
        result.message = error_in(log_file(run));
        if (result.message.empty())
            result.message = end.signal != 0
                                 ? fmt::format("ended by signal {} ({})", end.signal, strsignal(end.signal))
                                 : fmt::format("exit code {}; see {}", end.code, log_file(run));
    }
    return result;
}

}  // namespace quern
