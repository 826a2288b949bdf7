#include "src/sim/overlap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "grid/error.hpp"

namespace quern {

namespace {

Spin<2> turn(const Numbers3& angle, Spin<2>) {
    return Spin<2>(angle[2]);
}
Spin<3> turn(const Numbers3& angle, Spin<3>) {
    return {angle[0], angle[1], angle[2]};
}

/// A surface particle of a placed grain.
template <int Dim>
struct PlacedPoint {
    Vec<Dim> x, normal;
    double depth;  ///< below the surface [m]
};

template <int Dim>
bool overlap(const PlacedPoint<Dim>& a, const PlacedPoint<Dim>& b, double dx) {
    const Vec<Dim> r = a.x - b.x;
    const bool near = r.squaredNorm() < 0.09 * dx * dx;
    if (a.depth + b.depth > 0.5 * dx) return near;
    if (near && a.normal.dot(b.normal) > 0.5) return true;
    const auto behind = [&](const Vec<Dim>& from, const Vec<Dim>& normal) {
        const double depth = -from.dot(normal);
        return depth > 0.5 * dx && depth < dx && (from + depth * normal).squaredNorm() < 0.36 * dx * dx;
    };
    return behind(r, b.normal) || behind(-r, a.normal);
}

}  // namespace

template <int Dim>
void check_overlap(const Deck& deck, const Scene<Dim>& scene) {
    double cell = 0.0;  // reach of overlap()
    for (const Grain<Dim>& grain : scene.grains) cell = std::max(cell, 1.2 * grain.shape->dx * grain.scale);
    struct Point {
        std::int64_t key;
        int grain, surface_point;
        bool operator<(const Point& other) const { return key < other.key; }
    };
    std::array<std::int64_t, Dim> stride;
    stride[0] = 1;
    for (int a = 1; a < Dim; ++a)
        stride[a] =
            stride[a - 1] * static_cast<std::int64_t>(2.0 * scene.grid.extent().maxCoeff() / cell + 8.0);
    std::vector<Point> points;
    std::vector<Mat<Dim>> rotation;
    for (std::size_t g = 0; g < scene.grains.size(); ++g) {
        const std::vector<SurfacePoint<Dim>>& surface = scene.grains[g].shape->surface;
        rotation.push_back(rotation_matrix(turn(deck.grains[scene.grains[g].id].angle, Spin<Dim>{})));
        for (std::size_t s = 0; s < surface.size(); ++s) {
            const int p = scene.grains[g].first + surface[s].node;
            std::int64_t key = 0;
            for (int a = 0; a < Dim; ++a)
                key += stride[a] * static_cast<std::int64_t>(
                                       std::floor((scene.particles.x[p][a] - scene.grid.origin()[a]) / cell));
            points.push_back({key, static_cast<int>(g), static_cast<int>(s)});
        }
    }
    std::stable_sort(points.begin(), points.end());
    const auto spacing = [&](int g) { return scene.grains[g].shape->dx * scene.grains[g].scale; };
    const auto placed = [&](const Point& point) {
        const Grain<Dim>& grain = scene.grains[point.grain];
        const SurfacePoint<Dim>& s = grain.shape->surface[static_cast<std::size_t>(point.surface_point)];
        return PlacedPoint<Dim>{scene.particles.x[grain.first + s.node], rotation[point.grain] * s.nu,
                                grain.scale * s.delta};
    };
    const auto compare = [&](const Point& a, const Point& b) {
        if (a.grain <= b.grain) return;
        if (!overlap(placed(a), placed(b), std::min(spacing(a.grain), spacing(b.grain)))) return;
        const int first = std::min(scene.grains[a.grain].id, scene.grains[b.grain].id);
        const int second = std::max(scene.grains[a.grain].id, scene.grains[b.grain].id);
        if (deck.grains[first].wall && deck.grains[second].wall) return;
        throw InputError(deck.grains[second].place.text(),
                         fmt::format("grain {} overlapping grain {}", second, first),
                         "grains apart or just touching", "move one of them");
    };
    for (const Point& point : points) {
        constexpr int n_rows = Dim == 2 ? 3 : 9;  // rows of cells along the first axis
        for (int row = 0; row < n_rows; ++row) {
            std::int64_t key = point.key + stride[1] * (row % 3 - 1);
            if constexpr (Dim == 3) key += stride[2] * (row / 3 - 1);
            auto it = std::lower_bound(points.begin(), points.end(), Point{key - 1, 0, 0});
            for (; it != points.end() && it->key <= key + 1; ++it) compare(point, *it);
        }
    }
}

template void check_overlap<2>(const Deck&, const Scene<2>&);
template void check_overlap<3>(const Deck&, const Scene<3>&);

}  // namespace quern
