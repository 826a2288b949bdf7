// A simple polygon in the plane: area, nearest point of its outline, outward normal and curvature.
//
// A vertex that turns by less than 30 degrees is taken as a sample of a smooth curve, a sharper one as a
// corner.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "grid/vec.hpp"

namespace quern {

/// The true surface seen from a point.
template <int Dim>
struct SurfaceView {
    Vec<Dim> point = Vec<Dim>::Zero();   ///< nearest point of the surface [m]
    Vec<Dim> normal = Vec<Dim>::Zero();  ///< outward unit normal there; the bisector at an edge or corner
    double distance = 0.0;               ///< to the surface, positive inside [m]
    double kappa = 0.0;                  ///< curvature there [1/m], positive where convex; 0 at a corner
};

/// Turning angle [rad] from which a vertex of an outline, or an edge of a triangulation, is a corner.
inline constexpr double corner_angle = 30.0 * 3.14159265358979323846 / 180.0;

/// The surface at one vertex of a closed outline.
struct VertexFrame {
    Vec<2> normal = Vec<2>::Zero();  ///< outward unit normal
    double kappa = 0.0;              ///< [1/m]; 0 at a corner
    bool corner = false;
};

/// Frames at the vertices of a closed outline with matter on its left.
///
///     tau_i    = angle from edge i-1 to edge i                     [rad], positive where convex
///     smooth   : n_i = (l_{i-1} n_{i-1} + l_i n_i)/|.|,  kappa_i = 2 tau_i/(l_{i-1} + l_i)
///     a corner : n_i = (n_{i-1} + n_i)/|.|  (edge normals, unit),  kappa_i = 0
///
/// l: edge lengths [m]. kappa is exact for vertices on a circle up to (l/R)^2/24.
std::vector<VertexFrame> make_vertex_frames(const std::vector<Vec<2>>& outline);

/// Area [m^2] inside a closed outline; negative when it runs clockwise.
double signed_area(const std::vector<Vec<2>>& outline);

/// What makes a list of vertices no counter-clockwise simple polygon.
struct PolygonDefect {
    std::string got, expected, hint;
};

/// The first defect of the outline: too few vertices, a coordinate that is no number, a repeated vertex, a
/// crossing or touching pair of edges, clockwise order; none for a usable polygon.
std::optional<PolygonDefect> find_polygon_defect(const std::vector<Vec<2>>& vertices);

/// A solid bounded by a simple counter-clockwise polygon; find_polygon_defect() must have found nothing.
class Polygon {
  public:
    explicit Polygon(std::vector<Vec<2>> vertices);

    const std::vector<Vec<2>>& vertices() const { return vertices_; }
    bool cornered() const { return cornered_; }
    /// Largest distance [m] of the outline from a point.
    double radius_about(const Vec<2>& centre) const;
    Vec<2> low() const { return low_; }
    Vec<2> high() const { return high_; }
    double measure() const { return signed_area(vertices_); }
    /// Points of the surface, for drawing.
    std::vector<Vec<2>> outline() const { return vertices_; }

    /// Distance [m] to the outline, positive inside.
    double distance(const Vec<2>& x) const;

    /// The surface nearest to x. On an edge the normal and the curvature are interpolated between smooth
    /// ends. Where a second face lies beyond a corner and no further than 1.25 times the nearest one, the
    /// normal is the bisector of both and the distance their mean: such a node belongs to the corner.
    SurfaceView<2> view(const Vec<2>& x) const;

    /// Exact area [m^2] of the part inside the rectangle [lo, hi].
    double overlap(const Vec<2>& lo, const Vec<2>& hi) const;

  private:
    struct EdgePoint {
        Vec<2> point;
        double t;         ///< position along the edge, 0 to 1
        double distance;  ///< unsigned
    };
    EdgePoint nearest_on_edge(int edge, const Vec<2>& x) const;
    bool contains(const Vec<2>& x) const;
    int next(int i) const { return i + 1 < static_cast<int>(vertices_.size()) ? i + 1 : 0; }

    std::vector<Vec<2>> vertices_;
    std::vector<VertexFrame> frames_;
    std::vector<Vec<2>> edge_normals_;  ///< edge i runs from vertex i to its successor
    Vec<2> low_, high_;
    bool cornered_ = false;
};

}  // namespace quern
