// What a run left behind, read back: summary.json and the columns of history.csv and grains.csv.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "src/deck/tree.hpp"

namespace quern {

/// Columns of numbers under names.
struct Columns {
    std::vector<std::string> names;
    std::vector<std::vector<double>> values;  ///< one a name, all of one length

    /// Null if there is no such column.
    const std::vector<double>* find(std::string_view name) const;
    std::size_t n_rows() const { return values.empty() ? 0 : values.front().size(); }
};

/// Reads a CSV file with a row of names; what is no number is NaN; a last line without its end is left out,
/// as a run that was killed leaves it. Throws InputError if the file cannot be read or a row has another
/// length.
Columns read_columns(const std::string& file);

/// A column of texts of such a file.
std::vector<std::string> read_texts(const std::string& file, std::string_view column);

/// Rows of each grain by the column "grain"; all of grain 0 if there is none.
std::map<int, Columns> split_by_grain(const Columns& all);

/// summary.json of a run. Members of members by path: "energy.friction".
class RunSummary {
  public:
    RunSummary() = default;  ///< of a run that has none
    /// Empty if the file is missing or broken.
    explicit RunSummary(const std::string& directory);

    bool exists() const { return root_.kind == Node::Kind::map; }
    double number(const std::string& path) const;     ///< NaN if missing or null
    std::string text(const std::string& path) const;  ///< "" if missing
    /// Numbers of a member, in their order: ("contact", seconds), ... of "stages".
    std::vector<std::pair<std::string, double>> members(const std::string& path) const;
    double n_warnings() const;     ///< counts of all warnings
    std::string warnings() const;  ///< "text (count times); ..."

  private:
    const Node* find(const std::string& path) const;
    Node root_;
};

/// All of a run; tables are empty where a file is missing.
struct RunFiles {
    RunSummary summary;
    Columns history;
    std::map<int, Columns> grains;
};

RunFiles read_run(const std::string& directory);

}  // namespace quern
