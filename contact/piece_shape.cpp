#include "contact/piece_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/point_cells.hpp"

namespace quern {

namespace {

constexpr double reach = 2.5, next_to = 1.5;            ///< [dx]
constexpr double as_near = 1.1;                         ///< as the nearest one
constexpr double least_delta = 0.25, most_delta = 0.5;  ///< [dx]

/// What one node of a piece has of a crack face.
template <int Dim>
struct Face {
    Vec<Dim> normal;
    double delta;
};

}  // namespace

template <int Dim>
Shape<Dim> make_piece_shape(const Shape<Dim>& whole, std::span<const int> piece, int number,
                            std::span<const int> nodes) {
    Shape<Dim> shape;
    shape.name = whole.name;
    shape.dx = whole.dx;
    shape.cornered = true;
    std::vector<Vec<Dim>> others;
    std::vector<int> node_of_other;
    for (int j = 0; j < whole.n_nodes(); ++j)
        if (piece[j] != number) {
            others.push_back(whole.X[j]);
            node_of_other.push_back(j);
        }
    PointCells<Dim> cells;
    cells.sort(others, reach * whole.dx, nullptr);
    const auto face_of = [&](const Vec<Dim>& X) {
        Face<Dim> face{Vec<Dim>::Zero(), std::numeric_limits<double>::infinity()};
        thread_local std::vector<Vec<Dim>> beside;
        beside.clear();
        cells.visit_near(X, [&](int k) {
            const Vec<Dim> d = others[k] - X;
            const double r = d.norm() / whole.dx;
            if (r >= reach) return;
            face.normal += whole.volume[node_of_other[k]] * (1.0 - r / reach) / r * d;
            if (r <= next_to) beside.push_back(d);
        });
        const double length = face.normal.norm();
        if (beside.empty() || !(length > 0.0)) return Face<Dim>{Vec<Dim>::Zero(), 0.0};
        face.normal /= length;
        double nearest = std::numeric_limits<double>::infinity();
        for (const Vec<Dim>& d : beside) nearest = std::min(nearest, d.norm());
        for (const Vec<Dim>& d : beside)
            if (d.norm() <= as_near * nearest) face.delta = std::min(face.delta, 0.5 * face.normal.dot(d));
        face.delta = std::clamp(face.delta, least_delta * whole.dx, most_delta * whole.dx);
        return face;
    };
    std::size_t next = 0;
    Vec<Dim> centre = Vec<Dim>::Zero();
    double volume = 0.0;
    for (const int i : nodes) {
        while (next < whole.surface.size() && whole.surface[next].node < i) ++next;
        const bool was_surface = next < whole.surface.size() && whole.surface[next].node == i;
        const Face<Dim> face = face_of(whole.X[i]);
        if (was_surface || face.delta > 0.0) {
            SurfacePoint<Dim> point;
            if (was_surface) point = whole.surface[next];
            point.node = shape.n_nodes();
            if (face.delta > 0.0) {
                const Vec<Dim> both = point.nu + face.normal;
                point.nu = both.squaredNorm() > 0.0 ? Vec<Dim>(both.normalized()) : face.normal;
                point.delta = was_surface ? std::min(point.delta, face.delta) : face.delta;
                point.kappa = 0.0;
            }
            shape.surface.push_back(point);
        }
        shape.X.push_back(whole.X[i]);
        shape.volume.push_back(whole.volume[i]);
        centre += whole.volume[i] * whole.X[i];
        volume += whole.volume[i];
    }
    centre /= volume;
    for (Vec<Dim>& X : shape.X) {
        X -= centre;
        shape.radius = std::max(shape.radius, X.norm() + most_delta * whole.dx);
    }
    return shape;
}

template Shape<2> make_piece_shape<2>(const Shape<2>&, std::span<const int>, int, std::span<const int>);
template Shape<3> make_piece_shape<3>(const Shape<3>&, std::span<const int>, int, std::span<const int>);

}  // namespace quern
