// A reference shape: nodes, volumes and surface of a grain before it is scaled, turned and placed.
//
// Many grains share one shape. A grain of scale s has X = s X0, V = s^Dim V0, and the same bonds.
#pragma once

#include <string>
#include <vector>

#include "grid/vec.hpp"

namespace quern {

/// A node whose cell touches the surface of the shape.
template <int Dim>
struct SurfacePoint {
    int node = 0;                    ///< index into Shape::X
    Vec<Dim> nu = Vec<Dim>::Zero();  ///< outward unit normal of the true surface nearest to the node
    double delta = 0.0;              ///< distance of the node from the true surface, inward positive [m]
    double kappa = 0.0;  ///< curvature of the true surface there [1/m]; 3D: mean of both; 0 on flat faces
};

/// Nodes in the frame of the centre of mass. 2D: per metre of thickness.
template <int Dim>
struct Shape {
    std::string name;
    std::vector<Vec<Dim>> X;        ///< [n] reference positions [m]; sum V X = 0
    std::vector<double> volume;     ///< [n] nodal volumes [m^2 in 2D, m^3 in 3D], all > 0
    std::vector<IntVec<Dim>> cell;  ///< [n] cell of each node from the middle of the lattice, ascending
                                    ///< with axis 0 fastest; empty: no lattice
    double dx = 0.0;                ///< particle spacing: (mean nodal volume)^(1/Dim) [m]
    std::vector<SurfacePoint<Dim>> surface;  ///< ordered by node, at most one entry a node
    bool cornered = false;                   ///< has edges or corners: contact then filters by normal
    double radius = 0.0;                     ///< largest distance of the true surface from the centre [m]
    std::vector<Vec<Dim>> outline;           ///< points of the true surface, for drawing and overlap tests

    int n_nodes() const { return static_cast<int>(X.size()); }
};

}  // namespace quern
