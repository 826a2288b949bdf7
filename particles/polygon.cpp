#include "particles/polygon.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace quern {
namespace {

double cross2(const Vec<2>& a, const Vec<2>& b) {
    return a[0] * b[1] - a[1] * b[0];
}

/// Outward normal of an edge with matter on its left.
Vec<2> edge_normal(const Vec<2>& from, const Vec<2>& to) {
    const Vec<2> along = (to - from).normalized();
    return {along[1], -along[0]};
}

Vec<2> nearest_on_segment(const Vec<2>& a, const Vec<2>& b, const Vec<2>& x, double& t) {
    const Vec<2> along = b - a;
    t = std::clamp((x - a).dot(along) / along.squaredNorm(), 0.0, 1.0);
    return a + t * along;
}

double segment_distance(const Vec<2>& a, const Vec<2>& b, const Vec<2>& x) {
    double t = 0.0;
    return (x - nearest_on_segment(a, b, x, t)).norm();
}

bool cross_properly(const Vec<2>& a, const Vec<2>& b, const Vec<2>& c, const Vec<2>& d) {
    const Vec<2> ab = b - a, cd = d - c;
    return cross2(ab, c - a) * cross2(ab, d - a) < 0.0 && cross2(cd, a - c) * cross2(cd, b - c) < 0.0;
}

bool touch(const Vec<2>& a, const Vec<2>& b, const Vec<2>& c, const Vec<2>& d, double tolerance) {
    return cross_properly(a, b, c, d) || segment_distance(a, b, c) < tolerance ||
           segment_distance(a, b, d) < tolerance || segment_distance(c, d, a) < tolerance ||
           segment_distance(c, d, b) < tolerance;
}

std::optional<std::pair<int, int>> first_touching_edges(const std::vector<Vec<2>>& p, double tolerance) {
    const int n = static_cast<int>(p.size());
    for (int i = 0; i < n; ++i) {
        const Vec<2>&a = p[i], &b = p[(i + 1) % n];
        const double x_low = std::min(a[0], b[0]) - tolerance, x_high = std::max(a[0], b[0]) + tolerance;
        for (int j = i + 1; j < n; ++j) {
            const Vec<2>&c = p[j], &d = p[(j + 1) % n];
            if (std::max(c[0], d[0]) < x_low || std::min(c[0], d[0]) > x_high) continue;
            // Neighbours share a vertex: there only the far end may not come back onto the other edge.
            const bool after = j == i + 1, before = i == 0 && j == n - 1;
            const bool bad =
                after    ? segment_distance(a, b, d) < tolerance || segment_distance(c, d, a) < tolerance
                : before ? segment_distance(a, b, c) < tolerance || segment_distance(c, d, b) < tolerance
                         : touch(a, b, c, d, tolerance);
            if (bad) return std::pair(i, j);
        }
    }
    return std::nullopt;
}

/// Keeps the part of a ring of points where sign * (x[axis] - bound) <= 0.
void clip_half_plane(std::vector<Vec<2>>& ring, std::vector<Vec<2>>& scratch, int axis, double bound,
                     double sign) {
    scratch.clear();
    for (std::size_t i = 0; i < ring.size(); ++i) {
        const Vec<2>&a = ring[i], &b = ring[i + 1 < ring.size() ? i + 1 : 0];
        const double fa = sign * (a[axis] - bound), fb = sign * (b[axis] - bound);
        if (fa <= 0.0) scratch.push_back(a);
        if ((fa < 0.0 && fb > 0.0) || (fa > 0.0 && fb < 0.0)) scratch.push_back(a + fa / (fa - fb) * (b - a));
    }
    ring.swap(scratch);
}

}  // namespace

double signed_area(const std::vector<Vec<2>>& outline) {
    double twice = 0.0;
    for (std::size_t i = 0; i < outline.size(); ++i)
        twice += cross2(outline[i] - outline[0], outline[i + 1 < outline.size() ? i + 1 : 0] - outline[0]);
    return 0.5 * twice;
}

std::vector<VertexFrame> make_vertex_frames(const std::vector<Vec<2>>& outline) {
    const int n = static_cast<int>(outline.size());
    std::vector<VertexFrame> frames(n);
    for (int i = 0; i < n; ++i) {
        const Vec<2> in = outline[i] - outline[(i + n - 1) % n], out = outline[(i + 1) % n] - outline[i];
        const double l_in = in.norm(), l_out = out.norm();
        const double turning = std::atan2(cross2(in, out), in.dot(out));
        VertexFrame& frame = frames[i];
        frame.corner = std::abs(turning) >= corner_angle;
        const Vec<2> n_in(in[1] / l_in, -in[0] / l_in), n_out(out[1] / l_out, -out[0] / l_out);
        const double w_in = frame.corner ? 1.0 : l_in, w_out = frame.corner ? 1.0 : l_out;
        frame.normal = (w_in * n_in + w_out * n_out).normalized();
        frame.kappa = frame.corner ? 0.0 : 2.0 * turning / (l_in + l_out);
    }
    return frames;
}

