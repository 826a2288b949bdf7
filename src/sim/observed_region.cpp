#include "src/sim/observed_region.hpp"

#include <algorithm>
#include <cmath>

namespace quern {

namespace {

constexpr double across = 1.0 - 1e-12;  ///< least component of the normal of a wall across an axis
/// Points along an edge of the lattice that measures what walls and formulas cut.
constexpr int points_an_edge(int dimension) {
    return dimension == 2 ? 512 : 64;
}

/// The axis that a wall stands across, or -1.
template <int Dim>
int axis_of(const Wall<Dim>& wall) {
    for (int a = 0; a < Dim; ++a)
        if (std::abs(wall.normal[a]) > across) return a;
    return -1;
}

}  // namespace

template <int Dim>
ObservedBox<Dim> box_between_walls(const Scene<Dim>& scene) {
    ObservedBox<Dim> box{scene.grid.origin(), scene.grid.origin() + scene.grid.extent()};
    for (const Wall<Dim>& wall : scene.walls) {
        const int a = axis_of(wall);
        if (a < 0) continue;
        if (wall.normal[a] > 0.0)
            box.low[a] = std::max(box.low[a], wall.point[a]);
        else
            box.high[a] = std::min(box.high[a], wall.point[a]);
    }
    return box;
}

template <int Dim>
ObservedRegion<Dim>::ObservedRegion(const Scene<Dim>& scene, const ObserveRegion* region, double time)
    : scene_(scene), time_(time), box_(box_between_walls(scene)) {
    if (region != nullptr && region->where) where_ = &region->where;
    for (int a = 0; a < Dim && region != nullptr && region->from; ++a) {
        const double low = (*region->from)[a], high = (*region->to)[a];
        cut_low_[a] = low > box_.low[a];
        cut_high_[a] = high < box_.high[a];
        if (cut_low_[a]) box_.low[a] = low;
        if (cut_high_[a]) box_.high[a] = high;
    }
    const Vec<Dim> edges = (box_.high - box_.low).cwiseMax(0.0);
    volume_ = edges.prod();
    const bool oblique = std::any_of(scene.walls.begin(), scene.walls.end(),
                                     [](const Wall<Dim>& wall) { return axis_of(wall) < 0; });
    if (where_ == nullptr && !oblique) return;
    constexpr int n = points_an_edge(Dim);
    std::int64_t inside = 0;
    for (std::int64_t k = 0; k < power(std::int64_t{n}, Dim); ++k) {
        Vec<Dim> x;
        for (std::int64_t a = 0, rest = k; a < Dim; ++a, rest /= n)
            x[a] = box_.low[a] + (static_cast<double>(rest % n) + 0.5) / n * edges[a];
        const bool before_walls = std::all_of(scene.walls.begin(), scene.walls.end(),
                                              [&](const Wall<Dim>& wall) { return wall.distance(x) >= 0.0; });
        inside += before_walls && formula_holds(x);
    }
    volume_ *= static_cast<double>(inside) / static_cast<double>(power(std::int64_t{n}, Dim));
}

template <int Dim>
Vec<Dim> ObservedRegion<Dim>::wrapped(Vec<Dim> x) const {
    const Vec<Dim> extent = scene_.grid.extent();
    for (int a = 0; a < Dim; ++a)
        if (scene_.grid.periodic(a))
            x[a] -= extent[a] * std::floor((x[a] - scene_.grid.origin()[a]) / extent[a]);
    return x;
}

template <int Dim>
bool ObservedRegion<Dim>::formula_holds(const Vec<Dim>& x) const {
    return where_ == nullptr || (**where_)(x[0], x[1], Dim == 3 ? x[Dim - 1] : 0.0, time_) != 0.0;
}

template <int Dim>
bool ObservedRegion<Dim>::contains(const Vec<Dim>& x) const {
    const Vec<Dim> at = wrapped(x);
    for (int a = 0; a < Dim; ++a)
        if ((cut_low_[a] && at[a] < box_.low[a]) || (cut_high_[a] && at[a] >= box_.high[a])) return false;
    return formula_holds(at);
}

template <int Dim>
double ObservedRegion<Dim>::part(const Vec<Dim>& x, double volume) const {
    const Vec<Dim> at = wrapped(x), extent = scene_.grid.extent();
    if (!formula_holds(at)) return 0.0;
    const double size = std::pow(volume, 1.0 / Dim);
    double part = 1.0;
    for (int a = 0; a < Dim; ++a) {
        if (!cut_low_[a] && !cut_high_[a]) continue;
        const auto length = [&](double centre) {
            const double low = cut_low_[a] ? std::max(centre - 0.5 * size, box_.low[a]) : centre - 0.5 * size;
            const double high =
                cut_high_[a] ? std::min(centre + 0.5 * size, box_.high[a]) : centre + 0.5 * size;
            return std::max(0.0, high - low) / size;
        };
        double here = length(at[a]);
        if (scene_.grid.periodic(a) && cut_low_[a] && cut_high_[a])
            here += length(at[a] - extent[a]) + length(at[a] + extent[a]);
        part *= here;
    }
    return part;
}

template ObservedBox<2> box_between_walls<2>(const Scene<2>&);
template ObservedBox<3> box_between_walls<3>(const Scene<3>&);
template class ObservedRegion<2>;
template class ObservedRegion<3>;

}  // namespace quern
