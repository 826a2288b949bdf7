#include "contact/node_pair_contact.hpp"

#include <algorithm>

#include "grid/parallel.hpp"

namespace quern {

template <int Dim>
typename NodePairContact<Dim>::Sums& NodePairContact<Dim>::Sums::operator+=(const Sums& other) {
    elastic += other.elastic;
    elastic_work += other.elastic_work;
    slip_loss += other.slip_loss;
    wall_work += other.wall_work;
    wall_dashpots += other.wall_dashpots;
    wall_friction += other.wall_friction;
    stable_step = std::min(stable_step, other.stable_step);
    n_ends += other.n_ends;
    n_slipped += other.n_slipped;
    return *this;
}

template <int Dim>
NodePairContact<Dim>::NodePairContact(const CartesianGrid<Dim>& grid, std::span<const Grain<Dim>> grains,
                                      std::span<const double> volume, std::vector<PairBody> bodies,
                                      const PairLaws& laws, const NodePairOptions& options)
    : law_(grains, volume, std::move(bodies), laws, options), list_(grid, law_) {
    if (options.damping == PairDamping::centres) centres_.emplace(grid, grains);
    std::vector<const Shape<Dim>*> shapes;
    for (const Grain<Dim>& grain : grains) {
        auto known = std::find(shapes.begin(), shapes.end(), grain.shape);
        if (known == shapes.end()) {
            patches_.emplace_back(*grain.shape);
            known = shapes.insert(shapes.end(), grain.shape);
        }
        patch_of_grain_.push_back(static_cast<int>(known - shapes.begin()));
    }
}

template <int Dim>
double NodePairContact<Dim>::stable_step() const {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t g = 0; g < patch_of_grain_.size(); ++g)
        least = std::min(least, law_.stable_step(static_cast<int>(g)));
    return least;
}

template <int Dim>
const ContactReport<Dim>& NodePairContact<Dim>::add_impulses(const ContactScene<Dim>& scene,
                                                             const ContactTrial<Dim>& trial) {
    report_.grain_impulse.assign(scene.grains.size(), Vec<Dim>::Zero());
    report_.wall_impulse.assign(scene.walls.size(), Vec<Dim>::Zero());
    report_.wall_moment.assign(scene.walls.size(), Spin<Dim>::Zero());
    const bool known = wall_velocity_before_.size() == scene.walls.size() && !trial.first;
    wall_velocity_before_.resize(scene.walls.size());
    if (!known)
        for (std::size_t w = 0; w < scene.walls.size(); ++w)
            wall_velocity_before_[w] = scene.walls[w].velocity;
    report_.searched = list_.update(scene);
    if (report_.searched) {
        const std::size_t n_rows = static_cast<std::size_t>(list_.n_rows());
        active_.assign(n_rows, 0);
        n_touching_.assign(n_rows, 0);
        push_.resize(n_rows);
        motion_.resize(n_rows);
        wall_first_.assign(1, 0);
        for (int row = 0; row < list_.n_rows(); ++row) {
            auto [e, last] = list_.entries_of(row);
            int n = 0;
            while (e < last && list_.partner(e) < 0) ++e, ++n;
            wall_first_.push_back(wall_first_.back() + n);
        }
        wall_push_.resize(static_cast<std::size_t>(wall_first_.back()));
    }
    rubs_ = n_slipped_ > 0 || scene.friction->any() ||
            std::any_of(scene.walls.begin(), scene.walls.end(),
                        [](const Wall<Dim>& wall) { return wall.friction > 0.0; });
    if (has_levers()) find_touching(scene, trial);
    listing_ = trial.listing;
    if (listing_) {
        const int last = list_.n_rows() - 1;
        received_.assign(static_cast<std::size_t>(last < 0 ? 0 : list_.entries_of(last).second),
                         Vec<Dim>::Zero());
    }
    sums_ = parallel::sum(list_.listed().size(), Sums{},
                          [&](std::size_t i) { return push_row(scene, trial, list_.listed()[i]); });
    apply(scene, trial);
    if (centres_) centres_->add_impulses(scene, trial, kick_time(trial), law_, list_, report_);
    book_losses(scene, trial);
    report_.elastic = sums_.elastic;
    report_.elastic_work = sums_.elastic_work;
    report_.slip_loss = sums_.slip_loss;
    report_.stable_step = sums_.stable_step;
    report_.n_nodes = list_.n_rows();
    report_.n_contacts = sums_.n_ends / 2;
    n_slipped_ = sums_.n_slipped;
    for (std::size_t w = 0; w < scene.walls.size(); ++w) wall_velocity_before_[w] = scene.walls[w].velocity;
    return report_;
}

