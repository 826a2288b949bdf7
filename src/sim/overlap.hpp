// Grains that overlap at the start would be thrown apart.
#pragma once

#include "src/sim/scene.hpp"

namespace quern {

/// Throws InputError at the second of two grains that overlap; grains with `wall: true` may overlap each
/// other.
///
/// Particles within the grains must not be nearer than 0.3 of the spacing dx. Particles on the surface, as
/// those of meshes, may meet when grains touch: then none may be behind the surface of another by 0.5 to 1
/// dx, and two at one place must not face the same way.
template <int Dim>
void check_overlap(const Deck& deck, const Scene<Dim>& scene);

}  // namespace quern
