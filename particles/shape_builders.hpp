// Reference shapes from pure geometry: square and cubic lattices, concentric rings and shells.
//
// Nodes come out in the frame of their centre of mass; the volumes sum to the measure of the true solid.
#pragma once

#include "particles/ellipse.hpp"
#include "particles/shape.hpp"
#include "particles/solids.hpp"

namespace quern {

/// Nodes on a lattice of cell edges `spacing` [m], centred in the bounding box of the solid: half a spacing
/// from its faces where the box is a whole number of cells.
///
/// A cell centred inside the solid is a node with the exact volume of (cell and solid); the part of the solid
/// in any other cell goes in equal parts to the nodes next to it (across faces, else around, else the
/// nearest), so that a node beside the surface stands for the matter between it and the surface: 0.5 to 1.5
/// cells. Surface points are the nodes with a face neighbour outside. On a flat stretch of the surface that
/// is exactly one node of every lattice row that crosses it steepest: a closed layer, one node thick, and the
/// surface enters no other node's cell. delta is between 0 and one spacing.
///
/// Solid: Ball<Dim>, Ellipse or Polygon (2D) or Cuboid (3D). No nodes come out if no cell centre lies inside.
template <int Dim, class Solid>
Shape<Dim> make_lattice_shape(const Solid& solid, const Vec<Dim>& spacing);

/// A disk of n concentric rings, ring k = 1..n at radius (k - 1/2) R/n with round(2 pi (k - 1/2)) nodes that
/// share its annulus. Surface: the outer ring, delta = R/(2n). The polar moment of inertia is exactly
///
///     I = M R^2/2 (1 - 1/(2 n^2))
///
/// Successive rings are turned by the golden angle, so that no radial rows form. Needs n >= 1.
Shape<2> make_rings_shape(double radius, int n);

/// A ball of n concentric shells, shell k = 1..n at radius (k - 1/2) R/n with round(4 pi/3 (3 k^2 - 3 k + 1))
/// nodes that share its volume. Surface: the outer shell, delta = R/(2n).
///
/// Each shell is a Fibonacci lattice (Swinbank and Purser 2006, doi 10.1256/qj.05.227), turned at random but
/// always alike, then whitened: mean zero and isotropic second moment to round-off, a spherical 2-design.
/// The inertia is therefore isotropic and exactly
///
///     I = 2/5 M R^2 (1 - 25/(36 n^2) + 1/(9 n^4))
Shape<3> make_shells_shape(double radius, int n);

/// Shifts nodes and outline so that the centre of mass is the origin, to round-off, and sets dx.
template <int Dim>
void move_to_centre_of_mass(Shape<Dim>& shape);

}  // namespace quern
