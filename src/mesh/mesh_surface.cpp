#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "particles/polygon.hpp"
#include "src/mesh/element_mesh.hpp"

namespace quern {
namespace {

using Triangle = std::array<int, 3>;

MeshSurface<2> fit_loops(const ElementMesh<2>& mesh) {
    std::vector<int> successor(mesh.X.size(), -1);
    for (const Facet& facet : find_boundary<2>(mesh)) successor[facet.node[0]] = facet.node[1];

    MeshSurface<2> surface;
    std::vector<bool> done(mesh.X.size(), false);
    double outer_area = 0.0;
    for (int start = 0; start < static_cast<int>(mesh.X.size()); ++start) {
        if (successor[start] < 0 || done[start]) continue;
        std::vector<int> nodes;
        std::vector<Vec<2>> loop;
        for (int i = start; !done[i]; i = successor[i]) {
            done[i] = true;
            nodes.push_back(i);
            loop.push_back(mesh.X[i]);
        }
        const std::vector<VertexFrame> frames = make_vertex_frames(loop);
        for (std::size_t i = 0; i < nodes.size(); ++i) {
            surface.points.push_back({nodes[i], frames[i].normal, 0.0, frames[i].kappa});
            surface.cornered = surface.cornered || frames[i].corner;
        }
        // Holes run clockwise: their area is negative.
        if (const double area = signed_area(loop); area > outer_area) {
            outer_area = area;
            surface.outline = std::move(loop);
        }
    }
    return surface;
}

/// Boundary triangles; quadrangles are cut along the shorter diagonal.
std::vector<Triangle> boundary_triangles(const ElementMesh<3>& mesh) {
    std::vector<Triangle> triangles;
    for (const Facet& facet : find_boundary<3>(mesh)) {
        const std::array<int, 4>& n = facet.node;
        if (facet.n_nodes == 3) {
            triangles.push_back({n[0], n[1], n[2]});
            continue;
        }
        const bool first = (mesh.X[n[0]] - mesh.X[n[2]]).norm() <= (mesh.X[n[1]] - mesh.X[n[3]]).norm();
        triangles.push_back(first ? Triangle{n[0], n[1], n[2]} : Triangle{n[0], n[1], n[3]});
        triangles.push_back(first ? Triangle{n[0], n[2], n[3]} : Triangle{n[1], n[2], n[3]});
    }
    return triangles;
}

MeshSurface<3> fit_triangulation(const ElementMesh<3>& mesh) {
    const std::vector<Triangle> triangles = boundary_triangles(mesh);
    const std::size_t n_nodes = mesh.X.size();
    std::vector<bool> on_surface(n_nodes, false), corner(n_nodes, false);
    std::vector<Vec<3>> normal(n_nodes, Vec<3>::Zero()), bisector(n_nodes, Vec<3>::Zero());

    std::vector<Vec<3>> face_normal;
    std::vector<std::array<double, 3>> angles;
    std::map<std::pair<int, int>, int> face_beside;  // directed edge -> triangle on its left
    for (const Triangle& t : triangles) {
        face_normal.push_back((mesh.X[t[1]] - mesh.X[t[0]]).cross(mesh.X[t[2]] - mesh.X[t[0]]).normalized());
        std::array<double, 3> angle{};
        for (int k = 0; k < 3; ++k) {
            const Vec<3> a = mesh.X[t[(k + 1) % 3]] - mesh.X[t[k]], b = mesh.X[t[(k + 2) % 3]] - mesh.X[t[k]];
            angle[k] = std::atan2(a.cross(b).norm(), a.dot(b));
            normal[t[k]] += a.cross(b) / (a.squaredNorm() * b.squaredNorm());
            bisector[t[k]] += angle[k] * face_normal.back();
            on_surface[t[k]] = true;
            face_beside[{t[k], t[(k + 1) % 3]}] = static_cast<int>(face_normal.size()) - 1;
        }
        angles.push_back(angle);
    }
    const double least_cosine = std::cos(corner_angle);
    for (const auto& [edge, face] : face_beside) {
        const auto across = face_beside.find({edge.second, edge.first});
        if (across == face_beside.end() || face_normal[face].dot(face_normal[across->second]) <= least_cosine)
            corner[edge.first] = corner[edge.second] = true;
    }
    for (std::size_t i = 0; i < n_nodes; ++i)
        if (on_surface[i]) normal[i] = (corner[i] ? bisector[i] : normal[i]).normalized();

    // Every triangle gives half its angle at a node to each of its two edges there.
    std::vector<double> weighted(n_nodes, 0.0), weight(n_nodes, 0.0);
    for (std::size_t f = 0; f < triangles.size(); ++f)
        for (int k = 0; k < 3; ++k) {
            const int node = triangles[f][k];
            for (int other = 1; other <= 2; ++other) {
                const Vec<3> chord = mesh.X[node] - mesh.X[triangles[f][(k + other) % 3]];
                weighted[node] += 0.5 * angles[f][k] * 2.0 * normal[node].dot(chord) / chord.squaredNorm();
                weight[node] += 0.5 * angles[f][k];
            }
        }
    MeshSurface<3> surface;
    for (int i = 0; i < static_cast<int>(n_nodes); ++i) {
        if (!on_surface[i]) continue;
        surface.points.push_back({i, normal[i], 0.0, corner[i] ? 0.0 : weighted[i] / weight[i]});
        surface.outline.push_back(mesh.X[i]);
        surface.cornered = surface.cornered || corner[i];
    }
    return surface;
}

}  // namespace

template <int Dim>
MeshSurface<Dim> fit_surface(const ElementMesh<Dim>& mesh) {
    MeshSurface<Dim> surface;
    if constexpr (Dim == 2)
        surface = fit_loops(mesh);
    else
        surface = fit_triangulation(mesh);
    std::sort(surface.points.begin(), surface.points.end(),
              [](const SurfacePoint<Dim>& a, const SurfacePoint<Dim>& b) { return a.node < b.node; });
    return surface;
}

template MeshSurface<2> fit_surface(const ElementMesh<2>&);
template MeshSurface<3> fit_surface(const ElementMesh<3>&);

}  // namespace quern
