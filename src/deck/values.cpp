#include "src/deck/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "grid/error.hpp"
#include "src/deck/names.hpp"

namespace quern {
namespace {

Scalar read_scalar(const Cursor& at, const Context& now, const Key& key, Parameters::Wanted wanted) {
    if (at.node().kind != Node::Kind::scalar) {
        throw InputError(at.where(), at.node().description(), key.expectation(now.dimension));
    }
    return now.parameters.resolve(at.node(), at.where(), wanted);
}

std::string in_unit(const std::string& unit) {
    return unit.empty() ? unit : fmt::format(" in {}", unit);
}

/// " > 0 in kg/m^3": what follows the word "number".
std::string limits(const Range& range, const std::string& unit) {
    const std::string bounds = range.text();
    return bounds.empty() ? in_unit(unit) : fmt::format(" {}{}", bounds, in_unit(unit));
}

}  // namespace

bool Range::contains(double value) const {
    if (!std::isfinite(value)) return infinite && value > 0.0;
    return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
}

std::string Range::text() const {
    const bool above = std::isfinite(low), below = std::isfinite(high);
    if (above && below)
        return fmt::format("in {}{}, {}{}", low_open ? '(' : '[', low, high, high_open ? ')' : ']');
    if (above) return fmt::format("{} {}", low_open ? ">" : ">=", low);
    return below ? fmt::format("{} {}", high_open ? "<" : "<=", high) : "";
}

std::string Key::expectation(int deck_dimension) const {
    const std::string numbers = limits(range, unit);
    switch (form) {
        case Form::number:
            return words.empty() ? "a number" + numbers
                                 : fmt::format("a number{} or {}", numbers, join(words));
        case Form::integer:
            return "a whole number" + numbers;
        case Form::flag:
            return "true or false";
        case Form::word:
            return "one of " + join(words);
        case Form::text:
            return "text";
        case Form::vector:
            return fmt::format("a list of {} numbers{}", deck_dimension, numbers);
        case Form::turn:
            return deck_dimension == 2 ? "a number" + numbers : "a list of 3 numbers" + numbers;
        case Form::pair:
            return "a list of 2 numbers" + numbers;
        case Form::numbers:
            return "a list of numbers" + numbers;
        case Form::counts:
            return fmt::format("a list of {} whole numbers{}", deck_dimension, numbers);
        case Form::points:
            return "a list of at least 3 points [x, y]" + numbers;
        case Form::formula:
            return fmt::format("a formula of {}{}", join(words), in_unit(unit));
        case Form::formulas:
            return fmt::format("a list of {} formulas of {}{}", deck_dimension, join(words), in_unit(unit));
        case Form::axes:
            return "a list of axes, e.g. [x]";
        case Form::names:
            return "a list of 2 names";
        case Form::ids:
            return "all, a group, or a list of grain numbers (from 0) and groups";
        case Form::section:
            return "a section";
        case Form::list:
            return "a list of sections";
        case Form::named:
            return "names, each with its section";
    }
    return {};
}

std::string Key::obstacle(int deck_dimension, const std::string& type) const {
    if (dimension != 0 && dimension != deck_dimension) return fmt::format("in {}D", deck_dimension);
    if (!types.empty() && std::find(types.begin(), types.end(), type) == types.end()) {
        return fmt::format("to {}, only to {}", type, join(types));
    }
    return {};
}

double read_number(const Cursor& at, const Context& now, const Key& key) {
    const Scalar scalar = read_scalar(at, now, key, Parameters::Wanted::number);
    const bool infinite = key.range.infinite && (scalar.text == ".inf" || scalar.text == "inf");
    if (infinite) return no_limit;
    if (!scalar.number) {
        const bool arithmetic = scalar.text.find_first_of("*/+()") != std::string::npos;
        const std::string hint = arithmetic ? "arithmetic is written ${" + scalar.text + "}"
                                            : did_you_mean(scalar.text, key.words);
        throw InputError(at.where(), "'" + scalar.text + "'", key.expectation(now.dimension), hint);
    }
    const Dimension expected = parse_unit(key.unit.empty() ? "1" : key.unit)->dimension;
    if (scalar.number->dimension && *scalar.number->dimension != expected) {
        throw InputError(
            at.where(),
            fmt::format("'{}' (a quantity in {})", scalar.text, text_of(*scalar.number->dimension)),
            key.unit.empty() ? "a number without unit" : "a quantity in " + key.unit);
    }
    const double value = scalar.number->value;
    if (key.range.contains(value)) return value;
    const std::string& text = at.node().text;
    const bool plain = text == number_text(value);
    throw InputError(at.where(), plain ? fmt::format("'{}'", text) : fmt::format("'{}' = {}", text, value),
                     key.expectation(now.dimension));
}

int read_integer(const Cursor& at, const Context& now, const Key& key) {
    const double value = read_number(at, now, key);
    if (value != std::round(value) || std::abs(value) > 1e9) {
        throw InputError(at.where(), at.node().description(), key.expectation(now.dimension));
    }
    return static_cast<int>(value);
}

std::size_t read_word(const Cursor& at, const Context& now, const Key& key) {
    const std::string text = read_scalar(at, now, key, Parameters::Wanted::text).text;
    const auto found = std::find(key.words.begin(), key.words.end(), text);
    if (found == key.words.end()) {
        throw InputError(at.where(), "'" + text + "'", key.expectation(now.dimension),
                         did_you_mean(text, key.words));
    }
    return static_cast<std::size_t>(found - key.words.begin());
}

std::string read_text(const Cursor& at, const Context& now, const Key& key) {
    return read_scalar(at, now, key, Parameters::Wanted::text).text;
}

bool says(const Cursor& at, const Context& now, const std::string& word) {
    return at.node().kind == Node::Kind::scalar &&
           now.parameters.resolve(at.node(), at.where(), Parameters::Wanted::text).text == word;
}

Numbers3 read_vector(const Cursor& at, const Context& now, const Key& key) {
    check_size(at, static_cast<std::size_t>(now.dimension), key, now.dimension);
    Numbers3 values{};
    Key entry = key;
    entry.form = Form::number;
    for (std::size_t i = 0; i < at.node().items.size(); ++i) values[i] = read_number(at.entry(i), now, entry);
    return values;
}

Numbers3 read_turn(const Cursor& at, const Context& now, const Key& key) {
    if (now.dimension == 3) return read_vector(at, now, key);
    return {0.0, 0.0, read_number(at, now, key)};
}

Expression read_formula(const Cursor& at, const Context& now, const Key& key) {
    if (at.node().kind != Node::Kind::scalar) {
        throw InputError(at.where(), at.node().description(), key.expectation(now.dimension));
    }
    const std::optional<NumberAndRest> split = split_number(at.node().text);
    const bool after_formula = at.node().text.starts_with("${");
    const std::size_t brace = at.node().text.find('}');
    const std::string_view tail = split ? split->rest
                                  : after_formula && brace != std::string::npos
                                      ? trim(std::string_view(at.node().text).substr(brace + 1))
                                      : std::string_view("?");
    Key entry = key;
    entry.form = Form::number;
    entry.words.clear();
    // A quantity is a constant formula: "0.1 mm/us", "${speed}".
    const bool is_quantity = tail.empty() || parse_unit(tail);
    const bool is_text = tail.empty() && after_formula &&
                         !now.parameters.resolve(at.node(), at.where(), Parameters::Wanted::text).number;
    if (is_quantity && !is_text) return Expression(read_number(at, now, entry));
    const Expression formula(now.parameters.resolve_formula(at.node().text, at.where()), at.where());
    for (const char* variable : {"x", "y", "z", "t"}) {
        const bool allowed = std::find(key.words.begin(), key.words.end(), variable) != key.words.end();
        if (formula.uses(variable) && !allowed) {
            throw InputError(at.where(), fmt::format("'{}', which depends on {}", formula.text(), variable),
                             "a formula of " + join(key.words));
        }
    }
    return formula;
}

std::vector<Expression> read_formulas(const Cursor& at, const Context& now, const Key& key) {
    check_size(at, static_cast<std::size_t>(now.dimension), key, now.dimension);
    std::vector<Expression> formulas;
    Key component = key;
    component.form = Form::formula;
    for (std::size_t i = 0; i < at.node().items.size(); ++i)
        formulas.push_back(read_formula(at.entry(i), now, component));
    return formulas;
}

void check_list(const Cursor& at) {
    if (at.node().kind != Node::Kind::list) throw InputError(at.where(), at.node().description(), "a list");
}

void check_size(const Cursor& at, std::size_t size, const Key& key, int dimension) {
    const Node& node = at.node();
    if (node.kind == Node::Kind::list && node.items.size() == size) return;
    const std::size_t n = node.items.size();
    throw InputError(at.where(),
                     node.kind == Node::Kind::list ? fmt::format("a list of {}", n) : node.description(),
                     key.expectation(dimension));
}

void check_names(const Cursor& at, const std::vector<std::string>& names) {
    for (const std::string& name : at.node().names) {
        if (std::find(names.begin(), names.end(), name) != names.end()) continue;
        throw InputError(at.where(name), "an unknown key", "one of " + join(names),
                         did_you_mean(name, names));
    }
}

void check_group_name(const std::string& name, const std::string& where) {
    if (!name.empty() && name != "all" && !split_number(name) &&
        name.find_first_of(",#") == std::string::npos)
        return;
    throw InputError(where, "'" + name + "'", "the name of a group",
                     "no number at its beginning, not all, no comma");
}

std::string number_text(double value) {
    return std::isinf(value) ? std::string(".inf") : fmt::format("{}", value);
}

std::string vector_text(const Numbers3& values, int dimension) {
    std::string text = number_text(values[0]);
    for (std::size_t i = 1; i < static_cast<std::size_t>(dimension); ++i)
        text += ", " + number_text(values[i]);
    return fmt::format("[{}]", text);
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        const auto code = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            result += {'\\', c};
        } else if (code < 0x20) {
            result += fmt::format("\\x{:02x}", code);
        } else {
            result += c;
        }
    }
    return result + "\"";
}

std::string quoted_name(const std::string& name) {
    const bool plain = !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
    });
    return plain ? name : quoted(name);
}

std::string formula_text(const Expression& formula) {
    return formula.is_constant() ? number_text(formula(0.0)) : quoted(formula.text());
}

std::string formulas_text(const std::vector<Expression>& formulas) {
    std::string text;
    for (const Expression& formula : formulas) text += (text.empty() ? "" : ", ") + formula_text(formula);
    return text.empty() ? text : fmt::format("[{}]", text);
}

std::string ids_text(const std::vector<int>& ids) {
    return fmt::format("[{}]", fmt::join(ids, ", "));
}

std::string indented(const std::string& lines) {
    std::istringstream stream(lines);
    std::string result;
    for (std::string line; std::getline(stream, line);) result += "  " + line + "\n";
    return result;
}

}  // namespace quern
