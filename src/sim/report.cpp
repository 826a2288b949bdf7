#include "src/sim/report.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <utility>

#include "grid/error.hpp"

namespace quern {

void ReportChecks::add(const std::string& name, double measured, const char* relation, double bound,
                       bool holds) {
    ++n_;
    n_failed_ += holds ? 0 : 1;
    fmt::print("{} {:58} {:12.5g}  {} {:g}\n", holds ? "ok  " : "FAIL", name, measured, relation, bound);
}

void ReportChecks::at_most(const std::string& name, double measured, double bound) {
    add(name, measured, "<=", bound, measured <= bound);
}

void ReportChecks::at_least(const std::string& name, double measured, double bound) {
    add(name, measured, ">=", bound, measured >= bound);
}

int ReportChecks::verdict() {
    for (const Later& check : std::exchange(later_, {})) at_most(check.name, check.measured, check.bound);
    fmt::print("{} of {} numbers within their bounds\n", n_ - n_failed_, n_);
    return n_failed_ == 0 ? 0 : 1;
}

int report_main(int argc, char** argv, const std::string& name, int (*body)(const ReportOptions&)) {
    ReportOptions options;
    options.directory = "out/" + name;
    CLI::App app("Report of the example " + name);
    app.add_option("-o,--output", options.directory, "Folder of results and pictures")->capture_default_str();
    app.add_flag("--short", options.short_mode, "A few quick cases, as in the tests");
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        return app.exit(error) == 0 ? 0 : InputError::exit_code;
    }
    try {
        return body(options);
    } catch (const InputError& error) {
        fmt::print(stderr, "{}_report: error: {}\n", name, error.what());
        return InputError::exit_code;
    } catch (const SimulationError& error) {
        fmt::print(stderr, "{}_report: error: {}\n", name, error.what());
        return SimulationError::exit_code;
    } catch (const OutputError& error) {
        fmt::print(stderr, "{}_report: error: {}\n", name, error.what());
        return OutputError::exit_code;
    }
}

}  // namespace quern
