#include "contact/pair_rule.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <limits>

#include "contact/slot_field.hpp"
#include "grid/parallel.hpp"

namespace quern {

namespace {

constexpr std::size_t serial_below = 64;  ///< rows of one colour
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

}  // namespace

template <int Dim>
void PairRule<Dim>::add_row(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt, int a,
                            int b, int wall, std::vector<PairRow<Dim>>& rows) const {
    const double h = nodes.grid().h();
    const Slot<Dim>& A = nodes.slots()[a];
    const Grain<Dim>& grain_a = scene.grains[A.grain];
    PairRow<Dim> row;
    row.a = a;
    std::optional<Tile<Dim>> tile;
    if (wall >= 0) {
        const Wall<Dim>& plane = scene.walls[wall];
        tile = make_wall_tile<Dim>(side(A, scene), plane, plane.distance(nodes.grid().node_position(A.index)),
                                   h, options_);
        row.wall = wall;
        row.u_wall = plane.velocity;
        row.mu = plane.friction;
    } else {
        const Slot<Dim>& B = nodes.slots()[b];
        const Grain<Dim>& grain_b = scene.grains[B.grain];
        tile = make_tile<Dim>(side(A, scene), side(B, scene), h, options_);
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

/// How far [h] bodies may move before two of them, or one and a wall, can meet at a node.
template <int Dim>
double PairRule<Dim>::free_path(std::span<const Slot<Dim>> slots, const ContactScene<Dim>& scene,
                                const CartesianGrid<Dim>& grid) const {
    const double h = grid.h();
    double path = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < slots.size(); ++k) {
        const TileSide<Dim> A = side(slots[k], scene);
        for (std::size_t l = k + 1; l < slots.size(); ++l)
            path = std::min(path, quern::free_path(A, side(slots[l], scene), h, options_));
        const Vec<Dim> x = grid.node_position(slots[k].index);
        for (const Wall<Dim>& wall : scene.walls)
            if (const double distance = wall.distance(x); std::abs(distance) <= wall_in_sight * h)
                path = std::min(path, quern::free_path(A, wall, distance, h, options_));
    }
    return path;
}

/// Rotations of the grains with slots, and which nodes are awake.
template <int Dim>
void PairRule<Dim>::choose_nodes(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene) {
    const bool chooses = nodes.chooses();
    rotation_.resize(scene.grains.size());
    parallel::for_each(scene.grains.size(), [&](std::size_t g) {
        const int grain = static_cast<int>(g);
        if (chooses ? nodes.has_sites(grain) : !nodes.slots_of_grain(grain).empty())
            rotation_[g] = surface_rotation<Dim>(scene.grains[g], scene.x);
    });
    if (!chooses) return;
    if (nodes.may_sleep())
        nodes.choose(scene,
                     [&](std::span<const Slot<Dim>> slots) { return free_path(slots, scene, nodes.grid()); });
    else
        nodes.choose_all();
}

template <int Dim>
void PairRule<Dim>::make_rows(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt,
                              int page) {
    std::vector<PairRow<Dim>>& rows = rows_[page];
    rows.clear();
    const auto [first, last] = nodes.nodes_of_page(page);
    for (int node = first; node < last; ++node) {
        const std::span<const int> slots = nodes.slots_of(node);
        for (std::size_t k = 0; k < slots.size(); ++k) {
            for (std::size_t l = k + 1; l < slots.size(); ++l)
                add_row(nodes, scene, dt, slots[k], slots[l], -1, rows);
            const Vec<Dim> x = nodes.grid().node_position(nodes.slots()[slots[k]].index);
            for (std::size_t w = 0; w < scene.walls.size(); ++w)
                if (std::abs(scene.walls[w].distance(x)) <= wall_in_sight * nodes.grid().h())
                    add_row(nodes, scene, dt, slots[k], -1, static_cast<int>(w), rows);
        }
    }
}

template <int Dim>
void PairRule<Dim>::prepare(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                            const ContactTrial<Dim>& trial) {
    reachable_speed_ = faster_than_fastest * trial.largest_speed;
    choose_nodes(nodes, scene);
    const std::size_t n_pages = static_cast<std::size_t>(nodes.n_pages());
    if (rows_.size() < n_pages) rows_.resize(n_pages);
    page_reports_.resize(n_pages);
    parallel::for_each(
        n_pages,
        [&](std::size_t page) {
            nodes.fill(scene, static_cast<int>(page));
            make_rows(nodes, scene, trial.dt, static_cast<int>(page));
        },
        nodes.serial_below());
}

template <int Dim>
template <class Field>
void PairRule<Dim>::sweep(const ContactNodes<Dim>& nodes, Field& field, ContactReport<Dim>& report) {
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
    const auto visit = [&](std::size_t page, bool forward) {
        double change = 0.0, total = 0.0;
        std::vector<PairRow<Dim>>& rows = rows_[page];
        if (forward)
            for (auto row = rows.begin(); row != rows.end(); ++row) update(*row, change);
        else
            for (auto row = rows.rbegin(); row != rows.rend(); ++row) update(*row, change);
        for (const PairRow<Dim>& row : rows) total += row.J_n;
        page_reports_[page].change = change;
        page_reports_[page].total = total;
    };
    constexpr int n_colours = ContactNodes<Dim>::n_colours;
    std::array<std::size_t, n_colours> n_rows{};
    for (int c = 0; c < n_colours; ++c) {
        const auto [first, last] = nodes.pages_of_colour(c);
        for (int page = first; page < last; ++page) n_rows[c] += rows_[page].size();
    }
    report.converged = false;
    for (report.sweeps = 0; report.sweeps < options_.max_sweeps && !report.converged; ++report.sweeps) {
        const bool forward = report.sweeps % 2 == 0;
        for (int k = 0; k < n_colours; ++k) {
            const int colour = forward ? k : n_colours - 1 - k;
            if (n_rows[colour] == 0) continue;
            const std::pair<int, int> pages = nodes.pages_of_colour(colour);
            const std::size_t n_pages = static_cast<std::size_t>(pages.second - pages.first);
            parallel::for_each(
                n_pages, [&](std::size_t i) { visit(static_cast<std::size_t>(pages.first) + i, forward); },
                n_rows[colour] < serial_below ? n_pages + 1 : 2);
        }
        double change = 0.0, total = 0.0;
        for (std::size_t page = 0; page < page_reports_.size(); ++page) {
            if (rows_[page].empty()) continue;
            change += page_reports_[page].change;
            total += page_reports_[page].total;
        }
        report.converged = change <= options_.tolerance * total;
    }
}

template <int Dim>
template <class Before, class After>
void PairRule<Dim>::add_work(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                             const Before& before, const After& after, ContactReport<Dim>& report) {
    slot_impulse_.resize(nodes.slots().size());
    parallel::for_each(
        page_reports_.size(),
        [&](std::size_t page) {
            const auto [first, last] = nodes.slots_of_page(static_cast<int>(page));
            std::fill(slot_impulse_.begin() + first, slot_impulse_.begin() + last, Vec<Dim>::Zero());
            PageReport& sum = page_reports_[page];
            sum.normal_work = sum.friction_work = sum.wall_work = 0.0;
            sum.wall_impulse.assign(scene.walls.size(), Vec<Dim>::Zero());
            sum.wall_moment.assign(scene.walls.size(), Spin<Dim>::Zero());
            for (const PairRow<Dim>& row : rows_[page]) {
                if (row.J_n == 0.0) continue;
                const Slot<Dim>& A = nodes.slots()[row.a];
                const Vec<Dim> J = row.J_n * row.n + row.J_t;
                Vec<Dim> u = 0.5 * (before.velocity(A, row.r_a) + after.velocity(A, row.r_a));
                slot_impulse_[row.a] -= J;
                if (row.b >= 0) {
                    const Slot<Dim>& B = nodes.slots()[row.b];
                    u -= 0.5 * (before.velocity(B, row.r_b) + after.velocity(B, row.r_b));
                    slot_impulse_[row.b] += J;
                } else {
                    u -= row.u_wall;
                    sum.wall_work -= J.dot(row.u_wall);
                    sum.wall_impulse[row.wall] += J;
                    sum.wall_moment[row.wall] +=
                        moment(Vec<Dim>(nodes.grid().node_position(A.index) + row.point), J);
                }
                sum.normal_work -= row.J_n * row.n.dot(u);
                sum.friction_work -= row.J_t.dot(u);
            }
        },
        nodes.serial_below());
    for (std::size_t page = 0; page < page_reports_.size(); ++page) {
        const PageReport& sum = page_reports_[page];
        report.normal_work += sum.normal_work;
        report.friction_work += sum.friction_work;
        report.wall_work += sum.wall_work;
        report.n_contacts += static_cast<std::int64_t>(rows_[page].size());
        for (std::size_t w = 0; w < scene.walls.size(); ++w) {
            report.wall_impulse[w] += sum.wall_impulse[w];
            report.wall_moment[w] += sum.wall_moment[w];
        }
    }
    parallel::for_each(
        scene.grains.size(),
        [&](std::size_t g) {
            for (const int s : nodes.slots_of_grain(static_cast<int>(g)))
                report.grain_impulse[g] += slot_impulse_[s];
        },
        serial_below);
}

template <int Dim>
void PairRule<Dim>::solve_particles(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                                    const ContactTrial<Dim>& trial, ContactReport<Dim>& report) {
    ParticleField<Dim> field{trial.v};
    sweep(nodes, field, report);
    add_work(nodes, scene, ParticleField<Dim, const Vec<Dim>>{trial.v_before}, field, report);
}

template <int Dim>
void PairRule<Dim>::solve_nodal(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                                std::vector<Vec<Dim>>& nodal, const std::vector<Vec<Dim>>& nodal_before,
                                ContactReport<Dim>& report) {
    NodalField<Dim> field{nodal, nodes.slots().data()};
    sweep(nodes, field, report);
    add_work(nodes, scene, NodalField<Dim, const Vec<Dim>>{nodal_before, nodes.slots().data()}, field,
             report);
}

template class PairRule<2>;
template class PairRule<3>;

}  // namespace quern
