// For the example reports: the command line, checks against expected numbers, and the verdict.
#pragma once

#include <string>
#include <vector>

namespace quern {

struct ReportOptions {
    std::string directory;  ///< results and pictures go here
    bool short_mode = false;
};

/// Collects measured numbers with their bounds; prints them as they come, or at the end, below the tables.
class ReportChecks {
  public:
    /// Prints name, measured value and bound; a value beyond the bound (or no number) fails the report.
    void at_most(const std::string& name, double measured, double bound);
    void at_least(const std::string& name, double measured, double bound);
    /// As at_most, printed by `verdict`.
    void at_most_later(const std::string& name, double measured, double bound) {
        later_.push_back({name, measured, bound});
    }
    /// Prints what waits and the verdict: 0 if all held, else 1.
    int verdict();

  private:
    struct Later {
        std::string name;
        double measured, bound;
    };
    void add(const std::string& name, double measured, const char* relation, double bound, bool holds);
    std::vector<Later> later_;
    int n_failed_ = 0, n_ = 0;
};

/// main() of a report: reads `[-o DIR] [--short]` (default DIR: out/<name>), calls body, turns errors into
/// the exit codes of `quern`.
int report_main(int argc, char** argv, const std::string& name, int (*body)(const ReportOptions&));

}  // namespace quern
