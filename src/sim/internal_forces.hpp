// Forces inside the grains, group by group: in batches of eight where a group is large enough.
#pragma once

#include "src/sim/step.hpp"

namespace quern {

/// Bonds break, then pull: sets `arrays.internal` and, where a group is damped, `arrays.damping` at the
/// present positions; counts what broke, and its energy in the ledger.
template <int Dim>
void compute_internal_forces(Scene<Dim>& scene, StepContext<Dim>& now);

}  // namespace quern
