#include "src/sim/study.hpp"

#include <algorithm>
#include <cmath>

#include "grid/error.hpp"
#include "src/deck/read_deck.hpp"

namespace quern {

RunRecord run_case(const std::string& deck, const std::vector<std::string>& overrides,
                   const std::string& directory) {
    RunRecord record;
    RunOptions options;
    options.directory = directory;
    options.threads = 1;
    if (run_deck(read_deck(deck, overrides), options, &record) == RunOutcome::interrupted)
        throw SimulationError("interrupted; the results so far are in " + directory);
    return record;
}

std::vector<GrainRow> rows_of(const RunRecord& record, int grain) {
    std::vector<GrainRow> rows;
    std::copy_if(record.grains.begin(), record.grains.end(), std::back_inserter(rows),
                 [&](const GrainRow& row) { return row.grain == grain; });
    return rows;
}

const GrainRow& row_at(const std::vector<GrainRow>& rows, double time) {
    return *std::min_element(rows.begin(), rows.end(), [&](const GrainRow& a, const GrainRow& b) {
        return std::abs(a.time - time) < std::abs(b.time - time);
    });
}

}  // namespace quern
