#include "src/deck/expression.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "grid/error.hpp"

using namespace quern;

TEST_CASE("Expression: functions and operators mean what they say") {
    const double x = 0.7, y = -1.3, z = 2.1, t = 0.4;
    const std::pair<std::string, double> formulas[] = {
        {"sin(x) + cos(y)", std::sin(x) + std::cos(y)},
        {"exp(-t)*pow(z, 3)", std::exp(-t) * z * z * z},
        {"min(x, y, z) - max(x, t)", y - x},
        {"abs(y) + sqrt(z)", -y + std::sqrt(z)},
        {"if(x > 0, y, z)", y},
        {"if(x < 0, y, z)", z},
        {"x > 0 && y > 0 ? 1 : 2", 2.0},
        {"2*pi*x^2", 2 * 3.14159265358979323846 * x * x},
        {"(x == x) + (x != x) + (x <= t) + (x >= t)", 2.0},
    };
    for (const std::pair<std::string, double>& pair : formulas) {
        const std::string& text = pair.first;
        const double value = pair.second;
        CAPTURE(text);
        const Expression formula(text, "here");
        CHECK_FALSE(formula.is_constant());
        CHECK(formula.text() == text);
        CHECK(std::abs(formula(x, y, z, t) - value) <=
              1e-15 * std::abs(value));  // measured 2e-16, bound 1e-15
    }
}

TEST_CASE("Expression: a formula without variables is a constant") {
    const Expression folded("2*pi/2 - pi + 3", "here");
    CHECK(folded.is_constant());
    CHECK(folded(1, 2, 3, 4) == 3.0);
    CHECK(folded.text() == "3");
    CHECK(Expression()(5.0) == 0.0);
    CHECK(Expression(2.5)(5.0) == 2.5);
}

TEST_CASE("Expression: copies may be evaluated at different places") {
    const Expression first("x + 10*t", "here");
    const Expression second = first;
    CHECK(first(1, 0, 0, 2) == 21.0);
    CHECK(second(3, 0, 0, 4) == 43.0);
    CHECK(first(1, 0, 0, 2) == 21.0);
    CHECK(first.uses("x"));
    CHECK(first.uses("t"));
    CHECK_FALSE(first.uses("y"));
}

TEST_CASE("Expression: what is no formula is refused") {
    for (const char* text :
         {"", "x +", "sin x", "foo(x)", "x = 2", "1, 2", "\"text\"", "0/0", "w", "x y", "2x", "(x"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(Expression(text, "here"), InputError);
    }
}
