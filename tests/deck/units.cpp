#include "src/deck/units.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "src/deck/parameters.hpp"

using namespace quern;

TEST_CASE("Units: quantities become SI numbers without rounding noise") {
    const double pi = std::numbers::pi;
    const std::pair<std::string, double> exact[] = {
        {"7.5 GPa", 7.5e9},    {"100 um", 1e-4},        {"31 um", 31e-6},   {"60 deg", 60 * pi / 180},
        {"0.1 mm/us", 100.0},  {"2.44 g/cm^3", 2440.0}, {"9.8 m/s^2", 9.8}, {"30 rpm", pi},
        {"90 deg/s", pi / 2},  {"3 min", 180.0},        {"2 h", 7200.0},    {"5 %", 0.05},
        {"-3 mm", -0.003},     {"+3mm", 0.003},         {".5 m", 0.5},      {"1e3 ms", 1.0},
        {"4 kg/(m*s^2)", 4.0}, {"4 N*m", 4.0},          {"4 s^-1", 4.0},    {"4 1/s", 4.0},
        {"2 kJ", 2000.0},      {"2 t", 2000.0},         {"7 nm", 7e-9},     {"7 ns", 7e-9},
        {"1 km^2", 1e6},       {"3 MN / m^2", 3e6},     {"12", 12.0},       {"2 mg", 2e-6},
        {"1 W", 1.0},          {"3 cm", 0.03},          {"4 mN", 0.004},    {"1 kPa", 1000.0}};
    for (const std::pair<std::string, double>& pair : exact) {
        const std::string& text = pair.first;
        const double value = pair.second;
        CAPTURE(text);
        const std::optional<Quantity> quantity = parse_quantity(text, "here");
        REQUIRE(quantity);
        CHECK(std::abs(quantity->value - value) <= 2e-16 * std::abs(value));  // measured 1.2e-16, bound 2e-16
    }
    CHECK(parse_quantity("100 um", "here")->value == 1e-4);
    CHECK(parse_quantity("0.1 mm/us", "here")->value == 100.0);
}

TEST_CASE("Units: dimensions are told apart") {
    const auto dimension = [](const char* unit) { return parse_unit(unit)->dimension; };
    CHECK(dimension("Pa") == dimension("N/m^2"));
    CHECK(dimension("J") == dimension("N*m"));
    CHECK(dimension("W") == dimension("J/s"));
    CHECK(dimension("rpm") == dimension("rad/s"));
    CHECK(dimension("rad/s") != dimension("Hz"));
    CHECK(dimension("deg") != dimension("1"));
    CHECK(text_of(dimension("MPa")) == "Pa");
    CHECK(text_of(dimension("kg/m^2/s")) == "kg/(m^2*s)");
    CHECK(text_of(dimension("%")) == "1");
    for (const std::string& name : unit_names()) CHECK(parse_unit(name));
}

TEST_CASE("Units: what is no unit is none") {
    for (const char* text :
         {"", "x", "mmm", "m m", "m^", "m^x", "m^99", "/s", "m/", "(m", "m)", "*", "2", "^2", "m**s"}) {
        CAPTURE(text);
        CHECK_FALSE(parse_unit(text));
    }
    for (const char* text : {"", "inf", "nan", "-inf", "a1", "-", "e5", "1e999"}) {
        CAPTURE(text);
        CHECK_FALSE(split_number(text));
    }
}
