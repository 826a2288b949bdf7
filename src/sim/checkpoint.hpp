// What a step hands to the next one: saved and loaded by the same calls.
#pragma once

#include "src/results/checkpoint_file.hpp"
#include "src/results/records.hpp"
#include "src/sim/step.hpp"

namespace quern {

/// State between two steps, after drift and before kick: positions of time n, velocities of n-1/2, bonds,
/// walls, works. What a kick computes anew is not part of it; neither are shapes, bonds and materials, which
/// the deck gives. Loading throws InputError if the checkpoint is not of a scene of this size.
///
/// Contact nodes are searched anew after loading: the velocities do not depend on when they were searched.
template <int Dim>
void pass_state(Checkpoint& checkpoint, Scene<Dim>& scene, StepContext<Dim>& now);

/// Of the reference positions and volumes of all shapes: tells whether a mesh is still the same.
template <int Dim>
std::int64_t shapes_hash(const Scene<Dim>& scene);

/// Where a run came from.
struct RunOrigin {
    std::string folder;     ///< of the deck: files of meshes are relative to it
    std::string deck_hash;  ///< of the resolved deck
};
void pass_origin(Checkpoint& checkpoint, RunOrigin& origin);

void pass_position(Checkpoint& checkpoint, ResultPosition& position);

}  // namespace quern
