// Meshes of known solids by gmsh, in process.
#pragma once

#include "particles/ellipse.hpp"
#include "particles/solids.hpp"
#include "src/mesh/element_mesh.hpp"

namespace quern {

/// Triangles (2D) or tetrahedra (3D) of edge length about `spacing` [m]; the vertices of a polygon are always
/// nodes. gmsh works on the solid divided by its size, since its tolerances are absolute. Equal calls give
/// equal bits. Throws std::runtime_error if gmsh fails.
ElementMesh<2> generate_mesh(const Ball<2>& disk, double spacing);
ElementMesh<2> generate_mesh(const Ellipse& ellipse, double spacing);
ElementMesh<2> generate_mesh(const Polygon& polygon, double spacing);
ElementMesh<3> generate_mesh(const Ball<3>& ball, double spacing);
ElementMesh<3> generate_mesh(const Cuboid& box, double spacing);

}  // namespace quern
