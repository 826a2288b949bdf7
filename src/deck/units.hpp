// Units of the deck: "7.5 GPa", "0.1 mm/us", "9.8 m/s^2" to SI numbers with their dimension.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace quern {

/// Exponents of the base units. Angle counts as one of them, so that an angle is not taken for a bare number.
struct Dimension {
    std::int8_t length = 0, mass = 0, time = 0, angle = 0;
    bool operator==(const Dimension&) const = default;
};

/// SI value = number * numerator / denominator. Two factors, so that "100 um" is exactly 1e-4.
struct Unit {
    double numerator = 1.0, denominator = 1.0;
    Dimension dimension;
};

/// An SI number, with its dimension where a unit was written.
struct Quantity {
    double value = 0.0;
    std::optional<Dimension> dimension;
};

/// Products, quotients and integer powers of known units: "kg/m^3", "kg/(m*s^2)", "1/s". Nothing if unknown.
std::optional<Unit> parse_unit(std::string_view text);

/// All names that parse_unit knows.
std::vector<std::string> unit_names();

/// A number and what follows it, both trimmed.
struct NumberAndRest {
    double number = 0.0;
    std::string_view rest;
};

/// Nothing if `text` does not begin with a finite number.
std::optional<NumberAndRest> split_number(std::string_view text);

std::string_view trim(std::string_view text);
/// The cells of a line of CSV, trimmed.
std::vector<std::string_view> split_cells(std::string_view line);

/// The SI unit of a dimension: "Pa", or in base units "kg/(m^2*s)"; "1" for pure numbers.
std::string text_of(const Dimension& dimension);

}  // namespace quern
