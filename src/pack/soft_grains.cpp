#include "src/pack/soft_grains.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace quern {
namespace {

constexpr double skin_part =
    0.2;  ///< of the mean size: how far centres may be apart without contact in a pair

}  // namespace

SoftGrains::SoftGrains(PackedGrains grains) : grains_(std::move(grains)) {
    const auto n = static_cast<std::size_t>(grains_.n());
    for (const double size : grains_.size) mean_size_ += size / static_cast<double>(n);
    by_size_.resize(n);
    std::iota(by_size_.begin(), by_size_.end(), 0);
    std::stable_sort(by_size_.begin(), by_size_.end(),
                     [this](int a, int b) { return grains_.size[a] < grains_.size[b]; });
    for (std::vector<double>* v : {&fx_, &fy_, &torque_, &vx_, &vy_, &spin_, &weight_, &turn_weight_})
        v->assign(n, 0.0);
    for (int i = 0; i < grains_.n(); ++i) {
        const double mass = std::max(0.5, grains_.size[i] / mean_size_);
        weight_[i] = 1.0 / std::sqrt(mass);
        turn_weight_[i] = grains_.outline_of(i).disk ? 0.0 : weight_[i] / (0.35 * grains_.size[i]);
        turning_ = turning_ || !grains_.outline_of(i).disk;
    }
    slot_.resize(n);
    make_pairs();
}

void SoftGrains::set_factor(double factor) {
    factor_ = factor;
    make_pairs();
}

void SoftGrains::set_places(const PackedGrains& from) {
    grains_.x = from.x;
    grains_.y = from.y;
    grains_.c = from.c;
    grains_.s = from.s;
    make_pairs();
}

int SoftGrains::cell_of(int i) const {
    const Region& region = grains_.region;
    int cell[2];
    for (int axis = 0; axis < 2; ++axis) {
        const double at =
            ((axis == 0 ? grains_.x[i] : grains_.y[i]) - region.low[axis]) / region.length(axis);
        cell[axis] = std::clamp(static_cast<int>(std::floor(at * n_cells_[axis])), 0, n_cells_[axis] - 1);
    }
    return cell[1] * n_cells_[0] + cell[0];
}

/// Calls f(cell) for a cell and those around it, each once.
template <class F>
void for_cells_around(const Region& region, const int* n_cells, int cell, F f) {
    const int cx = cell % n_cells[0], cy = cell / n_cells[0];
    int around[2][3], n[2] = {0, 0};
    const int at[2] = {cx, cy};
    for (int axis = 0; axis < 2; ++axis)
        for (int step = -1; step <= 1; ++step) {
            int k = at[axis] + step;
            if (region.periodic(axis)) k = (k + n_cells[axis]) % n_cells[axis];
            if (k < 0 || k >= n_cells[axis]) continue;
            if (std::find(around[axis], around[axis] + n[axis], k) == around[axis] + n[axis])
                around[axis][n[axis]++] = k;
        }
    for (int b = 0; b < n[1]; ++b)
        for (int a = 0; a < n[0]; ++a) f(around[1][b] * n_cells[0] + around[0][a]);
}

void SoftGrains::make_pairs() {
    wrap(grains_);
    skin_ = skin_part * factor_ * mean_size_;
    double largest = 0.0;
    for (int i = 0; i < grains_.n(); ++i) largest = std::max(largest, factor_ * grains_.reach(i));
    for (int axis = 0; axis < 2; ++axis) {
        const double cells = std::floor(grains_.region.length(axis) / (2.0 * largest + skin_));
        n_cells_[axis] = static_cast<int>(std::clamp(cells, 1.0, 4096.0));
    }
    const auto n = static_cast<std::size_t>(grains_.n());
    std::vector<int> cell(n);
    cell_first_.assign(static_cast<std::size_t>(n_cells_[0] * n_cells_[1] + 1), 0);
    for (int i = 0; i < grains_.n(); ++i) ++cell_first_[static_cast<std::size_t>((cell[i] = cell_of(i)) + 1)];
    std::partial_sum(cell_first_.begin(), cell_first_.end(), cell_first_.begin());
    cell_grain_.resize(n);
    std::vector<int> next(cell_first_.begin(), cell_first_.end() - 1);
    for (int i = 0; i < grains_.n(); ++i) {
        slot_[i] = next[cell[i]]++;
        cell_grain_[slot_[i]] = i;
    }
    pair_first_.assign(n + 1, 0);
    pair_second_.clear();
    for (int i = 0; i < grains_.n(); ++i) {
        for_cells_around(grains_.region, n_cells_, cell[i], [&](int k) {
            for (int at = cell_first_[k]; at < cell_first_[k + 1]; ++at) {
                const int j = cell_grain_[at];
                if (j <= i) continue;
                const Shift d = shift_between(grains_, i, j);
                const double near = factor_ * (grains_.reach(i) + grains_.reach(j)) + skin_;
                if (d.x * d.x + d.y * d.y < near * near) pair_second_.push_back(j);
            }
        });
        pair_first_[i + 1] = static_cast<int>(pair_second_.size());
    }
    pair_x_ = grains_.x;
    pair_y_ = grains_.y;
    turn_corners(grains_, factor_, corners_);
}

