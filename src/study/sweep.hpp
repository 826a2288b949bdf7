// `quern sweep`: a deck under all combinations of some values.
#pragma once

#include <string>
#include <vector>

#include "src/study/study_run.hpp"

namespace quern {

struct SweepOptions {
    StudyBase base;
    std::string directory;
    std::vector<std::string> settings;  ///< "key=1,2,3"
    std::vector<std::string> values;    ///< columns of the table by formula, see RunValue
    int at_once = 1;                    ///< runs at a time
    bool terminal = false;              ///< the progress line is rewritten in place
};

/// Runs what is missing of DIR/runs/NAME, writes DIR/sweep.csv and DIR/sweep.json, and tells on standard
/// output and error. Returns the exit code: 0, 3 if a run failed, 130 if interrupted. Throws InputError
/// before anything is run, OutputError.
int sweep(const SweepOptions& options);

}  // namespace quern
