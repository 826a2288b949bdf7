#include "src/study/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "src/results/json.hpp"

namespace quern {

namespace {

std::string csv_text(const std::string& text) {
    if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"') quoted += c;
        quoted += c;
    }
    return quoted + '"';
}

std::string markdown_text(const std::string& text) {
    std::string safe;
    for (const char c : text) {
        if (c == '|') safe += '\\';
        safe += c == '\n' ? ' ' : c;
    }
    return safe;
}

}  // namespace

std::string readable(double value) {
    if (!std::isfinite(value)) return "-";
    if (value == std::rint(value) && std::abs(value) < 1e7) return fmt::format("{:.0f}", value);
    return fmt::format("{:.4g}", value);
}

void Table::add(std::vector<Cell> row) {
    if (row.size() != columns_.size())
        throw std::invalid_argument(
            fmt::format("Table: a row of {} cells under {} columns", row.size(), columns_.size()));
    rows_.push_back(std::move(row));
}

std::string Table::csv() const {
    std::string text;
    for (std::size_t c = 0; c < columns_.size(); ++c)
        text += fmt::format("{}{}", c > 0 ? "," : "", csv_text(columns_[c]));
    text += "\n";
    for (const std::vector<Cell>& row : rows_) {
        for (std::size_t c = 0; c < row.size(); ++c) {
            if (c > 0) text += ",";
            if (!row[c].is_number) text += csv_text(row[c].text);
            if (row[c].is_number && std::isfinite(row[c].number)) text += fmt::format("{}", row[c].number);
        }
        text += "\n";
    }
    return text;
}

std::string Table::json() const {
    std::string text = "[";
    for (const std::vector<Cell>& row : rows_) {
        text += text.size() > 1 ? ",\n  {" : "\n  {";
        for (std::size_t c = 0; c < row.size(); ++c)
            text += fmt::format("{}{}: {}", c > 0 ? ", " : "", json_string(columns_[c]),
                                row[c].is_number ? json_number(row[c].number) : json_string(row[c].text));
        text += "}";
    }
    return text + (rows_.empty() ? "]" : "\n]");
}

std::string Table::markdown() const {
    std::string heads = "|", rule = "|", body;
    for (std::size_t c = 0; c < columns_.size(); ++c) {
        const bool numbers = std::all_of(rows_.begin(), rows_.end(),
                                         [&](const std::vector<Cell>& row) { return row[c].is_number; });
        heads += fmt::format(" {} |", markdown_text(columns_[c]));
        rule += numbers ? " ---: |" : " --- |";
    }
    for (const std::vector<Cell>& row : rows_) {
        body += "|";
        for (const Cell& cell : row)
            body += fmt::format(" {} |", cell.is_number ? readable(cell.number) : markdown_text(cell.text));
        body += "\n";
    }
    return heads + "\n" + rule + "\n" + body;
}

}  // namespace quern
