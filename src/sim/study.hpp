// For the example reports: run a deck with other parameters and keep its numbers.
#pragma once

#include <string>
#include <vector>

#include "src/sim/run.hpp"

namespace quern {

/// Runs `deck` with `overrides` ("params.mu=0.3", as --set) on one thread into `directory`. Throws
/// SimulationError if the run is interrupted: half a run has no numbers to report.
RunRecord run_case(const std::string& deck, const std::vector<std::string>& overrides,
                   const std::string& directory);

/// Rows of one grain, in time.
std::vector<GrainRow> rows_of(const RunRecord& record, int grain);

/// One column of rows.
template <class Row, class Value>
std::vector<double> column(const std::vector<Row>& rows, Value value) {
    std::vector<double> column;
    for (const Row& row : rows) column.push_back(value(row));
    return column;
}

/// The row nearest to a time. `rows` must not be empty.
const GrainRow& row_at(const std::vector<GrainRow>& rows, double time);

}  // namespace quern
