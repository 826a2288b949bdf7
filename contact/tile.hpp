// Geometry of one contact: where two surfaces come closest inside one cell of the grid.
//
// Around a node each surface is a parabola over the tangent plane, fitted to the points of the true surface
// nearest to the surface particles in the node's support, x_p + delta_p nu_p, with weights N_ap
// (d: such a point, s: its tangential, y: its normal coordinate, both from the node, in units of h):
//
//     y_p = n.d_p/h + sigma b(|s_p - s_0|) - c2 |s_p|^2,   c2 = -sigma k/2,
//           k = kappa h,   sigma = +1 (A), -1 (B)
//     c1  = (cov(s,s) + 1e-3)^-1 cov(s,y),   c0 = mean(y) - c1.mean(s)
//     y_f(s) = c0 + c1.s + c2 |s|^2
//     b(u) = (1 - sqrt(1 - k^2 u^2))/k - k u^2/2      a circle's drop beyond the parabola of its apex s_0
//
// b enters in a second pass, when the first has told the apex. Without it and the points on the true surface
// a rolling disk feels bumps of some thousandths of h, which make a stiff one hop.
//
// The gap q(s) = y_B - y_A = q0 + q1.s + q2 |s|^2 is least at s* = clamp(-q1/(2 q2), -1/2, 1/2):
//
//     g = h q(s*),   x_c = x_a + h T s* + h (y_A(s*) + y_B(s*))/2 n
//
// and the normal is turned by the mean slope there, m = (c1_A + c1_B)/2 + (c2_A + c2_B) s*, |m| <= 1/2, once.
// delta_p: reference distance of the particle from the true surface [m]; nu_p: its reference normal, turned
// with the grain (for grains with corners the contact normal, and only particles whose nu_p is within 57
// degrees of it); kappa: reference curvature [1/m], in 3D the mean of the two (exact for spheres and planes).
// Two flat faces have no closest point; q2 = 0.2 then keeps s* near the middle of the cell. Nor do round ones
// have a sharp one where pressure has flattened them: the point runs to the side that turns in, and rocks a
// cell whose q2 is small until the step no longer resolves it; so q2 counts as 0.1 at least there. A wall is
// a plane that keeps its normal.
#pragma once

#include <optional>

#include "contact/contact_nodes.hpp"

namespace quern {

template <int Dim>
struct Tile {
    Vec<Dim> normal;  ///< unit, from A to B
    Vec<Dim> point;   ///< where the impulse acts, from the node [m]
    double gap;       ///< negative: overlap [m]
};

/// What one side of a tile is made of.
template <int Dim>
struct TileSide {
    const Slot<Dim>* slot;
    const Grain<Dim>* grain;
    const Mat<Dim>* rotation;  ///< of the grain, from the reference to now
};

/// Orthonormal tangents of a unit normal, as columns.
template <int Dim>
Eigen::Matrix<double, Dim, Dim - 1> tangents(const Vec<Dim>& n);

/// Tile of two grains; nothing if the surfaces are not both near the node.
template <int Dim>
std::optional<Tile<Dim>> make_tile(const TileSide<Dim>& A, const TileSide<Dim>& B, double h,
                                   const GridContactOptions& options);

/// Tile of a grain and a wall. `wall_offset` [m]: distance of the node from the wall, positive inside.
template <int Dim>
std::optional<Tile<Dim>> make_wall_tile(const TileSide<Dim>& A, const Wall<Dim>& wall, double wall_offset,
                                        double h, const GridContactOptions& options);

/// How far each of two bodies may move before their surfaces can meet near a node [h]:
///
///     max(g/(4 h), (|n.(x_c - x_a)|/h - 3/4)/2, (1/10 - filling)/2, 0), at most 1/10
///
/// 1/10: what a grain must fill of a cell to have a surface there. Both bodies may move, so g/(2 h) would do
/// if fits were exact. Those of grains with corners jump when another face joins: both distances count a
/// quarter of a cell less, half a cell where less than 0.35 is filled, and the path ends at 0.03. A surface
/// that is not there yet comes with its nearest particle.
template <int Dim>
double free_path(const TileSide<Dim>& A, const TileSide<Dim>& B, double h, const GridContactOptions& options);
template <int Dim>
double free_path(const TileSide<Dim>& A, const Wall<Dim>& wall, double wall_offset, double h,
                 const GridContactOptions& options);

}  // namespace quern
