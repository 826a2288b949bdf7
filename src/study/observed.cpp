#include "src/study/observed.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "grid/error.hpp"

namespace quern {

ObservedTable::ObservedTable(const std::string& directory, const std::string& name)
    : file_(directory + "/" + name + ".csv"), columns_(read_columns(file_)) {
    for (const char* text : {"region", "profile", "name"})
        if (columns_.find(text)) texts_ = read_texts(file_, text);
}

const std::vector<double>& ObservedTable::column(std::string_view name) const {
    const std::vector<double>* found = columns_.find(name);
    if (found == nullptr)
        throw InputError(file_, fmt::format("no column '{}'", name), "a table as quern run writes it");
    return *found;
}

std::vector<std::size_t> ObservedTable::rows(double time, const std::string& text) const {
    const std::vector<double>& times = column("time");
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < times.size(); ++i)
        if (times[i] == time && (text.empty() || texts_[i] == text)) rows.push_back(i);
    return rows;
}

std::vector<std::size_t> ObservedTable::rows_of(const std::string& text) const {
    std::vector<std::size_t> rows;
    for (std::size_t i = 0; i < texts_.size(); ++i)
        if (texts_[i] == text) rows.push_back(i);
    return rows;
}

std::vector<std::string> ObservedTable::names() const {
    std::vector<std::string> names;
    for (const std::string& text : texts_)
        if (std::find(names.begin(), names.end(), text) == names.end()) names.push_back(text);
    return names;
}

std::vector<double> ObservedTable::times() const {
    std::vector<double> times = column("time");
    times.erase(std::unique(times.begin(), times.end()), times.end());
    return times;
}

std::vector<double> ObservedTable::pick(std::string_view name, const std::vector<std::size_t>& rows) const {
    const std::vector<double>& from = column(name);
    std::vector<double> cells;
    for (const std::size_t i : rows) cells.push_back(from[i]);
    return cells;
}

}  // namespace quern
