#include "src/study/run_values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numeric>
#include <regex>

#include "grid/error.hpp"
#include "src/deck/expression.hpp"
#include "src/deck/names.hpp"
#include "src/results/writer.hpp"
#include "src/study/settings.hpp"

namespace quern {

namespace {

const std::vector<std::string> statistics = {"first", "last", "min", "max", "mean"};

double statistic_of(const std::vector<double>& rows, const std::string& which) {
    std::vector<double> numbers;
    std::copy_if(rows.begin(), rows.end(), std::back_inserter(numbers),
                 [](double x) { return std::isfinite(x); });
    if (numbers.empty()) return std::numeric_limits<double>::quiet_NaN();
    if (which == "first") return numbers.front();
    if (which == "last") return numbers.back();
    if (which == "min") return *std::min_element(numbers.begin(), numbers.end());
    if (which == "max") return *std::max_element(numbers.begin(), numbers.end());
    return std::accumulate(numbers.begin(), numbers.end(), 0.0) / static_cast<double>(numbers.size());
}

void require(const std::string& name, const std::vector<std::string>& known, const std::string& where,
             const std::string& what) {
    if (std::find(known.begin(), known.end(), name) == known.end())
        throw InputError(where, "the unknown " + what + " '" + name + "'", "one of " + join(known),
                         did_you_mean(name, known));
}

/// Number of a tracked grain.
int tracked_grain(const std::string& text, const Deck& deck, const std::string& where) {
    int grain = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), grain);
    const auto n = static_cast<int>(deck.grains.size());
    if (error != std::errc() || end != text.data() + text.size() || grain < 0 || grain >= n)
        throw InputError(where, "'" + text + "'", fmt::format("a grain from 0 to {}", n - 1));
    const std::vector<int>& track = deck.output.track;
    if (!deck.output.track_all && std::find(track.begin(), track.end(), grain) == track.end())
        throw InputError(where, fmt::format("grain {}", grain), "a grain of output.track",
                         fmt::format("--set output.track='[{}]'", grain));
    return grain;
}

}  // namespace

RunValue::RunValue(const std::string& text, const Deck& deck) {
    static const std::regex head("^\\s*([A-Za-z_][A-Za-z0-9_]*)\\s*=(?!=)\\s*(.*)$"),
        path("(history|grains)(\\.[A-Za-z0-9_]*)+");
    std::smatch found;
    const bool named = std::regex_match(text, found, head);
    std::string rest = named ? found[2].str() : text;
    name_ = named ? found[1].str() : rest;
    const std::string where = "--value: " + name_;
    if (rest.empty()) throw InputError(where, "nothing", "a formula, such as grains.0.x.last");
    while (std::regex_search(rest, found, path)) {
        const std::vector<std::string> parts = split_outside(found.str(), '.', where);
        const bool of_grain = parts[0] == "grains";
        if (parts.size() != (of_grain ? 4u : 3u))
            throw InputError(where, "'" + found.str() + "'",
                             of_grain ? "grains.NUMBER.COLUMN.STATISTIC" : "history.COLUMN.STATISTIC",
                             "statistics: " + join(statistics));
        Column column;
        if (of_grain) column.grain = tracked_grain(parts[1], deck, where);
        column.name = parts[of_grain ? 2 : 1];
        column.statistic = parts.back();
        require(column.name, of_grain ? grain_columns(deck.dimension) : history_columns(deck.dimension),
                where, "column");
        require(column.statistic, statistics, where, "statistic");
        formula_ += found.prefix().str() + fmt::format("v{}", columns_.size());
        columns_.push_back(column);
        rest = found.suffix();
    }
    formula_ += rest;
    if (columns_.empty())
        throw InputError(where, "'" + formula_ + "'", "a formula of columns, such as grains.0.x.last");
    // Any numbers will do to see whether it is a formula; unlike ones, so that differences are not 0.
    double any = 1.0;
    evaluate(
        formula_,
        [&](const std::string& name) {
            if (name[0] != 'v' || name.find_first_not_of("0123456789", 1) != std::string::npos)
                throw InputError(where, "the unknown name '" + name + "'",
                                 "columns as history.COLUMN.STATISTIC or grains.NUMBER.COLUMN.STATISTIC");
            return any += 0.7368;
        },
        where);
}

double RunValue::of(const RunFiles& run) const {
    const auto value = [&](const std::string& name) {
        const Column& column = columns_[std::stoul(name.substr(1))];
        const auto grain = run.grains.find(column.grain);
        const Columns empty;
        const Columns& table = column.grain < 0            ? run.history
                               : grain == run.grains.end() ? empty
                                                           : grain->second;
        const std::vector<double>* rows = table.find(column.name);
        return rows ? statistic_of(*rows, column.statistic) : std::numeric_limits<double>::quiet_NaN();
    };
    try {
        return evaluate(formula_, value, name_);
    } catch (const InputError&) {
        return std::numeric_limits<double>::quiet_NaN();  // no finite value
    }
}

}  // namespace quern
