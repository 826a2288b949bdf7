// Round numbers for axes and colour bars.
#pragma once

#include <string>
#include <vector>

namespace quern {

struct Tick {
    double value = 0.0;
    std::string label;
};

/// Multiples of 1, 2 or 5 times a power of ten inside [low, high], at most `n_max`; high > low.
std::vector<Tick> make_ticks(double low, double high, int n_max);

/// Powers of ten inside 10^[low, high] and, over few decades, their 2 and 5 folds; values are logarithms.
std::vector<Tick> make_log_ticks(double low, double high, int n_max);

/// Largest of 1, 2 or 5 times a power of ten that is at most `length` > 0.
double round_down(double length);

/// A unit that makes numbers of size `magnitude` readable: {"mm", 1000} for 0.02 m, so that 0.02 m = 20 mm.
struct ScaledUnit {
    std::string name;
    double factor = 1.0;
};
ScaledUnit make_scaled_unit(const std::string& unit, double magnitude);

}  // namespace quern
