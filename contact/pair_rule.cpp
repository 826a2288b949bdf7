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
void PairRule<Dim>::add_pair(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt, int a,
                             int b, int page) {
    const Slot<Dim>&A = nodes.slots()[a], &B = nodes.slots()[b];
    PairRow<Dim> row;
    row.a = a;
    row.b = b;
    row.mu = (*scene.friction)(scene.grains[A.grain].material, scene.grains[B.grain].material);
    if (options_.rule != GridRule::surface) {
        if (const auto tile = make_tile<Dim>(side(A, scene), side(B, scene), nodes.grid().h(), options_))
            add_row(nodes, scene, dt, row, *tile, nullptr, page);
        return;
    }
    const SurfaceSide<Dim> of_a = surface_side(nodes, a, scene), of_b = surface_side(nodes, b, scene);
    const auto one_on_other = [&](const SurfaceSide<Dim>& one, const SurfaceSide<Dim>& other, bool swapped) {
        const bool all = all_look_for<Dim>(one, other);
        for_each_owned<Dim>(one, nodes.grid(), [&](int surface) {
            if (!all && !one.footprints->tip(surface)) return;
            auto contact = meet<Dim>(one, surface, other, reachable_speed_ * dt);
            if (!contact) return;
            if (swapped) {
                std::swap(contact->a, contact->b);
                contact->tile.normal = -contact->tile.normal;
            }
            add_row(nodes, scene, dt, row, contact->tile, &*contact, page);
        });
    };
    one_on_other(of_a, of_b, false);
    one_on_other(of_b, of_a, true);
}

template <int Dim>
void PairRule<Dim>::add_wall(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt, int a,
                             int wall, int page) {
    const Slot<Dim>& A = nodes.slots()[a];
    const Wall<Dim>& plane = scene.walls[wall];
    PairRow<Dim> row;
    row.a = a;
    row.wall = wall;
    row.u_wall = plane.velocity;
    row.mu = plane.friction;
    if (options_.exact_walls) {
        const SurfaceSide<Dim> of_a = surface_side(nodes, a, scene);
        for_each_owned<Dim>(of_a, nodes.grid(), [&](int surface) {
            if (const auto contact = meet<Dim>(of_a, surface, plane, reachable_speed_ * dt))
                add_row(nodes, scene, dt, row, contact->tile, &*contact, page);
        });
        return;
    }
    const double offset = plane.distance(nodes.grid().node_position(A.index));
    if (const auto tile = make_wall_tile<Dim>(side(A, scene), plane, offset, nodes.grid().h(), options_))
        add_row(nodes, scene, dt, row, *tile, nullptr, page);
}

template <int Dim>
void PairRule<Dim>::add_row(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene, double dt,
                            PairRow<Dim> row, const Tile<Dim>& tile, const SurfaceContact<Dim>* at_surface,
                            int page) {
    row.gap_speed = options_.gap_test ? std::max(tile.gap, 0.0) / dt : 0.0;
    if (row.gap_speed > reachable_speed_) return;  // the row would stay without impulse
    row.n = tile.normal;
    row.point = tile.point;
    if (options_.coupling == GridCoupling::flip) {
        const std::vector<Slot<Dim>>& slots = nodes.slots();
        row.r_a.setZero();
        row.r_b.setZero();
        row.W = Mat<Dim>::Identity() * (1.0 / slots[row.a].m + (row.b >= 0 ? 1.0 / slots[row.b].m : 0.0));
    } else if (at_surface) {
        use_patches(nodes, scene, *at_surface, row, patches_[page]);
    } else {
        use_slots(nodes, row);
    }
    row.W_n = row.n.dot(row.W * row.n);
    row.W_t = tangential(row.W, tangents<Dim>(row.n));
    rows_[page].push_back(row);
}

/// Two patches that cannot turn, single particles as a rule: only an impulse along the line of their centres
/// keeps the angular momentum. `apart`: from the centre of A to that of B [m].
template <int Dim>
void meet_as_points(const Vec<Dim>& apart, PairRow<Dim>& row) {
    const double distance = apart.norm();
    if (distance == 0.0) return;
    row.n = apart / (row.n.dot(apart) < 0.0 ? -distance : distance);
    row.mu = 0.0;
}

