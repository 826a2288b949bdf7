// A whole run: deck in, results out.
#pragma once

#include <string>

#include "src/deck/deck.hpp"
#include "src/results/records.hpp"

namespace quern {

struct RunOptions {
    std::string directory;           ///< results go here
    int threads = 0;                 ///< 0: all cores
    bool progress_terminal = false;  ///< a progress line rewritten in place on stderr
};

enum class RunOutcome { done, interrupted };

/// Runs a deck and writes its results. Throws InputError, SimulationError (after writing what there is) or
/// OutputError. SIGINT and SIGTERM end the run cleanly.
RunOutcome run_deck(const Deck& deck, const RunOptions& options, Summary* summary = nullptr);

}  // namespace quern
