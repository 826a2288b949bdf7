// Sums over the particles around a contact node: the hottest loop of contact.
#pragma once

#include <cstdint>
#include <span>

#include "contact/contact.hpp"
#include "contact/slot.hpp"

namespace quern {

/// A particle of a grain: its number there, or -1 - its number on the surface.
using Candidate = std::int32_t;

/// Which weight particles have in a slot.
struct SlotWeights {
    bool nodal = false;            ///< w = N
    double interior_weight = 1.0;  ///< q, unless nodal: w = N^2 at the surface, q N^2 inside
    bool rotation = true;          ///< slots turn
};

/// Fills a slot, whose grain and index are set, from those of the candidates that are near. `support`: room
/// for all candidates; the first n_support stay.
template <int Dim>
void fill_slot(const ContactScene<Dim>& scene, const CartesianGrid<Dim>& grid, const SlotWeights& weights,
               std::span<const Candidate> candidates, Slot<Dim>& slot, Support<Dim>* support);

}  // namespace quern
