#include "src/study/processes.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <thread>

#include "grid/error.hpp"
#include "src/results/output_file.hpp"
#include "src/results/stop_signals.hpp"

namespace quern {

namespace {

using Clock = std::chrono::steady_clock;
constexpr auto between_looks = std::chrono::milliseconds(5);
constexpr int not_started = 127;  // as shells say

struct Child {
    std::size_t job = 0;
    pid_t id = -1;
    Clock::time_point start = Clock::now();
};

Child start(const ProcessJob& job, std::size_t number) {
    std::vector<char*> argv;
    for (const std::string& argument : job.arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const int log = open(job.log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
    if (log < 0) throw_output_error(job.log, "open for writing", errno);
    const pid_t parent = getpid();
    Child child{number};
    child.id = fork();
    if (child.id == 0) {
        // Only calls that are safe between fork and exec.
        prctl(PR_SET_PDEATHSIG, SIGTERM);
        if (getppid() != parent) _exit(not_started);
        dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
        dup2(log, STDOUT_FILENO);
        dup2(log, STDERR_FILENO);
        execv(argv[0], argv.data());
        _exit(not_started);
    }
    const int error = errno;
    close(log);
    if (child.id < 0) throw_output_error(job.arguments.front(), "start the process", error);
    return child;
}

}  // namespace

void run_processes(const std::vector<ProcessJob>& jobs, int at_once,
                   const std::function<void(std::size_t, const ProcessEnd&)>& ended) {
    std::vector<Child> children;
    std::size_t next = 0;
    bool told = false;
    while (!children.empty() || (next < jobs.size() && !stop_requested())) {
        while (next < jobs.size() && children.size() < static_cast<std::size_t>(at_once) &&
               !stop_requested()) {
            children.push_back(start(jobs[next], next));
            ++next;
        }
        if (stop_requested() && !told) {
            for (const Child& child : children) kill(child.id, SIGTERM);
            told = true;
        }
        for (std::size_t i = 0; i < children.size();) {
            int status = 0;
            const Child child = children[i];
            const pid_t done = waitpid(child.id, &status, WNOHANG);
            if (done == 0 || (done < 0 && errno == EINTR)) {
                ++i;
                continue;
            }
            children.erase(children.begin() + static_cast<std::ptrdiff_t>(i));
            ProcessEnd end;
            end.seconds = std::chrono::duration<double>(Clock::now() - child.start).count();
            if (WIFEXITED(status)) end.code = WEXITSTATUS(status);
            if (WIFSIGNALED(status)) end.signal = WTERMSIG(status);
            ended(child.job, end);
        }
        std::this_thread::sleep_for(between_looks);
    }
}

FolderLock::FolderLock(const std::string& folder) {
    create_directory(folder);
    const std::string file = folder + "/.lock";
    // Without O_CLOEXEC: runs that outlive a killed study keep others out until they have ended.
    descriptor_ = open(file.c_str(), O_WRONLY | O_CREAT, 0666);
    if (descriptor_ < 0) throw_output_error(file, "open for writing", errno);
    const auto patience = Clock::now() + std::chrono::seconds(10);
    while (flock(descriptor_, LOCK_EX | LOCK_NB) != 0) {
        if (Clock::now() > patience) {
            close(descriptor_);
            throw InputError("-o", "'" + folder + "', where another study is running",
                             "a folder of its own for each");
        }
        std::this_thread::sleep_for(between_looks);
    }
}

FolderLock::~FolderLock() {
    close(descriptor_);
}

}  // namespace quern
