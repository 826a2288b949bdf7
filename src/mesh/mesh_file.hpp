// Reads gmsh's .msh files, versions 2.2 and 4.1, ASCII and binary.
#pragma once

#include <string>

#include "src/mesh/element_mesh.hpp"

namespace quern {

/// Elements of dimension Dim of a file and the nodes they use, in the order of their numbers, coordinates
/// times `unit` [m]. Elements of lower dimension are passed over; 2D: the mesh must lie in a plane z = const.
///
/// Throws InputError at `where`: no such file, not a .msh file or another version, unreadable contents, no
/// elements of dimension Dim, elements of higher order or of another kind (prisms, pyramids), elements of
/// three dimensions in a 2D deck.
template <int Dim>
ElementMesh<Dim> read_mesh_file(const std::string& path, double unit, const std::string& where);

}  // namespace quern
