// A function of x, y, z and t, written in the deck and evaluated by muparser.
#pragma once

#include <memory>
#include <string>

#include "grid/vec.hpp"

namespace quern {

/// Cheap to copy; a constant is evaluated without the parser. Not thread-safe: evaluate on one thread only.
class Expression {
  public:
    Expression() = default;                   ///< the constant 0
    explicit Expression(double constant) : constant_(constant) {}
    /// Throws InputError (at `where`, with the parser's word) if `text` is not a formula of x, y, z, t.
    Expression(const std::string& text, const std::string& where);

    double operator()(double x, double y, double z, double t) const;
    double operator()(double t) const { return (*this)(0.0, 0.0, 0.0, t); }
    bool is_constant() const { return !formula_; }
    std::string text() const;

  private:
    struct Formula;
    std::shared_ptr<Formula> formula_;
    double constant_ = 0.0;
};

}  // namespace quern
