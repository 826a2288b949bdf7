#include "src/deck/units.hpp"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <numbers>
#include <utility>

namespace quern {
namespace {

struct NamedUnit {
    std::string_view name;
    Unit unit;
};

constexpr Dimension length{1, 0, 0, 0}, mass{0, 1, 0, 0}, duration{0, 0, 1, 0}, angle{0, 0, 0, 1};
constexpr Dimension force{1, 1, -2, 0}, pressure{-1, 1, -2, 0}, energy{2, 1, -2, 0}, power{2, 1, -3, 0};
constexpr double pi = std::numbers::pi;

constexpr NamedUnit units[] = {
    {"m", {1, 1, length}},
    {"km", {1e3, 1, length}},
    {"cm", {1, 1e2, length}},
    {"mm", {1, 1e3, length}},
    {"um", {1, 1e6, length}},
    {"nm", {1, 1e9, length}},
    {"s", {1, 1, duration}},
    {"ms", {1, 1e3, duration}},
    {"us", {1, 1e6, duration}},
    {"ns", {1, 1e9, duration}},
    {"min", {60, 1, duration}},
    {"h", {3600, 1, duration}},
    {"kg", {1, 1, mass}},
    {"g", {1, 1e3, mass}},
    {"mg", {1, 1e6, mass}},
    {"t", {1e3, 1, mass}},
    {"N", {1, 1, force}},
    {"mN", {1, 1e3, force}},
    {"kN", {1e3, 1, force}},
    {"MN", {1e6, 1, force}},
    {"Pa", {1, 1, pressure}},
    {"kPa", {1e3, 1, pressure}},
    {"MPa", {1e6, 1, pressure}},
    {"GPa", {1e9, 1, pressure}},
    {"J", {1, 1, energy}},
    {"kJ", {1e3, 1, energy}},
    {"W", {1, 1, power}},
    {"Hz", {1, 1, {0, 0, -1, 0}}},
    {"rad", {1, 1, angle}},
    {"deg", {pi, 180, angle}},
    {"rpm", {pi, 30, {0, 0, -1, 1}}},
    {"%", {1, 100, {}}},
};

Dimension sum(const Dimension& a, const Dimension& b, int times) {
    const auto add = [times](std::int8_t p, std::int8_t q) {
        return static_cast<std::int8_t>(p + times * q);
    };
    return {add(a.length, b.length), add(a.mass, b.mass), add(a.time, b.time), add(a.angle, b.angle)};
}

Unit multiply(Unit a, const Unit& b) {
    return {a.numerator * b.numerator, a.denominator * b.denominator, sum(a.dimension, b.dimension, 1)};
}

Unit divide(Unit a, const Unit& b) {
    return {a.numerator * b.denominator, a.denominator * b.numerator, sum(a.dimension, b.dimension, -1)};
}

/// unit := factor (('*' | '/') factor)*;  factor := (name | '1' | '(' unit ')') ['^' integer]
class UnitParser {
  public:
    explicit UnitParser(std::string_view text) : rest_(text) {}

    std::optional<Unit> parse() {
        const std::optional<Unit> unit = product();
        skip_spaces();
        return rest_.empty() ? unit : std::nullopt;
    }

  private:
    void skip_spaces() { rest_ = trim(rest_); }

    bool take(char c) {
        skip_spaces();
        if (rest_.empty() || rest_.front() != c) return false;
        rest_.remove_prefix(1);
        return true;
    }

    std::optional<Unit> product() {
        std::optional<Unit> left = factor();
        while (left) {
            const bool times = take('*');
            if (!times && !take('/')) return left;
            const std::optional<Unit> right = factor();
            if (!right) return std::nullopt;
            left = times ? multiply(*left, *right) : divide(*left, *right);
        }
        return left;
    }

    std::optional<Unit> factor() {
        const std::optional<Unit> base = atom();
        if (!base || !take('^')) return base;
        skip_spaces();
        int exponent = 0;
        const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), exponent);
        if (error != std::errc() || std::abs(exponent) > 9) return std::nullopt;
        rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
        Unit power;
        for (int i = 0; i < std::abs(exponent); ++i) {
            power = exponent > 0 ? multiply(power, *base) : divide(power, *base);
        }
        return power;
    }

    std::optional<Unit> atom() {
        if (take('(')) {
            const std::optional<Unit> inner = product();
            return take(')') ? inner : std::nullopt;
        }
        if (take('1')) return Unit{};
        const std::size_t n = std::min(rest_.size(), rest_.find_first_of(" \t*/^()"));
        const std::string_view name = rest_.substr(0, n);
        for (const NamedUnit& known : units) {
            if (known.name != name) continue;
            rest_.remove_prefix(n);
            return known.unit;
        }
        return std::nullopt;
    }

    std::string_view rest_;
};

}  // namespace

std::string_view trim(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r\n") - first + 1);
}

std::vector<std::string_view> split_cells(std::string_view line) {
    std::vector<std::string_view> cells;
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.size(), line.find(',', begin));
        cells.push_back(trim(line.substr(begin, end - begin)));
        begin = end + 1;
    }
    return cells;
}

std::optional<Unit> parse_unit(std::string_view text) {
    return UnitParser(text).parse();
}

std::vector<std::string> unit_names() {
    std::vector<std::string> names;
    for (const NamedUnit& unit : units) names.emplace_back(unit.name);
    return names;
}

std::optional<NumberAndRest> split_number(std::string_view text) {
    text = trim(text);
    if (text.starts_with('+')) text.remove_prefix(1);
    if (text.find_first_of("0123456789") > 2) return std::nullopt;  // from_chars would take "inf" and "nan"
    NumberAndRest split;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), split.number);
    if (error != std::errc()) return std::nullopt;
    split.rest = trim(text.substr(static_cast<std::size_t>(end - text.data())));
    return split;
}

std::string text_of(const Dimension& dimension) {
    for (const NamedUnit& known : units) {
        const bool si = known.unit.numerator == 1 && known.unit.denominator == 1;
        if (si && known.unit.dimension == dimension) return std::string(known.name);
    }
    const std::pair<const char*, int> bases[] = {
        {"kg", dimension.mass}, {"m", dimension.length}, {"rad", dimension.angle}, {"s", dimension.time}};
    std::string above, below;
    int n_below = 0;
    for (const auto& [name, exponent] : bases) {
        if (exponent == 0) continue;
        std::string& side = exponent > 0 ? above : below;
        n_below += exponent < 0;
        if (!side.empty()) side += '*';
        side += name;
        if (std::abs(exponent) != 1) side += fmt::format("^{}", std::abs(exponent));
    }
    if (above.empty()) above += '1';
    if (below.empty()) return above;
    return n_below > 1 ? fmt::format("{}/({})", above, below) : fmt::format("{}/{}", above, below);
}

}  // namespace quern
