#include "contact/centre_dashpots.hpp"

#include <algorithm>
#include <numbers>

#include "grid/parallel.hpp"

namespace quern {

template <int Dim>
CentreDashpots<Dim>::CentreDashpots(const CartesianGrid<Dim>& grid, std::span<const Grain<Dim>> grains)
    : nearest_(grid), grid_(grid), blows_(grains.size()), density_sum_(grains.size()) {
    for (const Grain<Dim>& grain : grains) {
        const std::vector<Vec<Dim>>& X = grain.shape->X;
        const auto nearer = [](const Vec<Dim>& a, const Vec<Dim>& b) {
            return a.squaredNorm() < b.squaredNorm();
        };
        centre_node_.push_back(static_cast<int>(std::min_element(X.begin(), X.end(), nearer) - X.begin()));
        size_.push_back(grain.shape->radius * grain.scale);
        density_.push_back(grain.mass / grain.volume);
    }
}

template <int Dim>
double CentreDashpots<Dim>::ball(int grain) const {
    return (Dim == 2 ? 1.0 : 4.0 / 3.0) * std::numbers::pi * power(size_[grain], Dim);
}

template <int Dim>
void CentreDashpots<Dim>::find_neighbors(const ContactScene<Dim>& scene, const NodePairLaw<Dim>& law) {
    const int n = static_cast<int>(scene.grains.size());
    bool serves = !first_.empty();
    for (int g = 0; g < n && serves; ++g) serves = (scene.x[centre(scene, g)] - x_[g]).norm() < 0.5 * margin_;
    if (serves) return;
    margin_ = law.largest_radius();
    x_.resize(static_cast<std::size_t>(n));
    double largest = 0.0;
    for (int g = 0; g < n; ++g) {
        x_[g] = scene.x[centre(scene, g)];
        if (!scene.grains[g].wall) largest = std::max(largest, size_[g]);
    }
    const auto range = [&](int g, int h) {
        return size_[g] + size_[h] + 1.01 * law.published_radius(g, h) + margin_;
    };
    PointCells<Dim> cells;
    cells.sort(x_, 2.0 * largest + 2.01 * law.largest_radius() + margin_, &grid_);
    first_.assign(1, 0);
    neighbor_.clear();
    for (int g = 0; g < n; ++g) {
        if (!scene.grains[g].wall)
            cells.visit_near(x_[g], [&](int h) {
                if (h != g && !scene.grains[h].wall && nearest_(x_[g], x_[h]).norm() < range(g, h))
                    neighbor_.push_back(h);
            });
        first_.push_back(static_cast<int>(neighbor_.size()));
    }
}

/// The dashpots of one grain.
template <int Dim>
void CentreDashpots<Dim>::collect(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial, double kick,
                                  const NodePairLaw<Dim>& law, const NodePairList<Dim>& list, int g,
                                  std::vector<Blow>& blows) const {
    blows.clear();
    if (scene.grains[g].wall) return;
    const int c = centre(scene, g);
    const double M = density_[g] * ball(g);
    const auto add = [&](const Vec<Dim>& r, const Vec<Dim>& v, int h, double mass, int end) {
        const double b = law.centre_damping(g, h, mass), length = r.norm();
        const double approach = -r.dot(v - trial.v_before[c]) / length;
        if (approach > 0.0 && b > 0.0)
            blows.push_back({r, -kick * b * approach / (ball(g) * length) * r, end});
    };
    for (int k = first_[g]; k < first_[g + 1]; ++k) {
        const int h = neighbor_[k], other = centre(scene, h);
        const Vec<Dim> r = nearest_(scene.x[c], scene.x[other]);
        if (r.norm() >= size_[g] + size_[h] + 1.01 * law.published_radius(g, h)) continue;
        const double M_other = density_[h] * ball(h);
        add(r, trial.v_before[other], h, 2.0 * M * M_other / (M + M_other), another_grain);
    }
    thread_local std::vector<int> ends;  // nodes of walls and planes in reach
    ends.clear();
    const std::pair<int, int> rows = list.rows_of(g);
    for (int row = rows.first; row < rows.second; ++row) {
        const std::pair<int, int> entries = list.entries_of(row);
        for (int e = entries.first; e < entries.second; ++e) {
            const int q = list.partner(e), p = list.particle(row);
            if (q < 0) {
                if (2.0 * scene.walls[-1 - q].distance(scene.x[p]) < list.radius(e)) ends.push_back(q);
                continue;
            }
            const int h = list.grain(list.row_of(q));
            if (h == g || !scene.grains[h].wall) continue;
            if (nearest_(scene.x[p], scene.x[q]).norm() < law.published_radius(g, h)) ends.push_back(q);
        }
    }
    std::sort(ends.begin(), ends.end());
    ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
    for (const int end : ends)
        if (end < 0)
            add(-size_[g] * scene.walls[-1 - end].normal, scene.walls[-1 - end].velocity, g, M, end);
        else
            add(nearest_(scene.x[c], scene.x[end]), trial.v_before[end], list.grain(list.row_of(end)), M,
                end);
    // By where the other ends are, not by their numbers.
    std::sort(blows.begin(), blows.end(), [](const Blow& a, const Blow& b) {
        return std::lexicographical_compare(a.r.data(), a.r.data() + Dim, b.r.data(), b.r.data() + Dim);
    });
}

template <int Dim>
void CentreDashpots<Dim>::add_impulses(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial,
                                       double kick, const NodePairLaw<Dim>& law,
                                       const NodePairList<Dim>& list, ContactReport<Dim>& report) {
    find_neighbors(scene, law);
    parallel::for_each(
        scene.grains.size(),
        [&](std::size_t g) {
            collect(scene, trial, kick, law, list, static_cast<int>(g), blows_[g]);
            density_sum_[g].setZero();
            for (const Blow& blow : blows_[g]) density_sum_[g] += blow.density;
            if (blows_[g].empty()) return;
            const Grain<Dim>& grain = scene.grains[g];
            for (int p = grain.first; p < grain.first + grain.count; ++p)
                trial.v[p] += scene.volume[p] / scene.mass[p] * density_sum_[g];
            report.grain_impulse[g] += grain.volume * density_sum_[g];
        },
        16);
    for (std::size_t g = 0; g < scene.grains.size(); ++g)
        for (const Blow& blow : blows_[g]) {
            if (blow.end == another_grain) continue;
            const Grain<Dim>& grain = scene.grains[g];
            const Vec<Dim> J = grain.volume * blow.density;
            if (blow.end >= 0) {
                trial.v[blow.end] -= J / scene.mass[blow.end];
                report.grain_impulse[list.grain(list.row_of(blow.end))] -= J;
                continue;
            }
            Vec<Dim> middle = Vec<Dim>::Zero();
            for (int p = grain.first; p < grain.first + grain.count; ++p)
                middle += scene.volume[p] / grain.volume * scene.x[p];
            report.wall_impulse[-1 - blow.end] -= J;
            report.wall_moment[-1 - blow.end] -= moment(middle, J);
        }
}

template <int Dim>
void CentreDashpots<Dim>::book_losses(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial,
                                      ContactReport<Dim>& report) const {
    report.normal_work += parallel::sum(
        scene.grains.size(), 0.0,
        [&](std::size_t g) {
            if (blows_[g].empty()) return 0.0;
            const Grain<Dim>& grain = scene.grains[g];
            double work = 0.0;
            for (int p = grain.first; p < grain.first + grain.count; ++p)
                work += 0.5 * scene.volume[p] * density_sum_[g].dot(trial.v_before[p] + trial.v[p]);
            for (const Blow& blow : blows_[g])
                if (blow.end >= 0 && blow.end != another_grain)
                    work -=
                        0.5 * grain.volume * blow.density.dot(trial.v_before[blow.end] + trial.v[blow.end]);
            return work;
        },
        16);
    for (std::size_t g = 0; g < scene.grains.size(); ++g)
        for (const Blow& blow : blows_[g]) {
            if (blow.end >= 0) continue;
            const double work =
                scene.grains[g].volume * blow.density.dot(scene.walls[-1 - blow.end].velocity);
            report.wall_work += work;
            report.normal_work -= work;
        }
}

template class CentreDashpots<2>;
template class CentreDashpots<3>;

}  // namespace quern
