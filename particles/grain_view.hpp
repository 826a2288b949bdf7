// One grain as an internal-force model sees it.
#pragma once

#include <cstdint>
#include <span>

#include "grid/vec.hpp"

namespace quern {

/// Current state of one grain, read only. The grain is `scale` times its shape; n nodes, n_bonds bonds.
template <int Dim>
struct GrainView {
    double scale = 1.0;
    std::span<const Vec<Dim>> x;          ///< [n] current positions [m]
    std::span<const Vec<Dim>> v;          ///< [n] velocities [m/s]; read by damping only, else may be empty
    std::span<const std::uint8_t> alive;  ///< [n_bonds] 0 = broken; empty = all intact
};

}  // namespace quern
