// Whole problems: decks, stepped as a run steps them, without output.
#pragma once

#include "tests/benchmark/entry.hpp"

namespace quern::bench {

struct Problem {
    std::string name;
    std::string deck;
    std::vector<std::string> overrides;
    bool stirred = false;  ///< grains are thrown at each other first
};

/// `folder`: where the decks are. `all`: also those that take minutes or gigabytes.
std::vector<Problem> make_problems(const std::string& folder, bool all);

/// The whole step, then its stages: force (of a bond), kick, contact, drift (of a particle). Every repetition
/// is a block of steps.
std::vector<Entry> run_problem(const Problem& problem, int threads);

}  // namespace quern::bench
