// What a reference shape must satisfy: measures, connection and a closed surface layer.
#pragma once

#include <vector>

#include "particles/shape.hpp"

namespace quern {

/// Area [m^2] in 2D, volume [m^3] in 3D.
template <int Dim>
double total_volume(const Shape<Dim>& shape);

/// sum V X [m^(Dim+1)].
template <int Dim>
Vec<Dim> first_moment(const Shape<Dim>& shape);

/// Second moment sum V X X^T [m^(Dim+2)]. Its trace times the density is the polar moment of inertia in 2D;
/// in 3D the inertia tensor is density * (trace * 1 - second moment).
template <int Dim>
Mat<Dim> second_moment(const Shape<Dim>& shape);

/// True if nodes closer than `reach` [m] hold all nodes together.
template <int Dim>
bool is_connected(const Shape<Dim>& shape, double reach);

/// Largest distance [m] of any of the points from its nearest surface node: the size of the worst hole of
/// the surface layer when the points sample the true surface. Quadratic cost.
template <int Dim>
double largest_surface_gap(const Shape<Dim>& shape, const std::vector<Vec<Dim>>& points);

}  // namespace quern
