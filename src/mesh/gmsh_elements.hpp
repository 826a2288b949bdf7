// From gmsh's current model to elements.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "src/mesh/element_mesh.hpp"

namespace quern {

/// What gmsh's current model holds in dimension Dim; the caller holds a GmshSession.
template <int Dim>
struct GmshElements {
    ElementMesh<Dim> mesh;
    std::string foreign;  ///< first element type other than those of ElementMesh; empty: none
    bool planar = true;   ///< 2D: all nodes at one z
    bool has_3d = false;  ///< elements of three dimensions present
    std::vector<std::size_t> missing_nodes;  ///< numbers that elements use and no node has
};

/// Nodes in the order of their numbers, coordinates times `unit`; nodes without element are dropped.
template <int Dim>
GmshElements<Dim> take_gmsh_elements(double unit);

}  // namespace quern
