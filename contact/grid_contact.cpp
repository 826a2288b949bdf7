#include "contact/grid_contact.hpp"

#include "contact/seed_rule.hpp"
#include "grid/parallel.hpp"

namespace quern {

namespace {

ContactNodeOptions node_options(const GridContactOptions& options) {
    ContactNodeOptions nodes;
    nodes.all_nodes = options.coupling == GridCoupling::flip;
    nodes.all_particles = options.rule == GridRule::seed;
    if (options.rule == GridRule::seed) nodes.wall_reach = 1e-6;
    // A particle at the wall may be half a cell diagonal from its node, and half a cell deep.
    else if (options.exact_walls)
        nodes.wall_reach = 1.5;
    nodes.only_surface = options.rule == GridRule::surface && options.exact_walls;
    nodes.weights.nodal = options.coupling == GridCoupling::flip || options.rule == GridRule::seed;
    nodes.weights.interior_weight = options.interior_weight;
    // Only where an impulse needs surfaces that meet can nodes whose surfaces are apart be left out.
    const bool meets = options.rule != GridRule::seed && options.gap_test && !nodes.all_nodes;
    nodes.weights.rotation = options.rotation;
    nodes.skin = meets ? options.skin : 0.0;
    return nodes;
}

}  // namespace

template <int Dim>
GridContact<Dim>::GridContact(const CartesianGrid<Dim>& grid, const GridContactOptions& options)
    : options_(options),
      nodes_(grid, node_options(options)),
      pair_(options),
      bodies_(options.debris),
      loose_(grid, options) {}

template <int Dim>
void GridContact<Dim>::set_pieces(const ContactScene<Dim>& scene, int grain, std::span<const int> piece,
                                  std::span<const BrokenBond> broken) {
    bodies_.set_pieces(scene, grain, piece, broken);
    if (bodies_.changed()) {
        nodes_.forget();
        loose_.forget();
    }
    for (const auto& shape : bodies_.take_old_shapes()) pair_.forget(*shape);
}

template <int Dim>
const ContactReport<Dim>& GridContact<Dim>::add_impulses(const ContactScene<Dim>& scene,
                                                         const ContactTrial<Dim>& trial) {
    report_.normal_work = report_.friction_work = report_.wall_work = 0.0;
    report_.n_contacts = 0;
    report_.sweeps = 0;
    report_.converged = true;
    report_.wall_impulse.assign(scene.walls.size(), Vec<Dim>::Zero());
    report_.wall_moment.assign(scene.walls.size(), Spin<Dim>::Zero());
    if (bodies_.whole()) {
        apply_rule(scene, trial);
        return report_;
    }
    ContactTrial<Dim> moved = trial;
    if (!moves_with_grid()) moved.drift = {};
    const ContactScene<Dim> of_bodies = bodies_.gather(scene);
    const ContactTrial<Dim> their_trial = bodies_.gather(moved);
    loose_.find(bodies_, of_bodies, their_trial);
    apply_rule(of_bodies, their_trial);
    received_.assign(scene.grains.size(), Vec<Dim>::Zero());
    for (std::size_t b = 0; b < of_bodies.grains.size(); ++b)
        received_[bodies_.grain_of(static_cast<int>(b))] += report_.grain_impulse[b];
    std::swap(received_, report_.grain_impulse);
    loose_.add_impulses(bodies_, of_bodies, their_trial, report_);
    bodies_.give_back(moved);
    return report_;
}

template <int Dim>
void GridContact<Dim>::list_contacts(const ContactScene<Dim>& scene, std::vector<ContactPoint<Dim>>& points) {
    const ContactScene<Dim> seen = bodies_.whole() ? scene : bodies_.gather(scene);
    std::vector<ContactPoint<Dim>> listed;
    if (options_.rule != GridRule::seed)
        pair_.list_contacts(nodes_, listed);
    else
        list_seed_contacts<Dim>(nodes_, seen, nodal_trial_, listed);
    if (!bodies_.whole()) loose_.list_contacts(bodies_, seen, listed);
    for (ContactPoint<Dim>& point : listed) {
        if (!bodies_.whole()) {
            point.first = bodies_.grain_of(point.first);
            if (point.second >= 0) point.second = bodies_.grain_of(point.second);
        }
        if (point.first != point.second) points.push_back(point);
    }
}

/// The rule of the grid: `scene` holds grains, or the bodies of broken ones.
template <int Dim>
void GridContact<Dim>::apply_rule(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial) {
    report_.grain_impulse.assign(scene.grains.size(), Vec<Dim>::Zero());
    nodes_.find(scene, trial.dt * trial.largest_speed);
    report_.searched = nodes_.searched();
    if (options_.rule != GridRule::seed) {
        pair_.prepare(nodes_, scene, trial);
    } else {
        nodes_.choose_all();
        nodes_.fill(scene);
    }
    if (options_.rule != GridRule::seed && options_.coupling == GridCoupling::impulse)
        pair_.solve_particles(nodes_, scene, trial, report_);
    else
        solve_on_nodes(scene, trial);
    report_.n_nodes = nodes_.n_nodes();
}

template <int Dim>
void GridContact<Dim>::to_slots(std::span<const Vec<Dim>> v, std::vector<Vec<Dim>>& nodal) const {
    nodal.resize(nodes_.slots().size());
    parallel::for_each(
        nodal.size(),
        [&](std::size_t s) {
            const Slot<Dim>& slot = nodes_.slots()[s];
            Vec<Dim> momentum = Vec<Dim>::Zero();
            for (int k = 0; k < slot.n_support; ++k) {
                const Support<Dim>& e = slot.support[k];
                momentum += e.mw * v[e.particle];
            }
            nodal[s] = slot.m > 0.0 ? Vec<Dim>(momentum / slot.m) : Vec<Dim>(Vec<Dim>::Zero());
        },
        256);
}

template <int Dim>
void GridContact<Dim>::solve_on_nodes(const ContactScene<Dim>& scene, const ContactTrial<Dim>& trial) {
    to_slots(trial.v_before, nodal_before_);
    to_slots(trial.v, nodal_trial_);
    nodal_ = nodal_trial_;
    if (options_.rule != GridRule::seed)
        pair_.solve_nodal(nodes_, scene, nodal_, nodal_before_, report_);
    else
        apply_seed_rule<Dim>(nodes_, scene, nodal_, nodal_before_, report_);
    const bool flip = options_.coupling == GridCoupling::flip;
    if (!flip) v_trial_.assign(trial.v.begin(), trial.v.end());
    parallel::for_each(scene.grains.size(), [&](std::size_t g) {
        const Grain<Dim>& grain = scene.grains[g];
        if (flip)
            for (int p = grain.first; p < grain.first + grain.count; ++p) {
                trial.v[p] = trial.v_before[p];
                trial.drift[p].setZero();
            }
        for (const int s : nodes_.slots_of_grain(static_cast<int>(g))) {
            const Slot<Dim>& slot = nodes_.slots()[s];
            const Vec<Dim> dv = nodal_[s] - (flip ? nodal_before_[s] : nodal_trial_[s]);
            for (int k = 0; k < slot.n_support; ++k) {
                const Support<Dim>& e = slot.support[k];
                trial.v[e.particle] += e.N * dv;
                if (flip) trial.drift[e.particle] += e.N * nodal_[s];
            }
        }
    });
    if (flip) return;
    // Mapped back, nodal changes do other work than on the nodes: the rest is loss of contact, too.
    const double work = parallel::sum(trial.v.size(), 0.0, [&](std::size_t p) {
        const Vec<Dim> dv = trial.v[p] - v_trial_[p];
        return 0.5 * scene.mass[p] * dv.dot(trial.v_before[p] + trial.v[p]);
    });
    report_.normal_work = work - report_.friction_work - report_.wall_work;
}

template class GridContact<2>;
template class GridContact<3>;

}  // namespace quern