std::optional<PolygonDefect> find_polygon_defect(const std::vector<Vec<2>>& vertices) {
    const int n = static_cast<int>(vertices.size());
    if (n < 3) return PolygonDefect{fmt::format("{} vertices", n), "at least 3 vertices", ""};
    Vec<2> low = vertices[0], high = vertices[0];
    for (int i = 0; i < n; ++i) {
        if (!vertices[i].allFinite())
            return PolygonDefect{fmt::format("vertex {} without a finite value", i + 1), "finite coordinates",
                                 ""};
        low = low.cwiseMin(vertices[i]);
        high = high.cwiseMax(vertices[i]);
    }
    const double tolerance = 1e-9 * (high - low).norm();
    for (int i = 0; i < n; ++i) {
        const int j = (i + 1) % n;
        if ((vertices[j] - vertices[i]).norm() > tolerance) continue;
        return PolygonDefect{fmt::format("vertices {} and {} at the same point", i + 1, j + 1),
                             "distinct vertices",
                             j == 0 ? "the outline closes by itself: do not repeat the first vertex" : ""};
    }
    if (const std::optional<std::pair<int, int>> pair = first_touching_edges(vertices, tolerance))
        return PolygonDefect{
            fmt::format("a self-intersecting outline: edges {}-{} and {}-{} (vertex numbers) meet",
                        pair->first + 1, (pair->first + 1) % n + 1, pair->second + 1,
                        (pair->second + 1) % n + 1),
            "a simple polygon", "the edges of an outline may meet only at common vertices"};
    if (signed_area(vertices) < 0.0)
        return PolygonDefect{"clockwise vertices", "counter-clockwise vertices", "reverse the list"};
    return std::nullopt;
}

Polygon::Polygon(std::vector<Vec<2>> vertices)
    : vertices_(std::move(vertices)),
      frames_(make_vertex_frames(vertices_)),
      low_(vertices_[0]),
      high_(vertices_[0]) {
    edge_normals_.resize(vertices_.size());
    for (int i = 0; i < static_cast<int>(vertices_.size()); ++i) {
        edge_normals_[i] = edge_normal(vertices_[i], vertices_[next(i)]);
        low_ = low_.cwiseMin(vertices_[i]);
        high_ = high_.cwiseMax(vertices_[i]);
        cornered_ = cornered_ || frames_[i].corner;
    }
}

double Polygon::radius_about(const Vec<2>& centre) const {
    double radius = 0.0;
    for (const Vec<2>& p : vertices_) radius = std::max(radius, (p - centre).norm());
    return radius;
}

Polygon::EdgePoint Polygon::nearest_on_edge(int edge, const Vec<2>& x) const {
    EdgePoint result;
    result.point = nearest_on_segment(vertices_[edge], vertices_[next(edge)], x, result.t);
    result.distance = (x - result.point).norm();
    return result;
}

bool Polygon::contains(const Vec<2>& x) const {
    bool inside = false;
    for (int i = 0; i < static_cast<int>(vertices_.size()); ++i) {
        const Vec<2>&a = vertices_[i], &b = vertices_[next(i)];
        if ((a[1] > x[1]) == (b[1] > x[1])) continue;
        if ((x[0] < a[0] + (x[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))) inside = !inside;
    }
    return inside;
}

double Polygon::distance(const Vec<2>& x) const {
    double nearest = std::numeric_limits<double>::max();
    for (int i = 0; i < static_cast<int>(vertices_.size()); ++i)
        nearest = std::min(nearest, nearest_on_edge(i, x).distance);
    return contains(x) ? nearest : -nearest;
}

SurfaceView<2> Polygon::view(const Vec<2>& x) const {
    int edge = 0;
    EdgePoint nearest = nearest_on_edge(0, x);
    for (int i = 1; i < static_cast<int>(vertices_.size()); ++i) {
        const EdgePoint p = nearest_on_edge(i, x);
        if (p.distance < nearest.distance) edge = i, nearest = p;
    }
    SurfaceView<2> view;
    view.point = nearest.point;
    view.distance = contains(x) ? nearest.distance : -nearest.distance;

    const VertexFrame &first = frames_[edge], &last = frames_[next(edge)];
    constexpr double at_end = 1e-9;
    if (nearest.t < at_end || nearest.t > 1.0 - at_end) {
        const VertexFrame& frame = nearest.t < at_end ? first : last;
        view.normal = frame.normal;
        view.kappa = frame.kappa;
        return view;
    }
    const Vec<2> n_first = first.corner ? edge_normals_[edge] : first.normal;
    const Vec<2> n_last = last.corner ? edge_normals_[edge] : last.normal;
    view.normal = ((1.0 - nearest.t) * n_first + nearest.t * n_last).normalized();
    const double k_first = first.corner ? last.kappa : first.kappa,
                 k_last = last.corner ? first.kappa : last.kappa;
    view.kappa = (1.0 - nearest.t) * k_first + nearest.t * k_last;
    if (!cornered_ || view.distance <= 0.0) return view;

    // Normals more than 120 degrees apart belong to the two sides of a thin part, not to one corner.
    const double reach = 1.25 * nearest.distance + 1e-9 * (high_ - low_).norm(),
                 most = std::cos(corner_angle);
    double second = reach;
    int other = -1;
    for (int i = 0; i < static_cast<int>(vertices_.size()); ++i) {
        const double alike = edge_normals_[i].dot(edge_normals_[edge]);
        if (alike > most || alike < -0.5 - 1e-9) continue;
        const EdgePoint p = nearest_on_edge(i, x);
        if (p.distance <= second && p.t > 0.0 && p.t < 1.0) second = p.distance, other = i;
    }
    if (other < 0) return view;
    view.normal = (edge_normals_[edge] + edge_normals_[other]).normalized();
    view.kappa = 0.0;
    view.distance = 0.5 * (nearest.distance + second);
    return view;
}

double Polygon::overlap(const Vec<2>& lo, const Vec<2>& hi) const {
    // Sutherland and Hodgman: a concave ring leaves bridges of no area on the border of the window.
    std::vector<Vec<2>> ring = vertices_, scratch;
    for (int axis = 0; axis < 2; ++axis) {
        clip_half_plane(ring, scratch, axis, lo[axis], -1.0);
        clip_half_plane(ring, scratch, axis, hi[axis], 1.0);
    }
    return std::max(0.0, signed_area(ring));
}

}  // namespace quern
