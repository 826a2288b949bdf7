#include "contact/loose_contact.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "grid/parallel.hpp"

namespace quern {

namespace {

/// Of the largest ball of debris, how much further than touching a search looks.
constexpr double skin = 3.0;
/// No contact makes a particle approach another this many times faster than anything moved before.
constexpr double faster_than_fastest = 4.0;
/// Contact may make a body this much faster than what moves without it.
constexpr double faster_by_contact = 2.0;
/// Fewer pairs stay on one thread, fewer rows are one island: finding islands would cost more than it saves.
constexpr std::size_t few = 1024;
constexpr std::size_t block = 256;

}  // namespace

template <int Dim>
void LooseContact<Dim>::search(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene) {
    near_.clear();
    if (!searched_) {
        radius_.clear();
        for (const double volume : scene.volume) radius_.push_back(0.5 * std::pow(volume, 1.0 / Dim));
    }
    searched_ = true;
    if (bodies.debris().empty() && bodies.in_pieces().empty()) {
        search_at_ = std::numeric_limits<double>::infinity();
        return;
    }
    double of_debris = 0.0, of_all = 0.0;
    for (const LooseParticle& loose : bodies.debris())
        of_debris = std::max(of_debris, radius_[loose.particle]);
    for (const double radius : radius_) of_all = std::max(of_all, radius);
    const double margin = skin * (bodies.debris().empty() ? of_all : of_debris);
    const int n_bodies = static_cast<int>(scene.grains.size());
    if (!bodies.debris().empty()) cells_.sort(scene.x, of_debris + of_all + margin, &grid_);
    for (const LooseParticle& loose : bodies.debris()) {
        const int p = loose.particle;
        cells_.visit_near(scene.x[p], [&](int q) {
            const int other = bodies.body_of(q);
            if (other == loose.body || (other >= n_bodies && q < p)) return;
            const double range = radius_[p] + radius_[q];
            const double far = range + margin;
            if (nearest_(scene.x[p], scene.x[q]).squaredNorm() < far * far) near_.push_back({p, q, range});
        });
    }
    std::sort(near_.begin(), near_.end(), [](const CrackPair& a, const CrackPair& b) {
        return std::pair(a.first, a.second) < std::pair(b.first, b.second);
    });
    if (!bodies.debris().empty()) friction_.search(bodies, scene, near_);
    const auto add_walls = [&](int p, double range) {
        for (std::size_t w = 0; w < scene.walls.size(); ++w)
            if (scene.walls[w].distance(scene.x[p]) < range + margin)
                near_.push_back({p, -1 - static_cast<int>(w), range});
    };
    for (const LooseParticle& loose : bodies.debris()) add_walls(loose.particle, radius_[loose.particle]);
    for (const int p : bodies.in_pieces()) add_walls(p, 0.0);
    search_at_ = scene.travelled + 0.5 * margin;
}

/// Whether the two can touch in this step.
template <int Dim>
bool LooseContact<Dim>::make_row(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial,
                                 const CrackPair& near, Row& row) const {
    const int p = near.first, q = near.second;
    const double range = near.range, reach = faster_than_fastest * trial.largest_speed * trial.dt;
    double gap = -range;
    if (q >= 0) {
        const Vec<Dim> d = nearest_(scene.x[p], scene.x[q]);
        const double squared = d.squaredNorm();
        if (!(squared > 0.0) || squared > (range + reach) * (range + reach)) return false;
        const double distance = std::sqrt(squared);
        row.n = d / distance;
        row.mass = scene.mass[p] * scene.mass[q] / (scene.mass[p] + scene.mass[q]);
        gap += distance;
    } else {
        const Wall<Dim>& wall = scene.walls[-1 - q];
        row.n = wall.normal;
        row.mass = scene.mass[p];
        gap += wall.distance(scene.x[p]);
    }
    if (gap > reach) return false;
    row.p = p;
    row.q = q;
    row.gap_speed = std::max(gap, 0.0) / trial.dt;
    row.J = 0.0;
    row.J_t.setZero();
    row.rub = -1;
    return true;
}

template <int Dim>
void LooseContact<Dim>::find(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene,
                             const ContactTrial<Dim>& trial) {
    const double ahead = faster_by_contact * trial.dt * trial.largest_speed;
    if (!searched_ || !(scene.travelled + ahead < search_at_)) search(bodies, scene);
    const std::size_t n_cracks = bodies.cracks().size(), n = n_cracks + near_.size();
    found_.resize(n);
    parallel::for_each((n + block - 1) / block,
                       [&](std::size_t b) {
                           for (std::size_t k = b * block, end = std::min(n, k + block); k < end; ++k) {
                               const CrackPair& near =
                                   k < n_cracks ? bodies.cracks()[k] : near_[k - n_cracks];
                               if (!make_row(scene, trial, near, found_[k])) found_[k].mass = 0.0;
                           }
                       },
                       few / block);
    rows_.clear();
    touched_.clear();
    friction_.clear();
    for (std::size_t k = 0; k < n; ++k) {
        Row& row = found_[k];
        if (row.mass == 0.0) continue;
        if (row.q >= 0 && k >= n_cracks)
            row.rub = friction_.add(bodies, scene, row.p, row.q, nearest_(scene.x[row.p], scene.x[row.q]),
                                    radius_[row.p], radius_[row.q]);
        rows_.push_back(row);
        for_each_moved(row, [&](int p) { touched_.push_back(p); });
    }
    std::sort(touched_.begin(), touched_.end());
    touched_.erase(std::unique(touched_.begin(), touched_.end()), touched_.end());
    v_trial_.clear();
    for (const int p : touched_) v_trial_.push_back(trial.v[p]);
    make_islands(scene.x.size());
}

/// Islands in the order of their first rows, rows in theirs.
template <int Dim>
void LooseContact<Dim>::make_islands(std::size_t n_particles) {
    islands_.clear();
    in_islands_.resize(rows_.size());
    if (rows_.size() < few) {
        std::iota(in_islands_.begin(), in_islands_.end(), 0);
        if (!rows_.empty()) islands_.push_back({0, static_cast<int>(rows_.size())});
        return;
    }
    root_.resize(n_particles);
    for (const int p : touched_) root_[p] = p;
    const auto root = [&](int p) {
        while (root_[p] != p) p = root_[p] = root_[root_[p]];
        return p;
    };
    for (const Row& row : rows_)
        for_each_moved(row, [&](int p) {
            const int r = root(row.p), s = root(p);
            root_[std::max(r, s)] = std::min(r, s);
        });
    island_of_.assign(n_particles, -1);
    for (const Row& row : rows_) {
        int& island = island_of_[root(row.p)];
        if (island < 0) {
            island = static_cast<int>(islands_.size());
            islands_.push_back({0, 0});
        }
        ++islands_[island].last;
    }
    int first = 0;
    for (Island& island : islands_) {
        const int count = island.last;
        island.first = island.last = first;
        first += count;
    }
    for (std::size_t k = 0; k < rows_.size(); ++k)
        in_islands_[islands_[island_of_[root(rows_[k].p)]].last++] = static_cast<int>(k);
}

/// Returns by how much the impulse of a row has changed.
template <int Dim>
double LooseContact<Dim>::update(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial,
                                 Row& row) const {
    const auto give = [&](int p, const Vec<Dim>& J) {
        const Vec<Dim> dv = J / scene.mass[p];
        trial.v[p] += dv;
        if (!trial.drift.empty()) trial.drift[p] += dv;
    };
    // What moves with the grid approaches with the velocity of the grid.
    const std::span<Vec<Dim>> moving = trial.drift.empty() ? trial.v : trial.drift;
    if (row.q >= 0) {
        const double approach = row.n.dot(moving[row.p] - moving[row.q]) - row.gap_speed;
        const double J = std::max(0.0, row.J + row.mass * approach), change = J - row.J;
        row.J = J;
        if (change != 0.0) {
            give(row.p, -change * row.n);
            give(row.q, change * row.n);
        }
        if (row.rub < 0) return std::abs(change);
        const Vec<Dim> u = friction_.slip(row.rub, scene, moving);
        const Vec<Dim> asked = row.J_t + (u - row.n.dot(u) * row.n) / friction_.inverse_mass(row.rub);
        const double size = asked.norm(), most = friction_.friction(row.rub) * J;
        const Vec<Dim> J_t = size > most ? Vec<Dim>(most / size * asked) : asked, given = J_t - row.J_t;
        row.J_t = J_t;
        if (given.isZero(0.0)) return std::abs(change);
        friction_.push(row.rub, scene, given, trial.v);
        if (!trial.drift.empty()) friction_.push(row.rub, scene, given, trial.drift);
        return std::abs(change) + given.norm();
    }
    const Wall<Dim>& wall = scene.walls[-1 - row.q];
    const Vec<Dim> u = moving[row.p] - wall.velocity;
    const double J = std::max(0.0, row.J - row.mass * (row.n.dot(u) + row.gap_speed)), change = J - row.J;
    Vec<Dim> J_t = row.J_t - row.mass * (u - row.n.dot(u) * row.n);
    const double size = J_t.norm(), most = wall.friction * J;
    if (size > most) J_t *= most / size;
    const Vec<Dim> given = change * row.n + J_t - row.J_t;
    row.J = J;
    row.J_t = J_t;
    if (!given.isZero(0.0)) give(row.p, given);
    return given.norm();
}

/// Works add up to the change of kinetic energy only with the velocities after all of contact: what the rule
/// of the grid has booked for a particle is completed to (m/2) (v - v*).(v_before + v), v* before contact.
template <int Dim>
void LooseContact<Dim>::book(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene,
                             const ContactTrial<Dim>& trial, ContactReport<Dim>& report) const {
    double work = 0.0, by_walls = 0.0, by_friction = 0.0;
    for (std::size_t k = 0; k < touched_.size(); ++k) {
        const int p = touched_[k];
        const Vec<Dim>&before = trial.v_before[p], &star = v_trial_[k];
        const auto done = [&](const Vec<Dim>& v) { return (v - star).dot(before + v); };
        work += 0.5 * scene.mass[p] * (done(trial.v[p]) - done(v_after_grid_[k]));
    }
    for (const Row& row : rows_) {
        if (row.J == 0.0) continue;
        ++report.n_contacts;
        if (row.q >= 0) {
            const Vec<Dim> J = row.J * row.n + row.J_t;
            report.grain_impulse[bodies.grain_of(bodies.body_of(row.p))] -= J;
            report.grain_impulse[bodies.grain_of(bodies.body_of(row.q))] += J;
            if (row.rub >= 0)
                by_friction -= 0.5 * row.J_t.dot(friction_.slip(row.rub, scene, trial.v_before) +
                                                 friction_.slip(row.rub, scene, trial.v));
            continue;
        }
        const std::size_t w = static_cast<std::size_t>(-1 - row.q);
        const Vec<Dim> J = row.J * row.n + row.J_t, u = scene.walls[w].velocity;
        report.grain_impulse[bodies.grain_of(bodies.body_of(row.p))] += J;
        report.wall_impulse[w] -= J;
        report.wall_moment[w] -= moment(scene.x[row.p], J);
        by_walls += J.dot(u);
        by_friction += row.J_t.dot(0.5 * (trial.v_before[row.p] + trial.v[row.p]) - u);
    }
    report.wall_work += by_walls;
    report.friction_work += by_friction;
    report.normal_work += work - by_walls - by_friction;
}

template <int Dim>
void LooseContact<Dim>::sweep(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial, bool forwards,
                              Island& island) {
    island.change = island.total = 0.0;
    for (int k = 0, n = island.last - island.first; k < n; ++k) {
        Row& row = rows_[in_islands_[forwards ? island.first + k : island.last - 1 - k]];
        island.change += update(scene, trial, row);
        island.total += row.J;
    }
}

template <int Dim>
void LooseContact<Dim>::add_impulses(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene,
                                     const ContactTrial<Dim>& trial, ContactReport<Dim>& report) {
    v_after_grid_.clear();
    for (const int p : touched_) v_after_grid_.push_back(trial.v[p]);
    bool converged = rows_.empty();
    for (int k = 0; k < options_.max_sweeps && !converged; ++k) {
        parallel::for_each(islands_.size(),
                           [&](std::size_t i) { sweep(scene, trial, k % 2 == 0, islands_[i]); });
        double change = 0.0, total = 0.0;
        for (const Island& island : islands_) {
            change += island.change;
            total += island.total;
        }
        converged = change <= options_.tolerance * total;
    }
    report.converged = report.converged && converged;
    book(bodies, scene, trial, report);
}

template <int Dim>
void LooseContact<Dim>::list_contacts(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene,
                                      std::vector<ContactPoint<Dim>>& points) const {
    for (const Row& row : rows_) {
        if (row.J == 0.0) continue;
        ContactPoint<Dim> point;
        point.first = bodies.body_of(row.p);
        const Vec<Dim>& x = scene.x[row.p];
        if (row.q >= 0) {
            const Vec<Dim> d = nearest_(x, scene.x[row.q]);
            const double part = radius_[row.p] / (radius_[row.p] + radius_[row.q]);
            point.second = bodies.body_of(row.q);
            point.at_first = x + part * d;
            point.at_second = scene.x[row.q] - (1.0 - part) * d;
            point.normal = row.n;
            point.impulse = row.J * row.n + row.J_t;
            point.slips = true;
            if (row.rub >= 0) {
                point.at_first = x + friction_.lever_p(row.rub);
                point.at_second = scene.x[row.q] + friction_.lever_q(row.rub);
                point.slips =
                    at_friction_limit<Dim>(point.impulse, point.normal, friction_.friction(row.rub));
            }
        } else {
            const Wall<Dim>& wall = scene.walls[-1 - row.q];
            point.second = row.q;
            point.at_first = point.at_second = x - wall.distance(x) * row.n;
            point.normal = -row.n;
            point.impulse = -(row.J * row.n + row.J_t);
            point.slips = at_friction_limit<Dim>(point.impulse, point.normal, wall.friction);
        }
        points.push_back(point);
    }
}

template class LooseContact<2>;
template class LooseContact<3>;

}  // namespace quern
