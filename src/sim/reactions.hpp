// What walls, constraints and held grains report: where they are, what they bear, what they have done.
#pragma once

#include <vector>

#include "src/results/records.hpp"
#include "src/sim/step.hpp"

namespace quern {

/// A row for each entry of StepContext::reactions, in its order; zeroes their impulses. To be called between
/// kick and drift. `elapsed`: time since the rows before [s].
///
///     F = (sum of impulses received) / elapsed         W(t_n) = sum_k W_k, k < n, + W_n / 2
///
///     F force [N; 2D: N/m], W_k work done in the kick k [J; 2D: J/m]: the works of all rows of walls and
///     constraints sum to what they add to `external_work`. The moment is that of F about the origin.
template <int Dim>
std::vector<ReactionRow> reaction_rows(const Deck& deck, const Scene<Dim>& scene, StepContext<Dim>& now,
                                       double elapsed);

}  // namespace quern
