#include "contact/pair_rule.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>

#include "contact/slot_field.hpp"
#include "grid/parallel.hpp"

namespace quern {

namespace {

constexpr std::size_t serial_below = 64;  ///< contact nodes of one colour
/// No contact makes a grain approach another this many times faster than anything moved before.
constexpr double faster_than_fastest = 10.0;
constexpr double wall_in_sight = 2.0;  ///< a wall further from a node has no tile there [h]

/// Largest eigenvalue of T^T W T, the inverse mass in the tangent plane.
double tangential(const Mat<2>& W, const Eigen::Matrix<double, 2, 1>& T) {
    return T.dot(W * T);
}
double tangential(const Mat<3>& W, const Eigen::Matrix<double, 3, 2>& T) {
    const Mat<2> A = T.transpose() * W * T;
    const double mean = 0.5 * (A(0, 0) + A(1, 1)), half = 0.5 * (A(0, 0) - A(1, 1));
    const double off = 0.5 * (A(0, 1) + A(1, 0));  // equal but for rounding, which must not reach the root
    return mean + std::sqrt(half * half + off * off);
}

template <int Dim>
struct Work {
    double normal = 0.0, friction = 0.0, wall = 0.0;
    Work& operator+=(const Work& other) {
        normal += other.normal;
        friction += other.friction;
        wall += other.wall;
        return *this;
    }
};

/// Of particles and walls [m/s].
template <int Dim>
double largest_speed(const ContactScene<Dim>& scene, std::span<Vec<Dim>> v) {
    struct Largest {
        double square = 0.0;
        Largest& operator+=(const Largest& other) {
            square = std::max(square, other.square);
            return *this;
        }
    };
    const double square =
        parallel::sum(v.size(), Largest{}, [&](std::size_t p) { return Largest{v[p].squaredNorm()}; }).square;
    double wall = 0.0;
    for (const Wall<Dim>& w : scene.walls) wall = std::max(wall, w.velocity.norm());
    return std::sqrt(square) + wall;
}

}  // namespace

template <int Dim>
void PairRule<Dim>::add_row(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt, int a, int b,
                            int wall, std::vector<PairRow<Dim>>& rows) const {
    const double h = nodes.grid().h();
    const Slot<Dim>& A = nodes.slots()[a];
    const Grain<Dim>& grain_a = scene.grains[A.grain];
    const TileSide<Dim> side_a{&A, &grain_a, &rotation_[A.grain]};
    PairRow<Dim> row;
    row.a = a;
    std::optional<Tile<Dim>> tile;
    if (wall >= 0) {
        const Wall<Dim>& plane = scene.walls[wall];
        tile = make_wall_tile<Dim>(side_a, plane, plane.distance(nodes.grid().node_position(A.index)), h,
                                   options_);
        row.wall = wall;
        row.u_wall = plane.velocity;
        row.mu = plane.friction;
    } else {
        const Slot<Dim>& B = nodes.slots()[b];
        const Grain<Dim>& grain_b = scene.grains[B.grain];
        tile = make_tile<Dim>(side_a, {&B, &grain_b, &rotation_[B.grain]}, h, options_);
        row.b = b;
        row.mu = (*scene.friction)(grain_a.material, grain_b.material);
    }
    if (!tile) return;
    row.gap_speed = options_.gap_test ? std::max(tile->gap, 0.0) / dt : 0.0;
    if (row.gap_speed > reachable_speed_) return;  // the row would stay without impulse
    row.n = tile->normal;
    row.point = tile->point;
    if (options_.coupling == GridCoupling::impulse) {
        // A patch that cannot turn takes its impulse at its centre; there both grains must meet.
        if (!A.rotates)
            row.point = A.xb;
        else if (b >= 0 && !nodes.slots()[b].rotates)
            row.point = nodes.slots()[b].xb;
        row.r_a = row.point - A.xb;
        row.W = inverse_mass<Dim>(A, row.r_a, options_.exact_mass);
        if (b >= 0) {
            row.r_b = row.point - nodes.slots()[b].xb;
            row.W += inverse_mass<Dim>(nodes.slots()[b], row.r_b, options_.exact_mass);
        }
    } else {
        row.r_a.setZero();
        row.r_b.setZero();
        row.W = Mat<Dim>::Identity() * (1.0 / A.m + (b >= 0 ? 1.0 / nodes.slots()[b].m : 0.0));
    }
    row.W_n = row.n.dot(row.W * row.n);
    row.W_t = tangential(row.W, tangents<Dim>(row.n));
    rows.push_back(row);
}

template <int Dim>
bool PairRule<Dim>::may_touch(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                              int node) const {
    const double h = nodes.grid().h(), skin = nodes.skin();
    const std::span<const int> slots = nodes.slots_of(node);
    const auto side = [&](int s) {
        const Slot<Dim>& slot = nodes.slots()[s];
        return TileSide<Dim>{&slot, &scene.grains[slot.grain], &rotation_[slot.grain]};
    };
    for (std::size_t k = 0; k < slots.size(); ++k) {
        for (std::size_t l = k + 1; l < slots.size(); ++l)
            if (!stay_apart(side(slots[k]), side(slots[l]), h, skin, options_)) return true;
        const Vec<Dim> x = nodes.grid().node_position(nodes.slots()[slots[k]].index);
        for (const Wall<Dim>& wall : scene.walls)
            if (std::abs(wall.distance(x)) <= wall_in_sight * h &&
                !stay_apart(side(slots[k]), wall, wall.distance(x), h, skin, options_))
                return true;
    }
    return false;
}

template <int Dim>
void PairRule<Dim>::make_rows(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt) {
    rotation_.resize(scene.grains.size());
    parallel::for_each(scene.grains.size(), [&](std::size_t g) {
        const auto [first, last] = nodes.slots_of_grain(static_cast<int>(g));
        for (int s = first; s < last && options_.coupling == GridCoupling::impulse && !options_.rotation; ++s)
            nodes.slots()[s].rotates = false;
        if (first < last) rotation_[g] = best_fit_rotation<Dim>(scene.grains[g], scene.x, scene.mass);
    });
    if (nodes.searched() && nodes.skin() > 0.0) {
        wanted_.resize(static_cast<std::size_t>(nodes.n_nodes()));
        parallel::for_each(wanted_.size(),
                           [&](std::size_t i) { wanted_[i] = may_touch(nodes, scene, static_cast<int>(i)); });
        nodes.keep_only(wanted_);
    }
    const std::size_t n_nodes = static_cast<std::size_t>(nodes.n_nodes());
    if (rows_.size() < n_nodes) rows_.resize(n_nodes);
    parallel::for_each(
        n_nodes,
        [&](std::size_t i) {
            std::vector<PairRow<Dim>>& rows = rows_[i];
            rows.clear();
            const std::span<const int> slots = nodes.slots_of(static_cast<int>(i));
            for (std::size_t k = 0; k < slots.size(); ++k) {
                for (std::size_t l = k + 1; l < slots.size(); ++l)
                    add_row(nodes, scene, dt, slots[k], slots[l], -1, rows);
                const Vec<Dim> x = nodes.grid().node_position(nodes.slots()[slots[k]].index);
                for (std::size_t w = 0; w < scene.walls.size(); ++w)
                    if (std::abs(scene.walls[w].distance(x)) <= wall_in_sight * nodes.grid().h())
                        add_row(nodes, scene, dt, slots[k], -1, static_cast<int>(w), rows);
            }
        },
        serial_below);
    colours_.resize(CartesianGrid<Dim>::n_colours);
    for (std::vector<int>& colour : colours_) colour.clear();
    for (std::size_t i = 0; i < n_nodes; ++i)
        if (!rows_[i].empty())
            colours_[nodes.grid().colour(nodes.slots()[rows_[i].front().a].index)].push_back(
                static_cast<int>(i));
    change_.resize(n_nodes);
    total_.resize(n_nodes);
}

template <int Dim>
template <class Field>
void PairRule<Dim>::sweep(ContactNodes<Dim>& nodes, Field& field, ContactReport<Dim>& report) {
    const auto update = [&](PairRow<Dim>& row, double& change) {
        const Slot<Dim>& A = nodes.slots()[row.a];
        const Slot<Dim>* B = row.b >= 0 ? &nodes.slots()[row.b] : nullptr;
        Vec<Dim> u = field.velocity(A, row.r_a);
        u -= B ? field.velocity(*B, row.r_b) : row.u_wall;
        const double J_n = std::max(0.0, row.J_n + (row.n.dot(u) - row.gap_speed) / row.W_n);
        Vec<Dim> J = (J_n - row.J_n) * row.n;
        u -= row.W * J;
        Vec<Dim> J_t = row.J_t + (u - row.n.dot(u) * row.n) / row.W_t;
        const double size = J_t.norm();
        if (size > row.mu * J_n) J_t *= row.mu * J_n / size;
        J += J_t - row.J_t;
        row.J_n = J_n;
        row.J_t = J_t;
        if (J.squaredNorm() == 0.0) return;
        change += J.norm();
        field.add_impulse(A, row.r_a, -J);
        if (B) field.add_impulse(*B, row.r_b, J);
    };
    const auto visit = [&](int node, bool forward) {
        double change = 0.0, total = 0.0;
        std::vector<PairRow<Dim>>& rows = rows_[node];
        if (forward)
            for (auto row = rows.begin(); row != rows.end(); ++row) update(*row, change);
        else
            for (auto row = rows.rbegin(); row != rows.rend(); ++row) update(*row, change);
        for (const PairRow<Dim>& row : rows) total += row.J_n;
        change_[node] = change;
        total_[node] = total;
    };
    report.converged = false;
    for (report.sweeps = 0; report.sweeps < options_.max_sweeps && !report.converged; ++report.sweeps) {
        const bool forward = report.sweeps % 2 == 0;
        for (int c = 0; c < CartesianGrid<Dim>::n_colours; ++c) {
            const std::vector<int>& colour = colours_[forward ? c : CartesianGrid<Dim>::n_colours - 1 - c];
            parallel::for_each(
                colour.size(), [&](std::size_t i) { visit(colour[i], forward); }, serial_below);
        }
        double change = 0.0, total = 0.0;
        for (const std::vector<int>& colour : colours_)
            for (const int node : colour) {
                change += change_[node];
                total += total_[node];
            }
        report.converged = change <= options_.tolerance * total;
    }
}

template <int Dim>
template <class Before, class After>
void PairRule<Dim>::add_work(const ContactNodes<Dim>& nodes, const Before& before, const After& after,
                             ContactReport<Dim>& report) const {
    const std::size_t n_nodes = static_cast<std::size_t>(nodes.n_nodes());
    const auto work = parallel::sum(n_nodes, Work<Dim>{}, [&](std::size_t i) {
        Work<Dim> sum;
        for (const PairRow<Dim>& row : rows_[i]) {
            if (row.J_n == 0.0) continue;
            const Slot<Dim>& A = nodes.slots()[row.a];
            Vec<Dim> u = 0.5 * (before.velocity(A, row.r_a) + after.velocity(A, row.r_a));
            if (row.b >= 0) {
                const Slot<Dim>& B = nodes.slots()[row.b];
                u -= 0.5 * (before.velocity(B, row.r_b) + after.velocity(B, row.r_b));
            } else {
                u -= row.u_wall;
                sum.wall -= (row.J_n * row.n + row.J_t).dot(row.u_wall);
            }
            sum.normal -= row.J_n * row.n.dot(u);
            sum.friction -= row.J_t.dot(u);
        }
        return sum;
    });
    report.normal_work += work.normal;
    report.friction_work += work.friction;
    report.wall_work += work.wall;
    for (std::size_t i = 0; i < n_nodes; ++i)
        for (const PairRow<Dim>& row : rows_[i]) {
            ++report.n_contacts;
            if (row.J_n == 0.0) continue;
            const Vec<Dim> J = row.J_n * row.n + row.J_t;
            const Slot<Dim>& A = nodes.slots()[row.a];
            report.grain_impulse[A.grain] -= J;
            if (row.b >= 0) {
                report.grain_impulse[nodes.slots()[row.b].grain] += J;
            } else {
                report.wall_impulse[row.wall] += J;
                report.wall_moment[row.wall] +=
                    moment(Vec<Dim>(nodes.grid().node_position(A.index) + row.point), J);
            }
        }
}

template <int Dim>
void PairRule<Dim>::solve_particles(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                                    const ContactTrial<Dim>& trial, ContactReport<Dim>& report) {
    reachable_speed_ = faster_than_fastest * largest_speed(scene, trial.v);
    make_rows(nodes, scene, trial.dt);
    ParticleField<Dim> field{trial.v};
    sweep(nodes, field, report);
    add_work(nodes, ParticleField<Dim, const Vec<Dim>>{trial.v_before}, field, report);
}

template <int Dim>
void PairRule<Dim>::solve_nodal(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt,
                                std::vector<Vec<Dim>>& nodal, const std::vector<Vec<Dim>>& nodal_before,
                                ContactReport<Dim>& report) {
    reachable_speed_ = std::numeric_limits<double>::infinity();
    make_rows(nodes, scene, dt);
    NodalField<Dim> field{nodal, nodes.slots().data()};
    sweep(nodes, field, report);
    add_work(nodes, NodalField<Dim, const Vec<Dim>>{nodal_before, nodes.slots().data()}, field, report);
}

template class PairRule<2>;
template class PairRule<3>;

}  // namespace quern
