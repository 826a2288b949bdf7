#include "src/mesh/mesh_file.hpp"

#include <fmt/format.h>
#include <gmsh.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "grid/error.hpp"
#include "src/mesh/gmsh_elements.hpp"
#include "src/mesh/gmsh_session.hpp"

namespace quern {
namespace {

/// gmsh chooses a reader by the name of the file and would run a .geo script: only a true .msh gets through.
void check_header(const std::string& path, const std::string& where) {
    std::ifstream file(path, std::ios::binary);
    if (!file || std::filesystem::is_directory(path))
        throw InputError(where, fmt::format("no readable file '{}'", path), "the path of a .msh file",
                         "relative paths start at the folder of the deck");
    constexpr const char* expected = "a gmsh mesh of version 2.2 or 4.1";
    std::string first, second;
    std::getline(file, first);
    std::getline(file, second);
    if (!first.starts_with("$MeshFormat") || std::filesystem::path(path).extension() != ".msh")
        throw InputError(where, fmt::format("'{}', which is not a .msh file", path), expected,
                         "a .msh file starts with $MeshFormat; write one with gmsh -2 or -3");
    std::istringstream words(second);
    std::string version;
    words >> version;
    if (version != "2.2" && version != "4.1")
        throw InputError(where, fmt::format("'{}' of mesh version '{}'", path, version), expected,
                         "gmsh -format msh41 converts it");
}

}  // namespace

template <int Dim>
ElementMesh<Dim> read_mesh_file(const std::string& path, double unit, const std::string& where) {
    check_header(path, where);
    GmshElements<Dim> elements;
    try {
        GmshSession session;
        gmsh::merge(path);
        elements = take_gmsh_elements<Dim>(unit);
    } catch (...) {
        throw InputError(where, fmt::format("'{}', unreadable ({})", path, current_gmsh_error()),
                         "a complete gmsh mesh");
    }
    if (Dim == 2 && elements.has_3d)
        throw InputError(where, fmt::format("three-dimensional elements in '{}'", path),
                         "a mesh of a plane surface", "the deck is in 2D");
    constexpr const char* wanted =
        Dim == 2 ? "3-node triangles or 4-node quadrangles" : "4-node tetrahedra or 8-node hexahedra";
    if (!elements.foreign.empty())
        throw InputError(where, fmt::format("elements of type '{}' in '{}'", elements.foreign, path), wanted,
                         "mesh with first-order elements");
    if (!elements.missing_nodes.empty())
        throw InputError(where,
                         fmt::format("elements with node {} in '{}'", elements.missing_nodes.front(), path),
                         "elements of nodes that the file defines");
    if (elements.mesh.elements.empty())
        throw InputError(where, fmt::format("no elements of dimension {} in '{}'", Dim, path), wanted,
                         "with physical groups gmsh saves only their elements: put the body into one");
    if (!elements.planar)
        throw InputError(where, fmt::format("nodes at different z in '{}'", path),
                         "a mesh in a plane z = const", "the deck is in 2D");
    return elements.mesh;
}

template ElementMesh<2> read_mesh_file(const std::string&, double, const std::string&);
template ElementMesh<3> read_mesh_file(const std::string&, double, const std::string&);

}  // namespace quern
