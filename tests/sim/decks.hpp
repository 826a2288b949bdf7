// Runs of small decks for the tests of whole simulations.
#pragma once

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "src/sim/run.hpp"
#include "tests/deck/deck_files.hpp"

namespace quern::test {

/// Rubber, a disk of R = 0.5 m with six particles a radius, a box of 6 m by 4 m. Cases add sections to it.
inline const std::string plane_deck = R"yaml(title: test
dimension: 2
params: {n: 6}
materials:
  rubber: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa}
shapes:
  disk: {type: disk, filling: rings, radius: 0.5, spacing: "${0.5/n}"}
grid: {origin: [0, 0], extent: [6, 4], spacing: "${1/n}"}
)yaml";

/// The same in space: a ball of R = 0.5 m with three particles a radius.
inline const std::string space_deck = R"yaml(title: test
dimension: 3
params: {n: 3}
materials:
  rubber: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa}
shapes:
  ball: {type: sphere, filling: rings, radius: 0.5, spacing: "${0.5/n}"}
grid: {origin: [0, 0, 0], extent: [4, 4, 4], spacing: "${1/n}"}
)yaml";

/// Runs a deck in a folder that vanishes.
inline RunRecord run_text(const std::string& text, const std::vector<std::string>& overrides = {},
                          int threads = 1) {
    const TempFolder folder;
    const std::string file = folder.write("deck.yaml", text);
    RunOptions options;
    options.directory = file + ".out";
    options.threads = threads;
    RunRecord record;
    const RunOutcome outcome = run_deck(read_deck(file, overrides), options, &record);
    CHECK(outcome == RunOutcome::done);
    return record;
}

/// The message of the Error that running a deck ends with; a failed check if it does not.
template <class Error>
std::string message_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
        run_text(text, overrides);
    } catch (const Error& error) {
        return error.what();
    }
    FAIL_CHECK("no error");
    return {};
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace quern::test
