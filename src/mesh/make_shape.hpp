// From a deck's shape to a reference shape, by lattice, rings, gmsh in process or a .msh file.
#pragma once

#include "particles/shape.hpp"
#include "src/deck/deck.hpp"

namespace quern {

/// Builds the reference shape of a deck entry. Throws InputError at shape.place (flipped or degenerate
/// element, missing file, wrong format, too few nodes, self-intersecting polygon...).
template <int Dim>
Shape<Dim> make_shape(const ShapeDeck& shape);

}  // namespace quern
