// For the example reports: the table of all cases, for reading by programs.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace quern {

/// Cases by columns of numbers, written as CSV and as JSON (a list of objects; no number: empty, null).
class ReportTable {
  public:
    /// The first column is "case", a name.
    explicit ReportTable(std::vector<std::string> columns) : columns_(std::move(columns)) {}

    /// `values` as many as columns.
    void add(const std::string& name, std::vector<double> values);

    /// Writes DIR/NAME.csv and DIR/NAME.json. Throws OutputError.
    void write(const std::string& directory, const std::string& name) const;

  private:
    std::vector<std::string> columns_;
    std::vector<std::pair<std::string, std::vector<double>>> rows_;
};

}  // namespace quern
