// The built program as a child of the test.
#pragma once

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "tests/sim/decks.hpp"

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
        child_ = fork();
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

}  // namespace quern::test
