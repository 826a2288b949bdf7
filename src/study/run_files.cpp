#include "src/study/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "grid/error.hpp"

namespace quern {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

double to_number(std::string_view text) {
    double value = none;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size() ? value : none;
}

template <class Use>
void for_each_cell(std::string_view line, Use&& use) {
    if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.size(), line.find(',', begin));
        use(line.substr(begin, end - begin));
        begin = end + 1;
    }
}

}  // namespace

const std::vector<double>* Columns::find(std::string_view name) const {
    const auto at = std::find(names.begin(), names.end(), name);
    return at == names.end() ? nullptr : &values[static_cast<std::size_t>(at - names.begin())];
}

Columns read_columns(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream buffer;
    if (std::filesystem::is_directory(file) || !stream || !(buffer << stream.rdbuf()))
        throw InputError(file, "no file that can be read", "a table of numbers (CSV) with a row of names");
    const std::string text = buffer.str();
    Columns columns;
    int number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        const std::size_t end = text.find('\n', begin);
        if (end == std::string::npos && number > 0) break;
        const std::string_view line = std::string_view(text).substr(begin, end - begin);
        begin = end == std::string::npos ? text.size() : end + 1;
        if (++number == 1) {
            for_each_cell(line, [&](std::string_view cell) { columns.names.emplace_back(cell); });
            columns.values.resize(columns.names.size());
            continue;
        }
        std::size_t c = 0;
        for_each_cell(line, [&](std::string_view cell) {
            if (c < columns.values.size()) columns.values[c].push_back(to_number(cell));
            ++c;
        });
        if (c != columns.values.size())
            throw InputError(fmt::format("{}:{}", file, number), fmt::format("{} cells", c),
                             fmt::format("{}, one a column", columns.values.size()));
    }
    return columns;
}

std::vector<std::string> read_texts(const std::string& file, std::string_view column) {
    std::ifstream stream(file, std::ios::binary);
    std::string line;
    std::size_t wanted = 0, number = 0;
    std::vector<std::string> texts;
    while (std::getline(stream, line) && !stream.eof()) {
        std::size_t c = 0;
        for_each_cell(line, [&](std::string_view cell) {
            if (number == 0 && cell == column) wanted = c;
            if (number > 0 && c == wanted) texts.emplace_back(cell);
            ++c;
        });
        ++number;
    }
    return texts;
}

std::map<int, Columns> split_by_grain(const Columns& all) {
    const std::vector<double>* grain = all.find("grain");
    if (!grain) return {{0, all}};
    std::map<int, Columns> grains;
    for (std::size_t i = 0; i < all.n_rows(); ++i) {
        Columns& own = grains[static_cast<int>((*grain)[i])];
        if (own.names.empty()) {
            own.names = all.names;
            own.values.resize(all.values.size());
        }
        for (std::size_t c = 0; c < all.values.size(); ++c) own.values[c].push_back(all.values[c][i]);
    }
    return grains;
}

RunSummary::RunSummary(const std::string& directory) {
    try {
        root_ = read_tree(directory + "/summary.json");  // JSON is YAML
    } catch (const InputError&) {
        root_ = Node();
    }
}

const Node* RunSummary::find(const std::string& path) const {
    const Node* node = &root_;
    for (std::size_t begin = 0; node && begin <= path.size();) {
        const std::size_t end = std::min(path.size(), path.find('.', begin));
        node = node->find(path.substr(begin, end - begin));
        begin = end + 1;
    }
    return node;
}

double RunSummary::number(const std::string& path) const {
    const Node* node = find(path);
    return node && node->kind == Node::Kind::scalar ? to_number(node->text) : none;
}

std::string RunSummary::text(const std::string& path) const {
    const Node* node = find(path);
    return node ? node->text : std::string();
}

std::vector<std::pair<std::string, double>> RunSummary::members(const std::string& path) const {
    std::vector<std::pair<std::string, double>> numbers;
    if (const Node* node = find(path))
        for (std::size_t i = 0; i < node->names.size(); ++i)
            numbers.emplace_back(node->names[i], to_number(node->items[i].text));
    return numbers;
}

double RunSummary::n_warnings() const {
    double n = 0;
    if (const Node* list = find("warnings"))
        for (const Node& item : list->items)
            if (const Node* count = item.find("count")) n += to_number(count->text);
    return n;
}

std::string RunSummary::warnings() const {
    std::string all;
    if (const Node* list = find("warnings"))
        for (const Node& item : list->items)
            if (const Node* text = item.find("text"), *count = item.find("count"); text && count)
                all += fmt::format("{}{} ({} times)", all.empty() ? "" : "; ", text->text, count->text);
    return all;
}

RunFiles read_run(const std::string& directory) {
    RunFiles run;
    run.summary = RunSummary(directory);
    if (std::filesystem::exists(directory + "/history.csv"))
        run.history = read_columns(directory + "/history.csv");
    if (std::filesystem::exists(directory + "/grains.csv"))
        run.grains = split_by_grain(read_columns(directory + "/grains.csv"));
    return run;
}

}  // namespace quern