void SoftGrains::add_force(int i, double nx, double ny, double x, double y) {
    fx_[i] += nx;
    fy_[i] += ny;
    torque_[i] += x * ny - y * nx;
}

void SoftGrains::compute_forces(double margin) {
    double farthest = 0.0;
    for (int i = 0; i < grains_.n(); ++i) {
        const double dx = grains_.x[i] - pair_x_[i], dy = grains_.y[i] - pair_y_[i];
        farthest = std::max(farthest, dx * dx + dy * dy);
    }
    if (farthest > 0.25 * skin_ * skin_)
        make_pairs();
    else if (turning_)
        turn_corners(grains_, factor_, corners_);
    std::fill(fx_.begin(), fx_.end(), 0.0);
    std::fill(fy_.begin(), fy_.end(), 0.0);
    std::fill(torque_.begin(), torque_.end(), 0.0);
    energy_ = deepest_ = force_sum_ = 0.0;
    n_contacts_ = 0;
    for (int i = 0; i < grains_.n(); ++i) {
        for (int at = pair_first_[i]; at < pair_first_[i + 1]; ++at) {
            const int j = pair_second_[at];
            const Contact contact = find_contact(grains_, factor_, corners_, i, j);
            if (contact.n == 0) continue;
            ++n_contacts_;
            const Shift d = shift_between(grains_, i, j);
            for (int k = 0; k < contact.n; ++k) {
                const ContactPoint& p = contact.point[k];
                energy_ += 0.5 * p.depth * p.depth;
                force_sum_ += p.depth;
                deepest_ = std::max(deepest_, p.depth / (factor_ * (inner(i) + inner(j))));
                add_force(j, p.depth * p.nx, p.depth * p.ny, p.x - d.x, p.y - d.y);
                add_force(i, -p.depth * p.nx, -p.depth * p.ny, p.x, p.y);
            }
        }
        for_each_edge_contact(grains_, factor_, margin * factor_ * inner(i), corners_, i,
                              [&](double depth, double nx, double ny, double x, double y) {
                                  energy_ += 0.5 * depth * depth;
                                  force_sum_ += depth;
                                  deepest_ = std::max(deepest_, depth / (factor_ * inner(i)));
                                  add_force(i, depth * nx, depth * ny, x, y);
                              });
    }
    force_left_ = 0.0;
    for (int i = 0; i < grains_.n(); ++i) force_left_ += std::sqrt(fx_[i] * fx_[i] + fy_[i] * fy_[i]);
}