template <int Dim>
void PairRule<Dim>::use_slots(const ContactNodes<Dim>& nodes, PairRow<Dim>& row) const {
    const Slot<Dim>& A = nodes.slots()[row.a];
    const Slot<Dim>* B = row.b >= 0 ? &nodes.slots()[row.b] : nullptr;
    // A patch that cannot turn takes its impulse at its centre; there both grains must meet.
    if (options_.rotation && B && !A.rotates && !B->rotates) meet_as_points<Dim>(Vec<Dim>(B->xb - A.xb), row);
    if (!A.rotates)
        row.point = A.xb;
    else if (B && !B->rotates)
        row.point = B->xb;
    row.r_a = row.point - A.xb;
    row.W = inverse_mass<Dim>(A, row.r_a, options_.exact_mass);
    if (!B) return;
    row.r_b = row.point - B->xb;
    row.W += inverse_mass<Dim>(*B, row.r_b, options_.exact_mass);
}

template <int Dim>
void PairRule<Dim>::use_patches(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                                const SurfaceContact<Dim>& contact, PairRow<Dim>& row,
                                Patches<Dim>& patches) const {
    const Vec<Dim> middle = row.point;
    const auto add = [&](int slot, int surface, double to_surface) {
        const SurfaceSide<Dim> of = surface_side(nodes, slot, scene);
        return patches.add(scene, *of.grain, of.s, *of.footprints, surface, Vec<Dim>(of.origin + row.point),
                           Vec<Dim>(of.origin + middle + to_surface * row.n), row.n, !options_.rotation);
    };
    const double half_gap = 0.5 * contact.tile.gap;
    row.patch_a = add(row.a, contact.a, -half_gap);
    if (row.b >= 0) row.patch_b = add(row.b, contact.b, half_gap);
    // As with slots: what cannot turn takes its impulse at its centre, and the other one meets it there.
    const auto turns = [&](int patch) { return patch < 0 || patches.patches[patch].rotates; };
    const auto to_centre = [&](int patch) {
        row.point -= patches.patches[patch].r;
        patches.patches[patch].r.setZero();
    };
    if (options_.rotation && !turns(row.patch_a)) {
        to_centre(row.patch_a);
        if (row.b >= 0) row.patch_b = add(row.b, contact.b, half_gap);
        if (!turns(row.patch_b)) meet_as_points<Dim>(Vec<Dim>(-patches.patches[row.patch_b].r), row);
    } else if (options_.rotation && !turns(row.patch_b)) {
        to_centre(row.patch_b);
        row.patch_a = add(row.a, contact.a, -half_gap);
    }
    row.W = patches.inverse_mass(row.patch_a, scene.mass, options_.exact_mass);
    if (row.b >= 0) row.W += patches.inverse_mass(row.patch_b, scene.mass, options_.exact_mass);
}

/// Footprints of all shapes, once.
template <int Dim>
void PairRule<Dim>::know_surfaces(const ContactScene<Dim>& scene) {
    if (!at_surfaces_) return;
    surface_points_.resize(scene.x.size());
    footprints_of_.resize(scene.grains.size());
    for (std::size_t g = 0; g < scene.grains.size(); ++g) {
        const Shape<Dim>* shape = scene.grains[g].shape;
        std::unique_ptr<Footprints<Dim>>& known = footprints_[shape];
        if (!known) known = std::make_unique<Footprints<Dim>>(*shape);
        footprints_of_[g] = known.get();
    }
}

template <int Dim>
template <class Field>
Vec<Dim> PairRule<Dim>::velocity(const Field& field, const ContactNodes<Dim>& nodes, std::size_t page,
                                 int slot, int patch, const Vec<Dim>& r) const {
    if (patch >= 0) return patches_[page].velocity(patch, field.v);
    return field.velocity(nodes.slots()[slot], r);
}

template <int Dim>
template <class Field>
void PairRule<Dim>::add_impulse(Field& field, const ContactNodes<Dim>& nodes, std::size_t page, int slot,
                                int patch, const Vec<Dim>& r, const Vec<Dim>& J) const {
    if (patch >= 0)
        patches_[page].add_impulse(patch, J, field.v);
    else
        field.add_impulse(nodes.slots()[slot], r, J);
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
            path = std::min(path, options_.rule == GridRule::surface
                                      ? surface_free_path<Dim>(surface_side(slots[k], scene, grid),
                                                               surface_side(slots[l], scene, grid), h)
                                      : quern::free_path<Dim>(A, side(slots[l], scene), h, options_));
        const Vec<Dim> x = grid.node_position(slots[k].index);
        for (const Wall<Dim>& wall : scene.walls)
            if (const double distance = wall.distance(x); std::abs(distance) <= wall_in_sight * h)
                path =
                    std::min(path, options_.exact_walls
                                       ? surface_free_path<Dim>(surface_side(slots[k], scene, grid), wall, h)
                                       : quern::free_path<Dim>(A, wall, distance, h, options_));
    }
    return path;
}

