// `quern compare`: one deck, several ways to run it, one report.
#pragma once

#include <string>
#include <vector>

#include "src/study/study_run.hpp"

namespace quern {

struct CompareOptions {
    StudyBase base;
    std::string directory;
    std::vector<std::string> variants;  ///< "NAME: key=value, ..."; empty: the default ones
    std::string over;                   ///< "key=1,2,3" or ""
    std::vector<std::string> settings;  ///< "key=value", of all runs
    std::string reference;              ///< name of a variant, or a CSV file; "": the first variant
    int n_repeats = 1;
    bool reuse = false;     ///< runs that are done are not run again
    bool terminal = false;  ///< the progress line is rewritten in place
};

/// Runs all variants one after the other, repeats in turns, and writes DIR/comparison.md, comparison.json and
/// charts. Returns the exit code: 0, 3 if a run failed, 130 if interrupted. Throws InputError before anything
/// is run, OutputError.
int compare(const CompareOptions& options);

}  // namespace quern
