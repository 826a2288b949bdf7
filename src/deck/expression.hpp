// A function of x, y, z and t, written in the deck and evaluated by muparser.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "grid/vec.hpp"

namespace quern {

/// Cheap to copy; a constant is evaluated without the parser. Not thread-safe: evaluate on one thread only.
class Expression {
  public:
    Expression() = default;  ///< the constant 0
    explicit Expression(double constant) : constant_(constant) {}
    /// Throws InputError (at `where`, with the parser's word) if `text` is not a formula of x, y, z, t.
    Expression(const std::string& text, const std::string& where);

    double operator()(double x, double y, double z, double t) const;
    double operator()(double t) const { return (*this)(0.0, 0.0, 0.0, t); }
    bool is_constant() const { return !formula_; }
    bool uses(const std::string& variable) const;  ///< "x", "y", "z" or "t"
    std::string text() const;

  private:
    struct Formula;
    std::shared_ptr<Formula> formula_;
    double constant_ = 0.0;
};

/// Value of a formula of named numbers; `value_of` is asked once for each name that occurs in it.
/// Throws InputError at `where` if the formula is none, or if its value is not finite.
double evaluate(const std::string& text, const std::function<double(const std::string&)>& value_of,
                const std::string& where);

/// Names that a formula understands without being told: functions and pi.
std::vector<std::string> formula_words();

}  // namespace quern
