#include "src/results/virtual_display.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>
#include <utility>

#include "grid/error.hpp"
#include "src/results/program.hpp"

namespace quern {

namespace {

constexpr int start_timeout_ms = 30000;  // a loaded machine; usually 50 ms

/// In the child: only calls that are safe between fork and exec of a process with threads.
[[noreturn]] void become_server(const char* const* arguments, int number_pipe) {
    setpgid(0, 0);                     // an interrupt from the keyboard is for us, not for the server
    prctl(PR_SET_PDEATHSIG, SIGTERM);  // but it never outlives us
    const int null = open("/dev/null", O_RDWR);
    for (const int standard : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(null, standard);
    fcntl(number_pipe, F_SETFD, 0);
    execv(arguments[0], const_cast<char* const*>(arguments));
    _exit(127);
}

/// The line that the server writes once it listens; empty if it ends or stays silent.
std::string read_display_number(int number_pipe) {
    std::string number;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(start_timeout_ms);
    while (number.empty() || number.back() != '\n') {
        const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
            deadline - std::chrono::steady_clock::now());
        pollfd ready{number_pipe, POLLIN, 0};
        const int n_ready = left.count() > 0 ? poll(&ready, 1, static_cast<int>(left.count())) : 0;
        if (n_ready < 0 && errno == EINTR) continue;
        char c = 0;
        if (n_ready <= 0 || read(number_pipe, &c, 1) != 1) return {};
        number += c;
    }
    number.pop_back();
    return number;
}

}  // namespace

VirtualDisplay::VirtualDisplay() {
    const char* before = std::getenv("DISPLAY");
    had_display_ = before && *before;
    if (had_display_) display_before_ = before;

    const std::string program = find_program("Xvfb");
    if (program.empty()) {
        if (had_display_) return;
        throw OutputError(
            "cannot draw: no DISPLAY and no Xvfb to stand in for it (install the package xvfb)");
    }
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) throw OutputError("cannot draw: no pipe to Xvfb");
    const std::string pipe_number = fmt::format("{}", ends[1]);
    const char* const arguments[] = {
        program.c_str(), "-displayfd", pipe_number.c_str(), "-screen", "0", "1280x1024x24",
        "-nolisten",     "tcp",        "-noreset",          nullptr};
    server_ = fork();
    if (server_ == 0) become_server(arguments, ends[1]);
    close(ends[1]);
    const std::string number = server_ > 0 ? read_display_number(ends[0]) : std::string();
    close(ends[0]);
    if (!number.empty()) {
        setenv("DISPLAY", (":" + number).c_str(), 1);
        return;
    }
    stop();
    if (!had_display_) throw OutputError(fmt::format("cannot draw: {} does not start", program));
}

VirtualDisplay::~VirtualDisplay() {
    stop();
    if (had_display_)
        setenv("DISPLAY", display_before_.c_str(), 1);
    else
        unsetenv("DISPLAY");
}

void VirtualDisplay::stop() {
    const pid_t server = std::exchange(server_, -1);
    if (server <= 0) return;
    kill(server, SIGTERM);  // lets it remove its lock and socket
    for (int i = 0; i < 1000; ++i) {
        if (waitpid(server, nullptr, WNOHANG) != 0) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    kill(server, SIGKILL);
    waitpid(server, nullptr, 0);
}

}  // namespace quern
