// Linear elements of the top dimension: checks, nodal volumes by lumping, boundary.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "grid/vec.hpp"
#include "particles/shape.hpp"

namespace quern {

/// Triangles and quadrangles (Dim 2) or tetrahedra and hexahedra (Dim 3); nodes in the order of gmsh.
template <int Dim>
struct ElementMesh {
    struct Element {
        std::size_t tag = 0;  ///< its number in the file
        int n_nodes = 0;      ///< 3 or 4 in 2D, 4 or 8 in 3D
        std::array<int, 8> node{};
    };
    std::vector<Vec<Dim>> X;  ///< [n]; every node belongs to an element
    std::vector<Element> elements;
};

/// A face of the boundary, 2 to 4 nodes: 2D matter on its left, 3D counter-clockwise seen from outside.
struct Facet {
    int element = 0;  ///< index into ElementMesh::elements
    int n_nodes = 0;
    std::array<int, 4> node{};
};

struct MeshDefect {
    std::string got, expected, hint;
};

/// The first defect of the mesh: a flipped or degenerate element (Jacobian not positive at a corner),
/// elements that overlap, pieces that share no facet, in 2D a boundary that touches itself at a node.
template <int Dim>
std::optional<MeshDefect> find_mesh_defect(const ElementMesh<Dim>& mesh);

/// Nodal volumes by lumping: V_i = sum over elements of the integral of the shape function N_i
/// (Hughes, The Finite Element Method, 1987, section 7.3.2), by 2^Dim Gauss points, which is exact for linear
/// and multilinear elements. Sums to the volume of the mesh.
template <int Dim>
std::vector<double> make_lumped_volumes(const ElementMesh<Dim>& mesh);

/// Facets that belong to one element only, in the order of the elements.
template <int Dim>
std::vector<Facet> find_boundary(const ElementMesh<Dim>& mesh);

/// The true surface at the boundary nodes of a mesh.
template <int Dim>
struct MeshSurface {
    std::vector<SurfacePoint<Dim>> points;  ///< ordered by node
    std::vector<Vec<Dim>> outline;          ///< 2D: the outer loop, in order; 3D: the boundary nodes
    bool cornered = false;
};

/// The surface of a mesh of unknown origin, from its boundary polyline or triangulation; delta = 0.
///
/// 2D: make_vertex_frames() of every closed loop. 3D: quadrangles are cut along the shorter diagonal, then
///
///     smooth   : nu = sum_f (a x b)/(|a|^2 |b|^2) / |.|    a, b: edges of triangle f at the node [m]
///     a corner : nu = sum_f alpha_f n_f / |.|              alpha_f: angle of triangle f at the node [rad]
///     kappa = sum_e phi_e k_e / sum_e phi_e                phi_e: half the angles beside edge e at the node
///     k_e   = 2 nu.(x - x_e)/|x - x_e|^2                   normal curvature along edge e [1/m]
///
/// Smooth normals: Max, Weights for computing vertex normals from facet normals, J. Graphics Tools 4 (1999),
/// exact on a sphere. At corners the angles count (Thuermer and Wuethrich, same journal 3, 1998), so that an
/// edge of a box has its bisector however its faces are cut. The mean of the normal curvature over all
/// directions is the mean curvature (Euler); on a sphere every k_e is 1/R. On other smooth surfaces the
/// normals converge (second order) while kappa keeps a scatter of about 8 % rms, measured on an ellipsoid of
/// axes 2 : 1.5 : 1. Nodes of an edge whose triangles meet at 30 degrees or more are corners: kappa = 0.
template <int Dim>
MeshSurface<Dim> fit_surface(const ElementMesh<Dim>& mesh);

}  // namespace quern
