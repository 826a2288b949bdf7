#include "src/mesh/generate_mesh.hpp"

#include <fmt/format.h>
#include <gmsh.h>

#include <stdexcept>
#include <utility>
#include <vector>

#include "src/mesh/gmsh_elements.hpp"
#include "src/mesh/gmsh_session.hpp"

namespace quern {
namespace {

/// Everything that decides a mesh is set here, since the caller's program may have changed it.
void set_up_mesher(GmshSession& session, double spacing) {
    for (const auto& [option, value] : std::initializer_list<std::pair<const char*, double>>{
             {"Mesh.Algorithm", 6},  // frontal Delaunay
             {"Mesh.Algorithm3D", 1},
             {"Mesh.ElementOrder", 1},
             {"Mesh.RecombineAll", 0},
             {"Mesh.SubdivisionAlgorithm", 0},
             {"Mesh.Optimize", 1},
             {"Mesh.Smoothing", 1},
             {"Mesh.RandomFactor", 1e-9},
             {"Mesh.RandomFactor3D", 1e-12},
             {"Mesh.RandomSeed", 1},
             {"Mesh.MeshSizeFactor", 1},
             {"Mesh.MeshSizeFromPoints", 0},
             {"Mesh.MeshSizeFromCurvature", 0},
             {"Mesh.MeshSizeExtendFromBoundary", 0},
             {"Mesh.MeshSizeMin", spacing},
             {"Mesh.MeshSizeMax", spacing},
         })
        session.set(option, value);
}

/// Meshes the geometry that `draw` makes, of size about one, and scales the nodes by `size` [m].
template <int Dim, class Draw>
ElementMesh<Dim> mesh_with_gmsh(double size, double spacing, Draw draw) {
    try {
        GmshSession session;
        set_up_mesher(session, spacing / size);
        draw();
        gmsh::model::mesh::generate(Dim);
        return take_gmsh_elements<Dim>(size).mesh;
    } catch (...) {
        throw std::runtime_error(fmt::format("gmsh failed: {}", current_gmsh_error()));
    }
}

void draw_plane_surface(const std::vector<int>& curves) {
    gmsh::model::geo::addPlaneSurface({gmsh::model::geo::addCurveLoop(curves)});
    gmsh::model::geo::synchronize();
}

}  // namespace

ElementMesh<2> generate_mesh(const Ball<2>& disk, double spacing) {
    return mesh_with_gmsh<2>(disk.high()[0], spacing, [] {
        namespace geo = gmsh::model::geo;
        const int centre = geo::addPoint(0, 0, 0);
        const std::vector<int> rim{geo::addPoint(1, 0, 0), geo::addPoint(0, 1, 0), geo::addPoint(-1, 0, 0),
                                   geo::addPoint(0, -1, 0)};
        std::vector<int> arcs;
        for (int i = 0; i < 4; ++i) arcs.push_back(geo::addCircleArc(rim[i], centre, rim[(i + 1) % 4]));
        draw_plane_surface(arcs);
    });
}

ElementMesh<2> generate_mesh(const Ellipse& ellipse, double spacing) {
    const Vec<2> axes = ellipse.high();
    const double size = axes.maxCoeff();
    return mesh_with_gmsh<2>(size, spacing, [&] {
        namespace geo = gmsh::model::geo;
        const double a = axes[0] / size, b = axes[1] / size;
        const int centre = geo::addPoint(0, 0, 0);
        const std::vector<int> rim{geo::addPoint(a, 0, 0), geo::addPoint(0, b, 0), geo::addPoint(-a, 0, 0),
                                   geo::addPoint(0, -b, 0)};
        const int longest = a >= b ? rim[0] : rim[1];
        std::vector<int> arcs;
        for (int i = 0; i < 4; ++i)
            arcs.push_back(geo::addEllipseArc(rim[i], centre, longest, rim[(i + 1) % 4]));
        draw_plane_surface(arcs);
    });
}

ElementMesh<2> generate_mesh(const Polygon& polygon, double spacing) {
    const double size = (polygon.high() - polygon.low()).maxCoeff();
    return mesh_with_gmsh<2>(size, spacing, [&] {
        namespace geo = gmsh::model::geo;
        std::vector<int> points, lines;
        for (const Vec<2>& x : polygon.vertices())
            points.push_back(geo::addPoint(x[0] / size, x[1] / size, 0));
        for (std::size_t i = 0; i < points.size(); ++i)
            lines.push_back(geo::addLine(points[i], points[(i + 1) % points.size()]));
        draw_plane_surface(lines);
    });
}

ElementMesh<3> generate_mesh(const Ball<3>& ball, double spacing) {
    return mesh_with_gmsh<3>(ball.high()[0], spacing, [] {
        gmsh::model::occ::addSphere(0, 0, 0, 1);
        gmsh::model::occ::synchronize();
    });
}

ElementMesh<3> generate_mesh(const Cuboid& box, double spacing) {
    const Vec<3> edges = box.high() - box.low();
    const double size = edges.maxCoeff();
    return mesh_with_gmsh<3>(size, spacing, [&] {
        const Vec<3> e = edges / size;
        gmsh::model::occ::addBox(-0.5 * e[0], -0.5 * e[1], -0.5 * e[2], e[0], e[1], e[2]);
        gmsh::model::occ::synchronize();
    });
}

}  // namespace quern
