// The built program, for tests of what it does as a whole.
#pragma once

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "tests/deck/deck_files.hpp"

namespace quern::test {

struct Result {
    int code = -1;
    std::string out, err;
};

inline std::string read_file(const std::string& path) {
    std::ifstream file(path);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

/// A running `quern` whose output goes to two files.
class Program {
  public:
    Program(const TempFolder& folder, const std::vector<std::string>& arguments, std::string out = {})
        : out_(out.empty() ? folder.write("stdout", "") : std::move(out)), err_(folder.write("stderr", "")) {
        // A signal that comes before exec must end the child, not run the handlers of the tests in it.
        sigset_t all, before;
        sigfillset(&all);
        sigprocmask(SIG_BLOCK, &all, &before);
        child_ = fork();
        for (const int number : {SIGINT, SIGTERM})
            if (child_ == 0) std::signal(number, SIG_DFL);
        sigprocmask(SIG_SETMASK, &before, nullptr);
        if (child_ != 0) return;
        dup2(open(out_.c_str(), O_WRONLY), STDOUT_FILENO);
        dup2(open(err_.c_str(), O_WRONLY), STDERR_FILENO);
        std::string program = QUERN_PROGRAM;
        std::vector<char*> argv = {program.data()};
        for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
        argv.push_back(nullptr);
        execv(argv[0], argv.data());
        _exit(127);
    }
    pid_t id() const { return child_; }
    void signal(int number) const { kill(child_, number); }
    Result wait() const {
        int status = 0;
        waitpid(child_, &status, 0);
        return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, out_ == "/dev/full" ? "" : read_file(out_),
                read_file(err_)};
    }

  private:
    std::string out_, err_;
    pid_t child_ = -1;
};

inline Result quern(const TempFolder& folder, const std::vector<std::string>& arguments,
                    const std::string& out = {}) {
    return Program(folder, arguments, out).wait();
}

inline bool is_one_line(const std::string& text) {
    return !text.empty() && text.back() == '\n' && text.find('\n') == text.size() - 1;
}

/// Ends with the code, says why in one line, and says nothing else.
inline void check_failure(const Result& result, int code, const std::string& word) {
    CAPTURE(result.err);
    CHECK(result.code == code);
    CHECK(is_one_line(result.err));
    CHECK(result.err.rfind("quern: error: ", 0) == 0);
    CHECK(result.err.find(word) != std::string::npos);
}

}  // namespace quern::test
