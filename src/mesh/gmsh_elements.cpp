#include "src/mesh/gmsh_elements.hpp"

#include <gmsh.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace quern {
namespace {

/// Nodes of gmsh's linear elements: triangle 2, quadrangle 3, tetrahedron 4, hexahedron 5; 0 for all others.
int n_nodes_of_type(int type, int dim) {
    if (dim == 2) return type == 2 ? 3 : type == 3 ? 4 : 0;
    return type == 4 ? 4 : type == 5 ? 8 : 0;
}

std::string type_name(int type) {
    std::string name;
    int dim = 0, order = 0, n_nodes = 0, n_primary = 0;
    std::vector<double> local;
    gmsh::model::mesh::getElementProperties(type, name, dim, order, n_nodes, local, n_primary);
    return name;
}

}  // namespace

template <int Dim>
GmshElements<Dim> take_gmsh_elements(double unit) {
    GmshElements<Dim> result;
    std::vector<int> types;
    std::vector<std::vector<std::size_t>> tags, nodes;
    gmsh::model::mesh::getElements(types, tags, nodes, 3);
    result.has_3d = !types.empty();
    if constexpr (Dim == 2) gmsh::model::mesh::getElements(types, tags, nodes, Dim);

    std::vector<std::size_t> node_tags;
    std::vector<double> coordinates, parameters;
    gmsh::model::mesh::getNodes(node_tags, coordinates, parameters);
    std::map<std::size_t, Vec<3>> position;
    for (std::size_t i = 0; i < node_tags.size(); ++i)
        position.emplace(node_tags[i],
                         Vec<3>(coordinates[3 * i], coordinates[3 * i + 1], coordinates[3 * i + 2]));

    std::map<std::size_t, int> index;
    for (std::size_t t = 0; t < types.size(); ++t) {
        const int n = n_nodes_of_type(types[t], Dim);
        if (n == 0) {
            result.foreign = type_name(types[t]);
            return result;
        }
        for (const std::size_t node : nodes[t]) index.emplace(node, 0);
    }
    Vec<3> low = Vec<3>::Constant(INFINITY), high = -low;
    for (auto& [tag, i] : index) {
        const auto found = position.find(tag);
        if (found == position.end()) {
            result.missing_nodes.push_back(tag);
            continue;
        }
        i = static_cast<int>(result.mesh.X.size());
        result.mesh.X.push_back(unit * found->second.template head<Dim>());
        low = low.cwiseMin(found->second);
        high = high.cwiseMax(found->second);
    }
    if (!result.missing_nodes.empty() || index.empty()) return result;
    if constexpr (Dim == 2) result.planar = high[2] - low[2] <= 1e-9 * (high - low).norm();

    for (std::size_t t = 0; t < types.size(); ++t) {
        const int n = n_nodes_of_type(types[t], Dim);
        for (std::size_t e = 0; e < tags[t].size(); ++e) {
            typename ElementMesh<Dim>::Element element;
            element.tag = tags[t][e];
            element.n_nodes = n;
            for (int k = 0; k < n; ++k) element.node[k] = index.at(nodes[t][e * n + k]);
            result.mesh.elements.push_back(element);
        }
    }
    return result;
}

template GmshElements<2> take_gmsh_elements(double);
template GmshElements<3> take_gmsh_elements(double);

}  // namespace quern
