#include "src/results/progress.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <vector>

using namespace quern;

namespace {

/// A clock that is set by hand, and what Progress did with it.
struct Bench {
    double now = 100.0;
    int n_reads = 0;
    std::vector<std::string> logged;
    std::unique_ptr<std::FILE, int (*)(std::FILE*)> screen{std::tmpfile(), std::fclose};

    Progress make(bool terminal, double t_end) {
        return Progress(
            terminal, t_end, [this](const std::string& line) { logged.push_back(line); }, screen.get(),
            [this] {
                ++n_reads;
                return now;
            });
    }

    std::string shown() const {
        std::rewind(screen.get());
        std::string text;
        for (int c; (c = std::fgetc(screen.get())) != EOF;) text += static_cast<char>(c);
        return text;
    }
};

}  // namespace

TEST_CASE("Progress: the log has a line at every twentieth part of the run") {
    Bench bench;
    Progress progress = bench.make(false, 10.0);
    for (int step = 0; step <= 1000; ++step) {
        progress.update(step, 0.01 * step, 1e-7);
        bench.now += 0.1;
    }
    CHECK(bench.logged.size() >= 19);
    CHECK(bench.logged.size() <= 20);
    CHECK(bench.logged.front() == "  5.0 %  step 50  t 0.5 s  10 steps/s  1:35 left  energy error 1.0e-07");
    CHECK(bench.shown().empty());
}

TEST_CASE("Progress: a slow run is logged every thirty seconds") {
    Bench bench;
    Progress progress = bench.make(false, 1e6);
    for (int step = 0; step <= 100; ++step) {
        progress.update(step, step, 0.0);
        bench.now += 1.0;
    }
    CHECK(bench.logged.size() == 3);
}

TEST_CASE("Progress: short steps hardly read the clock") {
    Bench bench;
    Progress progress = bench.make(false, 1.0);
    constexpr int n_steps = 1000000;
    for (int step = 0; step <= n_steps; ++step) {
        progress.update(step, 1e-6 * step, 0.0);
        bench.now += 1e-6;
    }
    CHECK(bench.n_reads < 100);  // measured 46, bound 100, of a million
}

TEST_CASE("Progress: the terminal keeps one line, rewritten at most five times a second") {
    Bench bench;
    Progress progress = bench.make(true, 1.0);
    for (int step = 0; step <= 100; ++step) {
        progress.update(step, 0.01 * step, 0.0);
        bench.now += 0.02;
    }
    progress.finish();
    const std::string shown = bench.shown();
    const auto n_shown = std::count(shown.begin(), shown.end(), '\r');
    CHECK(n_shown >= 5);
    CHECK(n_shown <= 11);  // 2 s at most ten times, and at the end
    CHECK(std::count(shown.begin(), shown.end(), '\n') == 1);
    CHECK(shown.find("100.0 %  step 100") != std::string::npos);
    CHECK(bench.logged.back().find("100.0 %") != std::string::npos);
}

TEST_CASE("Progress: pace and time left follow the recent past") {
    Bench bench;
    Progress progress = bench.make(false, 1000.0);
    // A hundred seconds at ten steps a second, then at one: after ten memories only the new pace is left.
    int step = 0;
    for (; step < 1000; ++step) bench.now += 0.1, progress.update(step, 0.1 * step, 0.0);
    for (; step < 1100; ++step) bench.now += 1.0, progress.update(step, 0.1 * step, 0.0);
    progress.finish();
    INFO(bench.logged.back());
    CHECK(bench.logged.back().find("  1 steps/s") != std::string::npos);
    CHECK(bench.logged.back().find("2:28:1") != std::string::npos);  // 890 s at a tenth of real time
}

TEST_CASE("Progress: durations read like a clock") {
    CHECK(make_duration(7.4) == "0:07");
    CHECK(make_duration(754.0) == "12:34");
    CHECK(make_duration(12345.0) == "3:25:45");
    CHECK(make_duration(std::numeric_limits<double>::infinity()) == "?");
}
