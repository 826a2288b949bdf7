// Forces inside the grains, task by task: batches of eight, unions, single grains (force_plan.hpp).
#pragma once

#include "src/sim/step.hpp"

namespace quern {

/// Bonds break, then pull: sets `arrays.internal` and, where a group is damped, `arrays.damping` at the
/// present positions; counts what broke, and its energy in the ledger. What yields flows: `plastic` becomes
/// that of these positions, and the ledger has its work.
template <int Dim>
void compute_internal_forces(Scene<Dim>& scene, StepContext<Dim>& now);

}  // namespace quern
