// What `observe` asks for: tables of contacts, grains, regions, profiles and forces, made with every frame.
// Definitions: docs/observers.md and the headers of src/observe.
#pragma once

#include <vector>

#include "src/results/records.hpp"
#include "src/sim/step.hpp"

namespace quern {

/// The tables of a run, in their order: contacts, grain_stress, regions, profiles, forces.
std::vector<TableLayout> observed_layouts(const Deck& deck);

/// Rows of each table, between a kick that has listed its contacts and the drift; `frame`: made of the same
/// state. Grains by their numbers in the deck.
template <int Dim>
std::vector<TableRows> observe(const Deck& deck, const Scene<Dim>& scene, const StepContext<Dim>& now,
                               const Frame& frame);

}  // namespace quern