/// Which nodes touch anything, in how many places, and how the grain turns around them.
template <int Dim>
void NodePairContact<Dim>::find_touching(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial) {
    parallel::for_each(
        list_.listed().size(),
        [&](std::size_t i) {
            const int row = list_.listed()[i], p = list_.particle(row);
            const std::pair<int, int> entries = list_.entries_of(row);
            int n = 0;
            for (int e = entries.first; e < entries.second; ++e) {
                const int q = list_.partner(e);
                const double R = list_.radius(e);
                n += q < 0 ? 2.0 * scene.walls[-1 - q].distance(scene.x[p]) < R
                           : list_.nearest()(scene.x[p], scene.x[q]).squaredNorm() < R * R;
            }
            n_touching_[row] = n;
            if (n == 0) return;
            const Grain<Dim>& grain = scene.grains[list_.grain(row)];
            motion_[row] = patch_motion<Dim>(grain, patch_of(scene, row), p - grain.first, scene.x,
                                             trial.v_before, scene.mass);
        },
        256);
}

template <int Dim>
typename NodePairContact<Dim>::Sums NodePairContact<Dim>::push_row(const ContactScene<Dim>& scene,
                                                                   const ContactTrial<Dim>& trial, int row) {
    Sums sums;
    const std::pair<int, int> entries = list_.entries_of(row);
    active_[row] = 0;
    const int p = list_.particle(row), n_walls = wall_first_[row + 1] - wall_first_[row];
    push_[row] = {};
    double squared = 0.0, damped = 0.0;
    for (int e = entries.first; e < entries.first + n_walls; ++e)
        push_from_wall(scene, trial, row, e, sums, squared, damped);
    thread_local std::vector<Touch> touching;
    touching.clear();
    for (int e = entries.first + n_walls; e < entries.second; ++e) {
        const Vec<Dim> r = list_.nearest()(scene.x[p], scene.x[list_.partner(e)]);
        const double R = list_.radius(e), squared_distance = r.squaredNorm();
        if (squared_distance < R * R && squared_distance > 0.0)
            touching.push_back({e, std::sqrt(squared_distance), r});
        else
            let_go(e, law_.tangential_ratio() * list_.stiffness(e), 0.5, sums);
    }
    // By where the partners are, not by their numbers. Two terms already: a fused product and sum is rounded
    // once.
    if (touching.size() > 1)
        std::sort(touching.begin(), touching.end(), [](const Touch& a, const Touch& b) {
            if (a.d != b.d) return a.d < b.d;
            return std::lexicographical_compare(a.r.data(), a.r.data() + Dim, b.r.data(), b.r.data() + Dim);
        });
    for (const Touch& touch : touching) {
        if (listing_) received_[touch.entry] = -push_[row].J;
        push_from_node(scene, trial, row, touch, sums, squared, damped);
        if (listing_) received_[touch.entry] += push_[row].J;
    }
    if (report_.searched && active_[row])
        sums.stable_step = law_.step_with(list_.grain(row), squared, damped);
    return sums;
}

