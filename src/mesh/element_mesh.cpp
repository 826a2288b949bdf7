#include "src/mesh/element_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace quern {
namespace {

template <int Dim>
using Element = typename ElementMesh<Dim>::Element;

constexpr std::array<std::array<int, 4>, 4> tet_faces{
    {{0, 2, 1, -1}, {0, 1, 3, -1}, {0, 3, 2, -1}, {1, 2, 3, -1}}};
constexpr std::array<std::array<int, 4>, 6> hex_faces{
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};
/// Corners of the reference square (first four) and cube, in the order of gmsh.
constexpr std::array<std::array<int, 3>, 8> reference_corner{
    {{-1, -1, -1}, {1, -1, -1}, {1, 1, -1}, {-1, 1, -1}, {-1, -1, 1}, {1, -1, 1}, {1, 1, 1}, {-1, 1, 1}}};

template <int Dim>
constexpr bool is_simplex(int n_nodes) {
    return n_nodes == Dim + 1;
}

template <int Dim>
double multilinear(int corner, const Vec<Dim>& r) {
    double value = 1.0;
    for (int a = 0; a < Dim; ++a) value *= 0.5 * (1.0 + reference_corner[corner][a] * r[a]);
    return value;
}

/// Determinant of d x/d r of a quadrangle or hexahedron at the reference point r.
template <int Dim>
double jacobian(const ElementMesh<Dim>& mesh, const Element<Dim>& element, const Vec<Dim>& r) {
    Mat<Dim> J = Mat<Dim>::Zero();
    for (int k = 0; k < element.n_nodes; ++k)
        for (int a = 0; a < Dim; ++a) {
            double slope = 0.5 * reference_corner[k][a];
            for (int b = 0; b < Dim; ++b)
                if (b != a) slope *= 0.5 * (1.0 + reference_corner[k][b] * r[b]);
            J.col(a) += slope * mesh.X[element.node[k]];
        }
    return J.determinant();
}

template <int Dim>
double simplex_jacobian(const ElementMesh<Dim>& mesh, const Element<Dim>& element) {
    Mat<Dim> J;
    for (int a = 0; a < Dim; ++a) J.col(a) = mesh.X[element.node[a + 1]] - mesh.X[element.node[0]];
    return J.determinant();
}

/// Smallest Jacobian over the corners, relative to the cube of the element's size.
template <int Dim>
double worst_jacobian(const ElementMesh<Dim>& mesh, const Element<Dim>& element) {
    double size = 0.0;
    for (int k = 1; k < element.n_nodes; ++k)
        size = std::max(size, (mesh.X[element.node[k]] - mesh.X[element.node[0]]).norm());
    const double unit = std::pow(size, Dim);
    if (unit == 0.0) return 0.0;
    if (is_simplex<Dim>(element.n_nodes)) return simplex_jacobian<Dim>(mesh, element) / unit;
    double worst = 1.0;
    for (int k = 0; k < element.n_nodes; ++k) {
        Vec<Dim> r;
        for (int a = 0; a < Dim; ++a) r[a] = reference_corner[k][a];
        worst = std::min(worst, jacobian<Dim>(mesh, element, r) * std::pow(2.0, Dim) / unit);
    }
    return worst;
}

template <int Dim>
std::vector<Facet> facets_of(const ElementMesh<Dim>& mesh, int e) {
    const Element<Dim>& element = mesh.elements[e];
    std::vector<Facet> facets;
    if constexpr (Dim == 2) {
        for (int k = 0; k < element.n_nodes; ++k)
            facets.push_back({e, 2, {element.node[k], element.node[(k + 1) % element.n_nodes], -1, -1}});
    } else {
        const auto add = [&](const std::array<int, 4>& corners, int n) {
            Facet facet{e, n, {-1, -1, -1, -1}};
            for (int k = 0; k < n; ++k) facet.node[k] = element.node[corners[k]];
            facets.push_back(facet);
        };
        if (element.n_nodes == 4)
            for (const std::array<int, 4>& corners : tet_faces) add(corners, 3);
        else
            for (const std::array<int, 4>& corners : hex_faces) add(corners, 4);
    }
    return facets;
}

using FacetKey = std::array<int, 4>;

FacetKey key_of(const Facet& facet) {
    FacetKey key = facet.node;
    std::sort(key.begin(), key.end());
    return key;
}

/// Which way round the facet runs, the same for any starting node.
bool runs_upward(const Facet& facet) {
    const int n = facet.n_nodes;
    const int lowest =
        static_cast<int>(std::min_element(facet.node.begin(), facet.node.begin() + n) - facet.node.begin());
    if (n == 2) return lowest == 0;
    return facet.node[(lowest + 1) % n] < facet.node[(lowest + n - 1) % n];
}

int find_root(std::vector<int>& parent, int i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

}  // namespace

template <int Dim>
std::optional<MeshDefect> find_mesh_defect(const ElementMesh<Dim>& mesh) {
    const int n_elements = static_cast<int>(mesh.elements.size());
    constexpr double flat = 1e-8;
    int n_flipped = 0;
    const Element<Dim>*first_flipped = nullptr, *first_flat = nullptr;
    for (const Element<Dim>& element : mesh.elements) {
        const double worst = worst_jacobian<Dim>(mesh, element);
        if (worst < -flat) {
            ++n_flipped;
            if (!first_flipped) first_flipped = &element;
        } else if (worst < flat && !first_flat) {
            first_flat = &element;
        }
    }
    const char* order = Dim == 2 ? "nodes counter-clockwise and convex" : "positive Jacobian at every corner";
    if (first_flipped)
        return MeshDefect{
            fmt::format("flipped element {} ({} of {} elements)", first_flipped->tag, n_flipped, n_elements),
            order,
            n_flipped == n_elements ? "the whole mesh is mirrored: reverse its outline or surface" : ""};
    if (first_flat)
        return MeshDefect{
            fmt::format("degenerate element {} (no {})", first_flat->tag, Dim == 2 ? "area" : "volume"),
            order, ""};

    std::map<FacetKey, Facet> seen;
    std::vector<int> parent(n_elements);
    std::iota(parent.begin(), parent.end(), 0);
    std::map<FacetKey, int> n_uses;
    for (int e = 0; e < n_elements; ++e)
        for (const Facet& facet : facets_of<Dim>(mesh, e)) {
            const auto [other, first] = seen.emplace(key_of(facet), facet);
            const int uses = ++n_uses[other->first];
            if (first) continue;
            if (uses > 2 || runs_upward(facet) == runs_upward(other->second))
                return MeshDefect{fmt::format("elements {} and {} on the same side of a common {}",
                                              mesh.elements[other->second.element].tag, mesh.elements[e].tag,
                                              Dim == 2 ? "edge" : "face"),
                                  "elements that do not overlap", ""};
            parent[find_root(parent, e)] = find_root(parent, other->second.element);
        }
    int n_pieces = 0;
    for (int e = 0; e < n_elements; ++e) n_pieces += find_root(parent, e) == e;
    if (n_pieces > 1)
        return MeshDefect{fmt::format("{} disconnected pieces", n_pieces), "one connected piece a grain",
                          "give each piece its own file; nodes on common faces must be shared"};

    if constexpr (Dim == 2) {
        std::vector<int> n_starts(mesh.X.size(), 0);
        for (const Facet& facet : find_boundary<Dim>(mesh))
            if (++n_starts[facet.node[0]] > 1)
                return MeshDefect{fmt::format("a boundary that touches itself at element {}",
                                              mesh.elements[facet.element].tag),
                                  "a boundary of simple closed loops", ""};
    }
    return std::nullopt;
}

template <int Dim>
std::vector<double> make_lumped_volumes(const ElementMesh<Dim>& mesh) {
    std::vector<double> volume(mesh.X.size(), 0.0);
    const double gauss = 1.0 / std::sqrt(3.0);
    for (const Element<Dim>& element : mesh.elements) {
        if (is_simplex<Dim>(element.n_nodes)) {
            const double share = simplex_jacobian<Dim>(mesh, element) / (Dim == 2 ? 2.0 : 6.0) / (Dim + 1);
            for (int k = 0; k < element.n_nodes; ++k) volume[element.node[k]] += share;
            continue;
        }
        for (int g = 0; g < element.n_nodes; ++g) {
            Vec<Dim> r;
            for (int a = 0; a < Dim; ++a) r[a] = gauss * reference_corner[g][a];
            const double weight = jacobian<Dim>(mesh, element, r);
            for (int k = 0; k < element.n_nodes; ++k)
                volume[element.node[k]] += weight * multilinear<Dim>(k, r);
        }
    }
    return volume;
}

template <int Dim>
std::vector<Facet> find_boundary(const ElementMesh<Dim>& mesh) {
    std::map<FacetKey, int> n_uses;
    const int n_elements = static_cast<int>(mesh.elements.size());
    for (int e = 0; e < n_elements; ++e)
        for (const Facet& facet : facets_of<Dim>(mesh, e)) ++n_uses[key_of(facet)];
    std::vector<Facet> boundary;
    for (int e = 0; e < n_elements; ++e)
        for (const Facet& facet : facets_of<Dim>(mesh, e))
            if (n_uses[key_of(facet)] == 1) boundary.push_back(facet);
    return boundary;
}

template struct ElementMesh<2>;
template struct ElementMesh<3>;
template std::optional<MeshDefect> find_mesh_defect(const ElementMesh<2>&);
template std::optional<MeshDefect> find_mesh_defect(const ElementMesh<3>&);
template std::vector<double> make_lumped_volumes(const ElementMesh<2>&);
template std::vector<double> make_lumped_volumes(const ElementMesh<3>&);
template std::vector<Facet> find_boundary(const ElementMesh<2>&);
template std::vector<Facet> find_boundary(const ElementMesh<3>&);

}  // namespace quern