template <int Dim>
void PairRule<Dim>::know_surface(const ContactScene<Dim>& scene, int grain) {
    rotation_[grain] = surface_rotation<Dim>(scene.grains[grain], scene.x);
    if (at_surfaces_) find_surface<Dim>(scene.grains[grain], rotation_[grain], scene.x, surface_points_);
}

/// Surfaces of the grains with slots, and which nodes are awake.
template <int Dim>
void PairRule<Dim>::choose_nodes(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene) {
    const bool chooses = nodes.chooses();
    rotation_.resize(scene.grains.size());
    parallel::for_each(scene.grains.size(), [&](std::size_t g) {
        const int grain = static_cast<int>(g);
        if (chooses ? nodes.has_sites(grain) : !nodes.slots_of_grain(grain).empty())
            know_surface(scene, grain);
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
    rows_[page].clear();
    patches_[page].clear();
    const auto [first, last] = nodes.nodes_of_page(page);
    for (int node = first; node < last; ++node) {
        const std::span<const int> slots = nodes.slots_of(node);
        for (std::size_t k = 0; k < slots.size(); ++k) {
            for (std::size_t l = k + 1; l < slots.size(); ++l)
                add_pair(nodes, scene, dt, slots[k], slots[l], page);
            const Vec<Dim> x = nodes.grid().node_position(nodes.slots()[slots[k]].index);
            for (std::size_t w = 0; w < scene.walls.size(); ++w)
                if (std::abs(scene.walls[w].distance(x)) <= wall_in_sight * nodes.grid().h())
                    add_wall(nodes, scene, dt, slots[k], static_cast<int>(w), page);
        }
    }
}

template <int Dim>
void PairRule<Dim>::prepare(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                            const ContactTrial<Dim>& trial) {
    reachable_speed_ = faster_than_fastest * trial.largest_speed;
    know_surfaces(scene);
    choose_nodes(nodes, scene);
    const std::size_t n_pages = static_cast<std::size_t>(nodes.n_pages());
    if (rows_.size() < n_pages) {
        rows_.resize(n_pages);
        patches_.resize(n_pages);
    }
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
    const auto update = [&](PairRow<Dim>& row, std::size_t page, double& change) {
        Vec<Dim> u = velocity(field, nodes, page, row.a, row.patch_a, row.r_a);
        u -= row.b >= 0 ? velocity(field, nodes, page, row.b, row.patch_b, row.r_b) : row.u_wall;
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
        add_impulse(field, nodes, page, row.a, row.patch_a, row.r_a, Vec<Dim>(-J));
        if (row.b >= 0) add_impulse(field, nodes, page, row.b, row.patch_b, row.r_b, J);
    };
    const auto visit = [&](std::size_t page, bool forward) {
        double change = 0.0, total = 0.0;
        std::vector<PairRow<Dim>>& rows = rows_[page];
        if (forward)
            for (auto row = rows.begin(); row != rows.end(); ++row) update(*row, page, change);
        else
            for (auto row = rows.rbegin(); row != rows.rend(); ++row) update(*row, page, change);
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
                Vec<Dim> u = 0.5 * (velocity(before, nodes, page, row.a, row.patch_a, row.r_a) +
                                    velocity(after, nodes, page, row.a, row.patch_a, row.r_a));
                slot_impulse_[row.a] -= J;
                if (row.b >= 0) {
                    u -= 0.5 * (velocity(before, nodes, page, row.b, row.patch_b, row.r_b) +
                                velocity(after, nodes, page, row.b, row.patch_b, row.r_b));
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

template <int Dim>
void PairRule<Dim>::list_contacts(const ContactNodes<Dim>& nodes,
                                  std::vector<ContactPoint<Dim>>& points) const {
    for (std::size_t page = 0; page < page_reports_.size(); ++page)
        for (const PairRow<Dim>& row : rows_[page]) {
            if (row.J_n == 0.0) continue;
            const Slot<Dim>& A = nodes.slots()[row.a];
            ContactPoint<Dim> point;
            point.first = A.grain;
            point.second = row.b >= 0 ? nodes.slots()[row.b].grain : -1 - row.wall;
            point.at_first = point.at_second = nodes.grid().node_position(A.index) + row.point;
            if (row.b >= 0)
                point.at_second = nodes.grid().node_position(nodes.slots()[row.b].index) + row.point;
            point.normal = row.n;
            point.impulse = row.J_n * row.n + row.J_t;
            point.slips = at_friction_limit<Dim>(point.impulse, row.n, row.mu);
            points.push_back(point);
        }
}

template class PairRule<2>;
template class PairRule<3>;

}  // namespace quern
