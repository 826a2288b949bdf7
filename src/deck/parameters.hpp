// The deck's parameters, and what `${...}` in a text stands for.
#pragma once

#include <map>
#include <string>

#include "src/deck/tree.hpp"
#include "src/deck/units.hpp"

namespace quern {

/// What a scalar says once `${...}` is resolved: always a text, and a number where it is one.
struct Scalar {
    std::string text;
    std::optional<Quantity> number;
};

/// Parameters may use each other in any order.
class Parameters {
  public:
    Parameters() = default;
    /// `params`: cursor on the section. Throws InputError for a name that cannot be used, a value that is no
    /// scalar, an unknown unit, or a circle.
    explicit Parameters(const Cursor& params);

    /// `${formula}` alone, or followed by a unit, is a number; among other text it is replaced by its value.
    /// Throws InputError at `where`; about a number with an unknown unit only if numbers are `wanted`.
    enum class Wanted { number, text };
    Scalar resolve(const Node& node, const std::string& where, Wanted wanted) const;

    /// Replaces each `${...}` by its value in brackets, for a formula of x, y, z, t.
    std::string resolve_formula(const std::string& text, const std::string& where) const;

  private:
    Scalar value_of_formula(const std::string& formula, const std::string& where) const;
    const Scalar& value_of(const std::string& name, const std::string& where) const;

    struct Parameter {
        Node node;
        std::string where;
        enum class State { waiting, resolving, done } state = State::waiting;
        Scalar value;
    };
    mutable std::map<std::string, Parameter> parameters_;  // values are found when first asked for
    mutable std::vector<std::string> chain_;               // names being resolved
};

/// A number with or without unit; nothing if the text does not begin with one. Throws InputError at `where`
/// if an unknown unit follows the number.
std::optional<Quantity> parse_quantity(const std::string& text, const std::string& where);

}  // namespace quern
