// Cracks that a body has from the start.
#pragma once

#include <array>

#include "grid/vec.hpp"

namespace quern {

/// A flat cut: a segment in the plane, a parallelogram in space.
///
///     corner + sum_k t_k edge_k,   0 <= t_k <= 1,   k < Dim - 1                 [m]
///
/// A bond from a to b is cut where its ends lie on two sides of the plane of the crack and it meets the plane
/// within the crack. Points on the plane are on the side of its normal, which is edge_0 turned by 90 degrees
/// counter-clockwise or edge_0 x edge_1; both tests have a tolerance of 1e-9 of the bond and of the edges.
///
/// Source: S. Silling, J. Mech. Phys. Solids 48 (2000) 175, section 13 (bonds across a notch are removed).
template <int Dim>
struct Crack {
    Vec<Dim> corner;
    std::array<Vec<Dim>, Dim - 1> edge;

    /// Length or area [m | m^2]; 0: no crack.
    double size() const;
    bool cuts(const Vec<Dim>& a, const Vec<Dim>& b) const;
};

}  // namespace quern
