// Cost of contact against the number of grains: every method on the same packings, in one run.
#pragma once

#include <string>
#include <vector>

#include "tests/benchmark/entry.hpp"

namespace quern::bench {

/// Contact of square packings of 10^2 to 10^4 disks (`all`: 10^5) with each method, one thread, at rest and
/// with grains that move at random; beside them what a k-d tree built and asked anew in every step takes for
/// the search alone. Entries of kind "method"; sizes: grains, moving, whole step [ns a particle], time step
/// [s]. The methods take turns, block by block, so that what disturbs the machine disturbs all of them.
/// `folder`: where the decks are.
std::vector<Entry> run_methods(const std::string& folder, bool all);

/// Slope of log(time of a step) over log(grains), by least squares over the entries of a method.
struct Slope {
    std::string method;
    bool moving = false;
    double value = 0.0;
};
std::vector<Slope> slopes(const std::vector<Entry>& entries);

}  // namespace quern::bench