SoftGrains::Rest SoftGrains::relax(int max_steps) {
    constexpr double largest_step = 0.35, first_mixing = 0.15;
    constexpr int patience = 5;
    double dt = 0.1, mixing = first_mixing;
    int n_downhill = 0;
    for (std::vector<double>* v : {&vx_, &vy_, &spin_}) std::fill(v->begin(), v->end(), 0.0);
    for (int step = 0; step < max_steps; ++step) {
        compute_forces(slack);
        if (deepest_ <= slack) return Rest::free;
        if (force_left_ < 1e-4 * force_sum_) return Rest::jammed;
        double power = 0.0, ff = 0.0, vv = 0.0;
        for (int i = 0; i < grains_.n(); ++i) {
            fx_[i] *= weight_[i];
            fy_[i] *= weight_[i];
            torque_[i] *= turn_weight_[i];
            power += fx_[i] * vx_[i] + fy_[i] * vy_[i] + torque_[i] * spin_[i];
            ff += fx_[i] * fx_[i] + fy_[i] * fy_[i] + torque_[i] * torque_[i];
            vv += vx_[i] * vx_[i] + vy_[i] * vy_[i] + spin_[i] * spin_[i];
        }
        if (power > 0.0) {
            if (++n_downhill > patience) {
                dt = std::min(1.1 * dt, largest_step);
                mixing *= 0.99;
            }
        } else {
            n_downhill = 0;
            dt = std::max(0.5 * dt, 0.02);
            mixing = first_mixing;
        }
        const double keep = power > 0.0 ? 1.0 - mixing : 0.0;
        const double turn = power > 0.0 && ff > 0.0 ? mixing * std::sqrt(vv / ff) : 0.0;
        for (int i = 0; i < grains_.n(); ++i) {
            vx_[i] = keep * vx_[i] + (turn + dt) * fx_[i];
            vy_[i] = keep * vy_[i] + (turn + dt) * fy_[i];
            grains_.x[i] += dt * weight_[i] * vx_[i];
            grains_.y[i] += dt * weight_[i] * vy_[i];
        }
        for (int i = 0; turning_ && i < grains_.n(); ++i) {
            spin_[i] = keep * spin_[i] + (turn + dt) * torque_[i];
            // A turn by t = tan(angle/2), rational in t and exact in length.
            const double t = 0.5 * dt * turn_weight_[i] * spin_[i], q = 1.0 / (1.0 + t * t);
            const double c = (1.0 - t * t) * q, s = 2.0 * t * q;
            const double cos = c * grains_.c[i] - s * grains_.s[i], sin = s * grains_.c[i] + c * grains_.s[i];
            const double length = std::sqrt(cos * cos + sin * sin);
            grains_.c[i] = cos / length;
            grains_.s[i] = sin / length;
        }
    }
    compute_forces(slack);
    return deepest_ <= slack ? Rest::free : Rest::unfinished;
}

double SoftGrains::pair_energy(int i, int j) const {
    const Contact contact = find_contact(grains_, factor_, corners_, std::min(i, j), std::max(i, j));
    double sum = 0.0;
    for (int k = 0; k < contact.n; ++k) sum += 0.5 * contact.point[k].depth * contact.point[k].depth;
    return sum;
}

double SoftGrains::energy_of(int i, int but) const {
    double sum = 0.0;
    for_cells_around(grains_.region, n_cells_, cell_of(i), [&](int cell) {
        for (int at = cell_first_[cell]; at < cell_first_[cell + 1]; ++at) {
            const int j = cell_grain_[at];
            if (j != i && j != but) sum += pair_energy(i, j);
        }
    });
    for_each_edge_contact(grains_, factor_, slack * factor_ * inner(i), corners_, i,
                          [&](double depth, double, double, double, double) { sum += 0.5 * depth * depth; });
    return sum;
}

int SoftGrains::exchange(portable::Random& random, double reach) {
    make_pairs();
    const int n = grains_.n(), span = std::max(1, static_cast<int>(reach * n));
    int n_done = 0;
    const auto swap_places = [this](int i, int j) {
        std::swap(grains_.x[i], grains_.x[j]);
        std::swap(grains_.y[i], grains_.y[j]);
        std::swap(cell_grain_[slot_[i]], cell_grain_[slot_[j]]);
        std::swap(slot_[i], slot_[j]);
    };
    for (int attempt = 0; attempt < n; ++attempt) {
        const int rank = random.below(n), other = rank + 1 + random.below(span);
        if (other >= n) continue;
        const int i = by_size_[rank], j = by_size_[other];
        const double before = energy_of(i, -1) + energy_of(j, i);
        if (before == 0.0) continue;
        swap_places(i, j);
        if (energy_of(i, -1) + energy_of(j, i) < before)
            ++n_done;
        else
            swap_places(i, j);
    }
    make_pairs();
    return n_done;
}

}  // namespace quern
