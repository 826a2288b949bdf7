// The shape of a piece of a broken grain, as contact sees it.
//
// A node i of the piece is at a crack face if a node of another piece has stood within 1.5 dx of it in the
// reference shape. There (j: nodes of other pieces within 2.5 dx, d_j = X_j - X_i, V_j their volumes)
//
//     nu    = sum_j V_j (1 - |d_j|/(2.5 dx)) d_j/|d_j|, made unit: where matter is missing
//     delta = half of the least nu.d_j of the nearest of them (|d_j| up to 1.1 of it), in [dx/4, dx/2]
//     kappa = 0
//
// nu no unit, delta, dx, X [m], V [m^3; 2D: m^2]. A node that was at the surface already keeps what it had,
// or, at the edge of the crack, gets the bisector of both normals and the smaller delta. Both faces of a
// crack along a row of a lattice so meet where they parted: dx/2 is the half distance there; along a diagonal
// rows stand nearer. Pieces have corners, and no outline that is known.
#pragma once

#include <span>
#include <vector>

#include "particles/shape.hpp"

namespace quern {

/// The nodes `nodes` [ascending] of `whole`, which make the piece `number`; piece [n]: that of every node of
/// `whole`. The shape has no surface if
/// nothing of it was near another piece or the surface.
template <int Dim>
Shape<Dim> make_piece_shape(const Shape<Dim>& whole, std::span<const int> piece, int number,
                            std::span<const int> nodes);

}  // namespace quern
