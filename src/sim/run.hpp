// A whole run: deck in, results out.
#pragma once

#include <string>
#include <vector>

#include "src/deck/deck.hpp"
#include "src/results/records.hpp"

namespace quern {

struct RunOptions {
    std::string directory;           ///< results go here
    int threads = 0;                 ///< 0: all cores
    bool progress_terminal = false;  ///< a progress line rewritten in place on stderr
};

/// What a run reports, for programs that go on with its numbers.
struct RunRecord {
    Summary summary;
    std::vector<HistoryRow> history;
    std::vector<GrainRow> grains;        ///< as in grains.csv: by time, tracked grains in the deck's order
    std::vector<ReactionRow> reactions;  ///< as in reactions.csv
    std::vector<FragmentRow> fragments;  ///< as in fragments.csv
    /// [n_frames] rows of each table of observed_layouts; empty without `observe`.
    std::vector<std::vector<TableRows>> observed;
};

enum class RunOutcome { done, interrupted };

/// Goes on with the run in options.directory from its last checkpoint, as if it had never been stopped: same
/// bits at the end. `record` holds what comes from there on. Throws as run_deck, and InputError if there is
/// no checkpoint or if deck or meshes are not those of the run.
RunOutcome resume_run(const RunOptions& options, RunRecord* record = nullptr);

/// Runs a deck and writes its results. Throws InputError, SimulationError (after writing what there is) or
/// OutputError. `record` is filled if given. SIGINT and SIGTERM end the run cleanly.
RunOutcome run_deck(const Deck& deck, const RunOptions& options, RunRecord* record = nullptr);

}  // namespace quern
