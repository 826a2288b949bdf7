// Pieces of a grain: what its intact bonds hold together.
#pragma once

#include <vector>

#include "particles/bonds.hpp"
#include "particles/grain_view.hpp"

namespace quern {

/// piece [n] = number of the connected component of intact bonds that a node belongs to, from 0 in the order
/// of their lowest nodes. Returns how many there are. One pass over the bonds of a grain (union by the lower
/// number, paths halved), the same for any number of threads.
template <int Dim>
int find_pieces(const Bonds<Dim>& bonds, const BondBits& alive, std::vector<int>& piece);

/// Whether two intact bonds, one at each, join the nodes i and j. If they do so for every bond that has
/// broken since find_pieces, the pieces are the same: each bond of an old path has such a detour.
template <int Dim>
bool joined_by_two(const Bonds<Dim>& bonds, const BondBits& alive, int i, int j);

}  // namespace quern
