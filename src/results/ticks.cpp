#include "src/results/ticks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace quern {

namespace {

/// Decimals that tell multiples of `step` apart.
int n_decimals(double step) {
    return std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
}

std::string make_label(double value, double step, double largest) {
    if (std::abs(value) < 1e-9 * step) return "0";
    if (largest < 1e5 && step > 1e-5) return fmt::format("{:.{}f}", value, n_decimals(step));
    const double exponent = std::floor(std::log10(largest) + 1e-9), power = std::pow(10.0, exponent);
    return fmt::format("{:.{}f}e{}", value / power, n_decimals(step / power), static_cast<int>(exponent));
}

}  // namespace

double round_down(double length) {
    const double power = std::pow(10.0, std::floor(std::log10(length)));
    for (const double digit : {5.0, 2.0})
        if (digit * power <= length * (1.0 + 1e-12)) return digit * power;
    return power;
}

std::vector<Tick> make_ticks(double low, double high, int n_max) {
    const double slack = 1e-9 * (high - low);
    const auto first_of = [&](double step) { return std::ceil((low - slack) / step); };
    const auto last_of = [&](double step) { return std::floor((high + slack) / step); };
    double power = std::pow(10.0, std::floor(std::log10((high - low) / n_max)));
    double step = power;
    for (const double digit : {1.0, 2.0, 5.0, 10.0, 20.0}) {
        step = digit * power;
        if (last_of(step) - first_of(step) + 1 <= n_max) break;
    }
    std::vector<Tick> ticks;
    const double largest = std::max(std::abs(low), std::abs(high));
    for (double k = first_of(step); k <= last_of(step); ++k)
        ticks.push_back({k * step, make_label(k * step, step, largest)});
    return ticks;
}

std::vector<Tick> make_log_ticks(double low, double high, int n_max) {
    std::vector<Tick> ticks;
    const int first = static_cast<int>(std::floor(low)), last = static_cast<int>(std::ceil(high));
    const int stride = std::max(1, (last - first + n_max - 1) / n_max);
    const bool few = high - low < 2.0;
    for (int k = first; k <= last; k += stride)
        for (const int digit : {1, 2, 5}) {
            const double value = k + std::log10(digit);
            if ((digit > 1 && !few) || value < low - 1e-9 || value > high + 1e-9) continue;
            const bool plain = k >= -3 && k <= 4;
            ticks.push_back({value, plain ? fmt::format("{:.{}f}", digit * std::pow(10.0, k), std::max(0, -k))
                                          : fmt::format("{}e{}", digit, k)});
        }
    return ticks;
}

ScaledUnit make_scaled_unit(const std::string& unit, double magnitude) {
    if (unit.empty() || magnitude <= 0.0 || !std::isfinite(magnitude)) return {unit, 1.0};
    constexpr const char* prefixes[] = {"n", "\u00b5", "m", "", "k", "M", "G", "T"};
    // 0.3 m and 2000 m read better than 300 mm and 2 km: the plain unit reaches a bit further.
    const int thousands = magnitude >= 0.1 && magnitude < 1e4
                              ? 0
                              : std::clamp(static_cast<int>(std::floor(std::log10(magnitude) / 3.0)), -3, 4);
    return {prefixes[thousands + 3] + unit, std::pow(10.0, -3 * thousands)};
}

}  // namespace quern