template <int Dim>
void NodePairContact<Dim>::push_from_wall(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial,
                                          int row, int entry, Sums& sums, double& squared, double& damped) {
    const int p = list_.particle(row), g = list_.grain(row), w = -1 - list_.partner(entry);
    const Wall<Dim>& wall = scene.walls[w];
    WallPush& on_wall =
        wall_push_[static_cast<std::size_t>(wall_first_[row] + entry - list_.entries_of(row).first)];
    on_wall = {w, Vec<Dim>::Zero(), Spin<Dim>::Zero()};
    const double y = wall.distance(scene.x[p]), over = list_.radius(entry) - 2.0 * y;
    const double k = list_.stiffness(entry), m = scene.mass[p], k_t = 2.0 * law_.tangential_ratio() * k;
    if (over <= 0.0) {
        let_go(entry, k_t, 1.0, sums);
        return;
    }
    active_[row] = 1;
    sums.n_ends += 2;
    const double kick = kick_time(trial);
    const Vec<Dim>& n = wall.normal;
    const Vec<Dim> v = trial.v_before[p] - wall_velocity_before_[w];
    const double z = law_.damping_ratio(g, g), c = 2.0 * std::sqrt(0.5 * k * m);
    const double spring = k * over, approach = -n.dot(trial.v_before[p] - wall.velocity);
    const double dashpot = approach > 0.0 ? z * c * 2.0 * approach : 0.0;
    Push push;
    push.dashpots = kick * dashpot * n;
    push.J = kick * spring * n + push.dashpots;
    sums.elastic += 0.25 * k * over * over;
    sums.elastic_work += kick * spring * n.dot(v);
    squared += 2.0 * k / m;
    damped += 2.0 * std::max(z, law_.options().tangential_damping) * c / m;
    if (rubs_) {
        Surface surface{n, v,  trial.v[p] - wall.velocity, -y * n, spring + dashpot, k_t, 0.0, wall.friction,
                        m, 1.0};
        surface.c_t = 2.0 * law_.options().tangential_damping * std::sqrt(k_t * m);
        if (has_levers()) {
            const Vec<Dim> turning = cross(motion_[row].omega, surface.lever);
            surface.before += turning;
            surface.now += turning;
            surface.slip_mass /= n_touching_[row];
        }
        rub(trial, surface, entry, push, sums);
    }
    on_wall.J = -push.J;
    on_wall.moment = -moment(scene.x[p], push.J) - push.moment;
    sums.wall_work += 0.5 * push.J.dot(wall_velocity_before_[w] + wall.velocity);
    sums.wall_dashpots += push.dashpots.dot(wall.velocity);
    sums.wall_friction += push.friction.dot(wall.velocity);
    Push& all = push_[row];
    all.J += push.J;
    all.dashpots += push.dashpots;
    all.friction += push.friction;
    all.moment += push.moment;
    all.lossy_moment += push.lossy_moment;
}

template <int Dim>
void NodePairContact<Dim>::push_from_node(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial,
                                          int row, const Touch& touch, Sums& sums, double& squared,
                                          double& damped) {
    const int p = list_.particle(row), q = list_.partner(touch.entry);
    const int other = list_.row_of(q), g = list_.grain(row), h = list_.grain(other);
    active_[row] = 1;
    ++sums.n_ends;
    const double kick = kick_time(trial), k = list_.stiffness(touch.entry);
    const double over = list_.radius(touch.entry) - touch.d;
    const double m = scene.mass[p], m_other = scene.mass[q], reduced = m * m_other / (m + m_other);
    const Vec<Dim> n = -touch.r / touch.d;
    const Vec<Dim> v = trial.v_before[p] - trial.v_before[q];
    const double z = g == h ? 0.0 : law_.damping_ratio(g, h), c = 2.0 * std::sqrt(k * reduced);
    const double spring = k * over, approach = -n.dot(v);
    const double dashpot = approach > 0.0 ? z * c * approach : 0.0;
    Push& push = push_[row];
    push.dashpots += kick * dashpot * n;
    push.J += kick * (spring + dashpot) * n;
    sums.elastic += 0.25 * k * over * over;
    sums.elastic_work += 0.5 * kick * spring * n.dot(v);
    squared += 2.0 * k / m;
    damped += 2.0 * std::max(z, law_.options().tangential_damping) * c / m;
    if (!rubs_ || g == h) return;
    const double mu = (*scene.friction)(scene.grains[g].material, scene.grains[h].material);
    const double k_t = law_.tangential_ratio() * k;
    Surface surface{n,       v,  trial.v[p] - trial.v[q], Vec<Dim>::Zero(), spring + dashpot, k_t, 0.0, mu,
                    reduced, 0.5};
    surface.c_t = 2.0 * law_.options().tangential_damping * std::sqrt(k_t * reduced);
    if (has_levers()) {
        const double r = law_.node_radius(p), r_other = law_.node_radius(q);
        surface.lever = r / (r + r_other) * touch.r;
        const Vec<Dim> lever_of_other = -(r_other / (r + r_other)) * touch.r;
        const Vec<Dim> own = cross(motion_[row].omega, surface.lever);
        const Vec<Dim> its = cross(motion_[other].omega, lever_of_other);
        surface.before += own - its;
        surface.now += own - its;
        surface.slip_mass = 1.0 / (n_touching_[row] / m + n_touching_[other] / m_other);
    }
    rub(trial, surface, touch.entry, push, sums);
}

