// Which grains are evaluated together, and where their alive bits are.
#pragma once

#include "src/sim/scene.hpp"

namespace quern {

/// Whether grains of one shape and material get batches of their own. Four are enough: a batch of four costs
/// no more than four grains one by one.
bool makes_batches(const ComputeDeck& deck, int n_grains);

/// Sets the tasks of the scene, its unions and the alive bits. Groups with `batched` go by eights; lattice
/// grains of the others that are alike in size share unions, while at least half of what a union evaluates is
/// real (again four of eight); what is left goes one by one.
template <int Dim>
void plan_forces(const Deck& deck, Scene<Dim>& scene);

}  // namespace quern
