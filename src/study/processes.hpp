// The program's own runs as processes of their own: memory and crashes stay apart.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace quern {

struct ProcessJob {
    std::vector<std::string> arguments;  ///< the program first
    std::string log;                     ///< file that takes its output and its errors
};

struct ProcessEnd {
    int code = -1;   ///< exit code; -1: ended by a signal, or not started
    int signal = 0;  ///< that ended it
    double seconds = 0;
};

/// Runs the jobs in their order, `at_once` at a time, and calls `ended` in this thread for each that has been
/// started. When stop_requested(), running jobs get SIGTERM and are waited for, and no more are started. Jobs
/// end with this process, however that ends. Throws OutputError if a process cannot be started.
void run_processes(const std::vector<ProcessJob>& jobs, int at_once,
                   const std::function<void(std::size_t, const ProcessEnd&)>& ended);

/// Holds a folder for one study at a time; the runs that it has started hold it, too. Creates the folder.
class FolderLock {
  public:
    /// Waits a little for the runs of a study that was killed; then throws InputError.
    explicit FolderLock(const std::string& folder);
    ~FolderLock();
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;

  private:
    int descriptor_ = -1;
};

}  // namespace quern
