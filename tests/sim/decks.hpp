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

/// Lattice grains of unlike size that fall on each other and break: sixteen that fit into unions, a bar
/// that fits nowhere, and a group of four alike.
inline const std::string unequal_deck = R"yaml(title: unequal
materials:
  rubber: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa, bond_damping: 0.1 ms, critical_stretch: 0.03}
shapes:
  a: {type: disk, radius: 0.50, spacing: 0.1}
  b: {type: disk, radius: 0.46, spacing: 0.1}
  c: {type: disk, radius: 0.42, spacing: 0.1}
  d: {type: disk, radius: 0.44, spacing: 0.1}
  e: {type: regular_polygon, sides: 6, radius: 0.5, spacing: 0.1}
  f: {type: disk, radius: 0.48, spacing: 0.1}
  bar: {type: rectangle, size: [2, 0.3], spacing: 0.1}
  ring: {type: disk, filling: rings, radius: 0.4, spacing: 0.1}
grid: {origin: [0, 0], extent: [6, 6], spacing: 0.2}
gravity: [0, -9.8]
walls: [{side: y-, friction: 0.3}, {side: x-}, {side: x+}]
contact: {friction: 0.3}
time: {end: 0.1}
output: {interval: 0.05, history_interval: 0.01}
grains:
  - {shape: ring, material: rubber, array: {counts: [4, 1], origin: [0.6, 4.3], step: [1.1, 1]}, velocity: [0, -3]}
  - {shape: a, material: rubber, array: {counts: [1, 3], origin: [0.6, 0.52], step: [1, 1.02]}, velocity: [0, -3]}
  - {shape: b, material: rubber, array: {counts: [1, 3], origin: [1.7, 0.52], step: [1, 1.02]}, velocity: [0, -3]}
  - {shape: c, material: rubber, array: {counts: [1, 3], origin: [2.8, 0.52], step: [1, 1.02]}, velocity: [0, -3]}
  - {shape: d, material: rubber, array: {counts: [1, 3], origin: [3.9, 0.52], step: [1, 1.02]}, velocity: [0, -3],
     angle: 0.3}
  - {shape: e, material: rubber, position: [5, 3.6], velocity: [0, -3]}
  - {shape: f, material: rubber, array: {counts: [1, 3], origin: [5, 0.52], step: [1, 1.02]}, velocity: [0, -3]}
  - {shape: bar, material: rubber, position: [2.5, 3.4], velocity: [0, -3]}
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
