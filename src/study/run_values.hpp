// Numbers that a user asks for by name: "grains.0.x.last", "history.kinetic.max", and formulas of them.
#pragma once

#include <string>
#include <vector>

#include "src/study/run_files.hpp"

namespace quern {

/// A formula of TABLE.COLUMN.STATISTIC: tables are history and grains.N (files of the run), columns those of
/// the file, statistics first, last, min, max and mean (over the rows that are numbers).
class RunValue {
  public:
    /// "FORMULA" or "NAME=FORMULA"; without a name the formula is the name. Throws InputError if it is no
    /// formula, or names what a run of this deck does not write.
    RunValue(const std::string& text, const Deck& deck);

    const std::string& name() const { return name_; }
    /// NaN where the run has no such rows, or the formula no finite value.
    double of(const RunFiles& run) const;

  private:
    struct Column {
        int grain = -1;  ///< -1: of the history
        std::string name, statistic;
    };
    std::string name_, formula_;   ///< columns as names that formulas take: v0, v1, ...
    std::vector<Column> columns_;  ///< v0, v1, ...
};

}  // namespace quern
