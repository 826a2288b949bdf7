// Tables of texts and numbers, as CSV, JSON and Markdown.
#pragma once

#include <string>
#include <vector>

namespace quern {

/// A text, a number, or nothing (a number that is none).
struct Cell {
    Cell(double value) : number(value), is_number(true) {}
    Cell(std::string value) : text(std::move(value)) {}
    Cell(const char* value) : text(value) {}
    std::string text;
    double number = 0.0;
    bool is_number = false;
};

/// Four digits, as short as they can be: "0.9781", "1.3e-15", "12740"; "-" for no number.
std::string readable(double value);

class Table {
  public:
    explicit Table(std::vector<std::string> columns) : columns_(std::move(columns)) {}

    void add(std::vector<Cell> row);  ///< as many cells as columns
    /// Numbers as short as reads back to the same bits; empty for none.
    std::string csv() const;
    /// A list of objects, indented by two spaces; null for no number.
    std::string json() const;
    /// Columns of numbers to the right, by readable().
    std::string markdown() const;
    bool empty() const { return rows_.empty(); }

  private:
    std::vector<std::string> columns_;
    std::vector<std::vector<Cell>> rows_;
};

}  // namespace quern