template <int Dim>
void NodePairContact<Dim>::rub(const ContactTrial<Dim>& trial, const Surface& s, int entry, Push& push,
                               Sums& sums) {
    const double kick = kick_time(trial), most = s.mu * s.F_n;
    const auto along = [&](const Vec<Dim>& u) { return Vec<Dim>(u - s.n * s.n.dot(u)); };
    Vec<Dim> lossy = Vec<Dim>::Zero(), kept = Vec<Dim>::Zero();
    if (law_.options().friction_law == PairFriction::history) {
        Vec<Dim>& slip = list_.slip(entry);
        const Vec<Dim> u = along(s.before);
        Vec<Dim> before = along(slip);
        if (const double length = before.norm(); length > 0.0) before *= slip.norm() / length;
        const Vec<Dim> reached = before + (trial.first ? 0.0 : trial.dt) * u;
        const double length = reached.norm(), limit = most / s.k_t;
        slip = length > limit ? Vec<Dim>(reached * (limit / length)) : reached;
        sums.slip_loss += s.share * 0.5 * s.k_t * (before + slip).dot(reached - slip);
        sums.elastic += s.share * 0.5 * s.k_t * slip.squaredNorm();
        sums.n_slipped += slip.isZero(0.0) ? 0 : 1;
        kept = -kick * s.k_t * slip;
        sums.elastic_work += s.share * kept.dot(u);
        if (length <= limit && (kept - kick * s.c_t * u).norm() <= kick * most) lossy = -kick * s.c_t * u;
    } else if (law_.options().friction_law == PairFriction::slip) {
        const Vec<Dim> u = along(s.now);
        const double speed = u.norm();
        if (speed > 0.0) lossy = -std::min(kick * most, s.slip_mass * speed) / speed * u;
    } else {
        const Vec<Dim> u = along(s.before);
        const double speed = u.norm();
        if (speed > 0.0) lossy = kick * most / speed * u;
    }
    push.J += kept + lossy;
    push.friction += lossy;
    if (!has_levers()) return;
    push.moment += moment(s.lever, Vec<Dim>(kept + lossy));
    push.lossy_moment += moment(s.lever, lossy);
}

/// A contact that has opened loses what its tangential spring held.
template <int Dim>
void NodePairContact<Dim>::let_go(int entry, double k_t, double share, Sums& sums) {
    if (!rubs_ || !list_.keeps_slip()) return;
    Vec<Dim>& slip = list_.slip(entry);
    if (slip.isZero(0.0)) return;
    sums.slip_loss += share * 0.5 * k_t * slip.squaredNorm();
    slip.setZero();
}

template <int Dim>
void NodePairContact<Dim>::apply(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial) {
    parallel::for_each(
        scene.grains.size(),
        [&](std::size_t g) {
            const Grain<Dim>& grain = scene.grains[g];
            const std::pair<int, int> rows = list_.listed_of(static_cast<int>(g));
            for (int k = rows.first; k < rows.second; ++k) {
                const int row = list_.listed()[k];
                if (!active_[row]) continue;
                const int p = list_.particle(row);
                const Push& push = push_[row];
                trial.v[p] += push.J / scene.mass[p];
                report_.grain_impulse[g] += push.J;
                if (!push.moment.isZero(0.0))
                    turn_patch<Dim>(motion_[row], push.moment, grain, patch_of(scene, row), p - grain.first,
                                    scene.x, trial.v);
            }
        },
        16);
    for (const WallPush& push : wall_push_) {
        report_.wall_impulse[push.wall] += push.J;
        report_.wall_moment[push.wall] += push.moment;
    }
}

