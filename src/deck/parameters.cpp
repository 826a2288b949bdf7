#include "src/deck/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "grid/error.hpp"
#include "src/deck/expression.hpp"
#include "src/deck/names.hpp"

namespace quern {
namespace {

bool is_name(std::string_view text) {
    const auto letter = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_'; };
    return !text.empty() && !std::isdigit(static_cast<unsigned char>(text[0])) &&
           std::all_of(text.begin(), text.end(), letter);
}

/// One `${...}`: begin and end (one past the brace) in the text.
struct Span {
    std::size_t begin, end;
};

std::optional<Span> find_formula(const std::string& text, std::size_t from, const std::string& where) {
    const std::size_t begin = text.find("${", from);
    if (begin == std::string::npos) return std::nullopt;
    const std::size_t end = text.find('}', begin);
    if (end == std::string::npos) throw InputError(where, "'" + text + "'", "'}' after '${'");
    return Span{begin, end + 1};
}

std::string inside(const std::string& text, const Span& span) {
    return std::string(trim(std::string_view(text).substr(span.begin + 2, span.end - span.begin - 3)));
}

std::string number_text(const Quantity& number) {
    return fmt::format("{}", number.value);
}

}  // namespace

std::optional<Quantity> parse_quantity(const std::string& text, const std::string& where) {
    const std::optional<NumberAndRest> split = split_number(text);
    if (!split) return std::nullopt;
    if (split->rest.empty()) return Quantity{split->number, std::nullopt};
    const std::string unit_text(split->rest);
    const std::optional<Unit> unit = parse_unit(unit_text);
    if (!unit) {
        const bool formula = unit_text.find_first_of("*+-/(") == 0;
        throw InputError(where, "'" + text + "'", "a number, or a number and a unit",
                         formula ? "arithmetic is written ${" + text + "}"
                                 : fmt::format("unknown unit '{}'; {}", unit_text,
                                               did_you_mean(unit_text, unit_names()).empty()
                                                   ? "text that begins with a digit needs quotes"
                                                   : did_you_mean(unit_text, unit_names())));
    }
    return Quantity{split->number * unit->numerator / unit->denominator, unit->dimension};
}

Parameters::Parameters(const Cursor& params) {
    const std::vector<std::string> reserved = formula_words();
    for (std::size_t i = 0; i < params.node().items.size(); ++i) {
        const Cursor at = params.entry(i);
        const std::string& name = params.node().names[i];
        if (!is_name(name)) {
            throw InputError(at.where(), "the name '" + name + "'", "letters, digits and _, a letter first");
        }
        const bool is_axis = name == "x" || name == "y" || name == "z" || name == "t";
        if (is_axis || std::find(reserved.begin(), reserved.end(), name) != reserved.end()) {
            throw InputError(at.where(), "the name '" + name + "'",
                             "a name that formulas do not use already");
        }
        if (at.node().kind != Node::Kind::scalar) {
            throw InputError(at.where(), at.node().description(), "a number, a quantity, text or ${formula}");
        }
        parameters_[name] = {at.node(), at.where(), Parameter::State::waiting, {}};
    }
    for (const auto& [name, parameter] : parameters_) value_of(name, parameter.where);
}

const Scalar& Parameters::value_of(const std::string& name, const std::string& where) const {
    const auto found = parameters_.find(name);
    if (found == parameters_.end()) {
        std::vector<std::string> names;
        for (const auto& [known, parameter] : parameters_) names.push_back(known);
        throw InputError(where, "the unknown parameter '" + name + "'",
                         names.empty() ? "a name under params" : "one of " + join(names),
                         did_you_mean(name, names));
    }
    Parameter& parameter = found->second;
    if (parameter.state == Parameter::State::done) return parameter.value;
    chain_.push_back(name);
    if (parameter.state == Parameter::State::resolving) {
        throw InputError(parameter.where, "parameters in a circle: " + join(chain_, " -> "),
                         "parameters that end in numbers");
    }
    parameter.state = Parameter::State::resolving;
    parameter.value = resolve(parameter.node, parameter.where, Wanted::number);
    parameter.state = Parameter::State::done;
    chain_.pop_back();
    return parameter.value;
}

Scalar Parameters::value_of_formula(const std::string& formula, const std::string& where) const {
    if (is_name(formula) && formula != "pi") return value_of(formula, where);
    const auto number = [&](const std::string& name) {
        const Scalar& value = value_of(name, where);
        if (value.number) return value.number->value;
        throw InputError(where, fmt::format("parameter {} = '{}'", name, value.text),
                         "a number in a formula");
    };
    const Quantity value{evaluate(formula, number, where), std::nullopt};
    return {number_text(value), value};
}

Scalar Parameters::resolve(const Node& node, const std::string& where, Wanted wanted) const {
    const bool number_wanted = wanted == Wanted::number && !node.quoted;
    const std::string text(trim(node.text));
    const std::optional<Span> first = find_formula(text, 0, where);
    if (!first) {
        if (!number_wanted) return {node.text, std::nullopt};
        return {text, parse_quantity(text, where)};
    }
    const std::string rest(trim(text.substr(first->end)));
    const std::optional<Unit> unit = parse_unit(rest);
    if (first->begin == 0 && (rest.empty() || unit)) {
        Scalar value = value_of_formula(inside(text, *first), where);
        if (rest.empty()) return value;
        if (value.number && !value.number->dimension) {
            const Quantity number{value.number->value * unit->numerator / unit->denominator, unit->dimension};
            return {number_text(number), number};
        }
        if (value.number) {
            throw InputError(where, fmt::format("'{}' after a parameter that has a unit", rest), "one unit",
                             "parameters are in SI units");
        }
    }
    std::string result;
    std::size_t at = 0;
    for (std::optional<Span> span = first; span; span = find_formula(text, at, where)) {
        result += text.substr(at, span->begin - at) + value_of_formula(inside(text, *span), where).text;
        at = span->end;
    }
    result += text.substr(at);
    if (!number_wanted) return {result, std::nullopt};
    return {result, parse_quantity(result, where)};
}

std::string Parameters::resolve_formula(const std::string& text, const std::string& where) const {
    std::string result;
    std::size_t at = 0;
    while (const std::optional<Span> span = find_formula(text, at, where)) {
        const Scalar value = value_of_formula(inside(text, *span), where);
        const std::string word = value.number ? number_text(*value.number) : value.text;
        result += text.substr(at, span->begin - at) + "(" + word + ")";
        at = span->end;
    }
    return result + text.substr(at);
}

}  // namespace quern
