#include "src/deck/expression.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <array>
#include <cmath>
#include <numbers>

#include "grid/error.hpp"
#include "src/deck/names.hpp"

namespace quern {
namespace {

const std::array<std::string, 4> axes = {"x", "y", "z", "t"};

double choose(double condition, double yes, double no) {
    return condition != 0.0 ? yes : no;
}
double power(double base, double exponent) {
    return std::pow(base, exponent);
}

mu::Parser make_parser(const std::string& text) {
    mu::Parser parser;
    parser.DefineConst("pi", std::numbers::pi);
    parser.DefineFun("if", choose);
    parser.DefineFun("pow", power);
    parser.SetExpr(text);
    return parser;
}

/// muparser would take "x = 1" as an assignment and "1, 2" as two results.
bool assigns(const std::string& text) {
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '=') continue;
        if (i + 1 < text.size() && text[i + 1] == '=') {
            ++i;
        } else if (i == 0 || std::string("<>!").find(text[i - 1]) == std::string::npos) {
            return true;
        }
    }
    return false;
}

double evaluate_once(mu::Parser& parser) {
    int n_results = 0;
    const double* results = parser.Eval(n_results);
    if (n_results != 1) throw mu::ParserError("more than one value");
    return results[0];
}

[[noreturn]] void fail(const std::string& where, const std::string& text, const mu::ParserError& error,
                       const std::string& expected) {
    std::string word = error.GetMsg();
    if (!word.empty() && word.back() == '.') word.pop_back();
    throw InputError(where, "'" + text + "'", expected, word);
}

}  // namespace

struct Expression::Formula {
    mu::Parser parser;
    std::string text;
    std::array<double, 4> at{};
};

Expression::Expression(const std::string& text, const std::string& where) {
    const std::string expected = "a formula of x, y, z, t";
    if (assigns(text))
        throw InputError(where, "'" + text + "'", expected, "an assignment has no value; == compares");
    try {
        mu::Parser parser = make_parser(text);
        const mu::varmap_type used = parser.GetUsedVar();
        for (const auto& [name, address] : used) {
            if (std::find(axes.begin(), axes.end(), name) != axes.end()) continue;
            const std::string nearest = nearest_name(name, formula_words());
            throw InputError(
                where, fmt::format("the unknown name '{}' in '{}'", name, text), expected,
                nearest.empty() ? "a parameter is written ${" + name + "}" : "did you mean " + nearest + "?");
        }
        if (used.empty()) {
            constant_ = evaluate_once(parser);
            if (!std::isfinite(constant_)) {
                throw InputError(where, fmt::format("'{}' = {}", text, constant_), "a finite number");
            }
            return;
        }
        formula_ = std::make_shared<Formula>();
        formula_->parser = std::move(parser);
        formula_->text = text;
        for (std::size_t i = 0; i < axes.size(); ++i) formula_->parser.DefineVar(axes[i], &formula_->at[i]);
        evaluate_once(formula_->parser);
    } catch (const mu::ParserError& error) {
        fail(where, text, error, expected);
    }
}

double Expression::operator()(double x, double y, double z, double t) const {
    if (!formula_) return constant_;
    formula_->at = {x, y, z, t};
    return formula_->parser.Eval();
}

bool Expression::uses(const std::string& variable) const {
    return formula_ && formula_->parser.GetUsedVar().count(variable) > 0;
}

std::string Expression::text() const {
    return formula_ ? formula_->text : fmt::format("{}", constant_);
}

double evaluate(const std::string& text, const std::function<double(const std::string&)>& value_of,
                const std::string& where) {
    const std::string expected = "a formula of numbers and parameters";
    if (assigns(text))
        throw InputError(where, "'" + text + "'", expected, "an assignment has no value; == compares");
    try {
        mu::Parser parser = make_parser(text);
        const mu::varmap_type used = parser.GetUsedVar();
        for (const auto& [name, address] : used) parser.DefineConst(name, value_of(name));
        const double value = evaluate_once(parser);
        if (!std::isfinite(value))
            throw InputError(where, fmt::format("'{}' = {}", text, value), "a finite number");
        return value;
    } catch (const mu::ParserError& error) {
        fail(where, text, error, expected);
    }
}

std::vector<std::string> formula_words() {
    const mu::Parser parser = make_parser("0");
    std::vector<std::string> words;
    for (const auto& [name, value] : parser.GetConst()) words.push_back(name);
    for (const auto& [name, function] : parser.GetFunDef()) words.push_back(name);
    return words;
}

}  // namespace quern