/// What dashpots and friction without a spring took, with the velocities before and after.
template <int Dim>
void NodePairContact<Dim>::book_losses(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial) {
    struct Losses {
        double normal = 0.0, friction = 0.0;
        Losses& operator+=(const Losses& other) {
            normal += other.normal;
            friction += other.friction;
            return *this;
        }
    };
    const Losses losses = parallel::sum(list_.listed().size(), Losses{}, [&](std::size_t i) {
        Losses loss;
        const int row = list_.listed()[i], p = list_.particle(row);
        if (!active_[row]) return loss;
        const Push& push = push_[row];
        const Vec<Dim> twice = trial.v_before[p] + trial.v[p];
        loss.normal = 0.5 * push.dashpots.dot(twice);
        loss.friction = 0.5 * push.friction.dot(twice);
        if (!push.lossy_moment.isZero(0.0)) {
            const Grain<Dim>& grain = scene.grains[list_.grain(row)];
            const Spin<Dim> after = patch_spin<Dim>(motion_[row], grain, patch_of(scene, row),
                                                    p - grain.first, scene.x, trial.v, scene.mass);
            loss.friction += 0.5 * push.lossy_moment.dot(motion_[row].omega + after);
        }
        return loss;
    });
    report_.normal_work = losses.normal - sums_.wall_dashpots;
    report_.friction_work = losses.friction - sums_.wall_friction;
    report_.wall_work = sums_.wall_work;
    if (centres_) centres_->book_losses(scene, trial, report_);
}

template <int Dim>
void NodePairContact<Dim>::list_contacts(const ContactScene<Dim>& scene,
                                         std::vector<ContactPoint<Dim>>& points) const {
    for (const int row : list_.listed()) {
        if (!active_[row]) continue;
        const auto [first, last] = list_.entries_of(row);
        const int p = list_.particle(row), g = list_.grain(row),
                  n_walls = wall_first_[row + 1] - wall_first_[row];
        for (int e = first; e < last; ++e) {
            ContactPoint<Dim> point;
            point.first = g;
            double mu = 0.0;
            if (e < first + n_walls) {
                const WallPush& push = wall_push_[static_cast<std::size_t>(wall_first_[row] + e - first)];
                const Wall<Dim>& wall = scene.walls[push.wall];
                if (push.J.isZero(0.0)) continue;
                point.second = -1 - push.wall;
                point.at_first = point.at_second = scene.x[p] - wall.distance(scene.x[p]) * wall.normal;
                point.normal = -wall.normal;
                point.impulse = push.J;
                mu = wall.friction;
            } else {
                const int q = list_.partner(e), h = list_.grain(list_.row_of(q));
                if (q < p || g == h || received_[e].isZero(0.0)) continue;
                const Vec<Dim> r = list_.nearest()(scene.x[p], scene.x[q]);
                const double part = law_.node_radius(p) / (law_.node_radius(p) + law_.node_radius(q));
                point.second = h;
                point.at_first = scene.x[p] + part * r;
                point.at_second = scene.x[q] - (1.0 - part) * r;
                point.normal = r.normalized();
                point.impulse = -received_[e];
                mu = (*scene.friction)(scene.grains[g].material, scene.grains[h].material);
            }
            point.slips = at_friction_limit<Dim>(point.impulse, point.normal, mu);
            points.push_back(point);
        }
    }
}

template <int Dim>
PairMemory<Dim> NodePairContact<Dim>::memory() const {
    PairMemory<Dim> memory;
    list_.save(memory);
    memory.wall_velocity = wall_velocity_before_;
    return memory;
}

template <int Dim>
void NodePairContact<Dim>::recall(const PairMemory<Dim>& memory, std::size_t n_particles) {
    list_.recall(memory, n_particles);
    wall_velocity_before_ = memory.wall_velocity;
    n_slipped_ = static_cast<std::int64_t>(memory.slip.size());
}

template class NodePairContact<2>;
template class NodePairContact<3>;

}  // namespace quern
