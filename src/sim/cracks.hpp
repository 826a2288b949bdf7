// Cracks that grains have from the start, and zones in which bonds never break.
//
// Both are bits beside those of the intact bonds (Scene::alive), so that every way of evaluating forces sees
// them, and a checkpoint needs nothing more: the deck gives them again. A crack is cut before `prepare`, in
// grains without strain. What it cuts
//
//     sets no energy free and is not counted as fracture
//     is no damage: `damage` counts what breaks afterwards, over the bonds that cracks have left
//     is no part of damage_z
//     repels itself from the other side; a grain cut in two is two fragments (fragments.hpp)
//
// On periodic axes cracks and regions are compared with places as the deck gives them; they do not repeat.
#pragma once

#include "src/sim/scene.hpp"

namespace quern {

/// Gives bits to the bonds of materials that never break but are cut. Before forces are planned.
template <int Dim>
void mark_cracked(const Deck& deck, Scene<Dim>& scene);

/// Throws InputError for a crack that crosses no bond.
template <int Dim>
void set_cracks(const Deck& deck, Scene<Dim>& scene);

/// Throws InputError for a region without particles.
template <int Dim>
void set_no_fail(const Deck& deck, Scene<Dim>& scene);

}  // namespace quern
