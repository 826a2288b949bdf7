// The tables of observers of a run, read back frame by frame.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "src/study/run_files.hpp"

namespace quern {

/// A table whose rows stand frame after frame.
class ObservedTable {
  public:
    /// NAME.csv of a run. Throws InputError if it is missing.
    ObservedTable(const std::string& directory, const std::string& name);

    const std::vector<double>& column(std::string_view name) const;
    bool has(std::string_view name) const { return columns_.find(name) != nullptr; }
    const std::vector<std::string>& texts() const { return texts_; }  ///< of the column of names, a row each
    std::size_t n_rows() const { return columns_.n_rows(); }
    /// Rows at this time whose name is `text`; empty `text`: of any name.
    std::vector<std::size_t> rows(double time, const std::string& text = {}) const;
    /// Rows of a name, at all times.
    std::vector<std::size_t> rows_of(const std::string& text) const;
    std::vector<std::string> names() const;  ///< different texts, in their order
    std::vector<double> times() const;       ///< different ones, ascending
    /// Cells of a column in some rows.
    std::vector<double> pick(std::string_view name, const std::vector<std::size_t>& rows) const;

  private:
    std::string file_;
    Columns columns_;
    std::vector<std::string> texts_;
};

}  // namespace quern
