// Place of a cell on Morton's curve: cells that are near in space are near on the curve.
//
// Morton 1966, A computer oriented geodetic data base: the bits of the indices, one of each axis in turn.
#pragma once

#include <algorithm>
#include <cstdint>

#include "grid/vec.hpp"

namespace quern {

/// Indices below 0 or from 2^20 on count as the nearest one within.
template <int Dim>
std::uint64_t z_order(const IntVec<Dim>& cell) {
    constexpr int bits = 20;
    std::uint64_t place = 0;
    for (int bit = 0; bit < bits; ++bit)
        for (int a = 0; a < Dim; ++a) {
            const int i = std::clamp(cell[a], 0, (1 << bits) - 1);
            place |= static_cast<std::uint64_t>(i >> bit & 1) << (bit * Dim + a);
        }
    return place;
}

}  // namespace quern
