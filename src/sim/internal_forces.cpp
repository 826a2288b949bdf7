#include "src/sim/internal_forces.hpp"

#include <algorithm>

#include "grid/parallel.hpp"

namespace quern {

namespace {

struct Broken {
    std::int64_t count = 0;
    double released = 0.0;  ///< energy [J; 2D: J/m]
    Broken& operator+=(const Broken& other) {
        count += other.count;
        released += other.released;
        return *this;
    }
};

/// Elastic energy of a grain, and what this step's forces have added to its kinetic energy so far: what the
/// budget counts at the time of the positions.
template <int Dim, class Model>
double energy_now(const Model& model, const GrainView<Dim>& view, const Vec<Dim>* v, double elapsed) {
    thread_local std::vector<Vec<Dim>> f;
    f.assign(view.x.size(), Vec<Dim>::Zero());
    model.add_internal_forces(view, f);
    double energy = model.elastic_energy(view);
    for (std::size_t i = 0; i < f.size(); ++i) energy += elapsed * f[i].dot(v[i]);
    return energy;
}

/// The forces of one group of grains.
template <int Dim, class Model>
class Group {
  public:
    Group(Scene<Dim>& scene, const MaterialGroup<Dim>& group, const Model& model, double elapsed)
        : scene_(scene), group_(group), model_(model), elapsed_(elapsed) {}

    Broken compute() {
        const std::size_t n = static_cast<std::size_t>(group_.last_grain - group_.first_grain);
        if (!group_.batched)
            return parallel::sum(
                n, Broken{},
                [&](std::size_t i) { return compute_grain(group_.first_grain + static_cast<int>(i)); }, 1);
        return parallel::sum((n + batch_lanes - 1) / batch_lanes, Broken{},
                             [&](std::size_t i) {
                                 return compute_batch(group_.first_grain + batch_lanes * static_cast<int>(i));
                             },
                             1);
    }

  private:
    std::span<Vec<Dim>> zeroed(std::vector<Vec<Dim>>& forces, int g) const {
        const Grain<Dim>& grain = scene_.grains[g];
        std::span<Vec<Dim>> f(forces.data() + grain.first, static_cast<std::size_t>(grain.count));
        std::fill(f.begin(), f.end(), Vec<Dim>::Zero());
        return f;
    }

    double energy_of(int g, const GrainView<Dim>& view) const {
        const bool with_grid = scene_.contact && scene_.contact->moves_with_grid();
        const std::vector<Vec<Dim>>& v = with_grid ? scene_.arrays.drift : scene_.particles.v;
        return energy_now<Dim>(model_, view, v.data() + scene_.grains[g].first, elapsed_);
    }

    Broken compute_grain(int g) {
        const GrainView<Dim> view = scene_.view(g);
        Broken broken;
        if (group_.breakable) {
            thread_local std::vector<std::uint8_t> intact;
            intact.assign(view.alive.bytes().begin(), view.alive.bytes().end());
            broken.count = model_.break_bonds(view, scene_.alive_of(g));
            if (broken.count > 0) {
                GrainView<Dim> before = view;
                before.alive = BondBits(intact);
                broken.released = energy_of(g, before) - energy_of(g, view);
            }
        }
        model_.add_internal_forces(view, zeroed(scene_.arrays.internal, g));
        if (group_.damped) model_.add_damping_forces(view, zeroed(scene_.arrays.damping, g));
        return broken;
    }

    Broken compute_batch(int first) {
        GrainBatch<Dim> batch;
        batch.size = std::min(batch_lanes, group_.last_grain - first);
        for (int lane = 0; lane < batch.size; ++lane) {
            batch.grain[lane] = scene_.view(first + lane);
            batch.f[lane] = zeroed(scene_.arrays.internal, first + lane).data();
        }
        const std::span<std::uint8_t> alive = scene_.alive_of(first);
        const Broken broken = count(model_.add_batch_forces(batch, alive), batch, first, alive);
        if (group_.damped) {
            for (int lane = 0; lane < batch.size; ++lane)
                batch.f[lane] = zeroed(scene_.arrays.damping, first + lane).data();
            model_.add_batch_damping(batch, alive);
        }
        return broken;
    }

    Broken count(const BrokenBonds& torn, const GrainBatch<Dim>& batch, int first,
                 std::span<const std::uint8_t> alive) const {
        Broken broken;
        if (torn.bond.empty()) return broken;
        thread_local std::vector<std::uint8_t> intact;
        intact.assign(alive.begin(), alive.end());
        unsigned lanes = 0;
        for (std::size_t k = 0; k < torn.bond.size(); ++k) {
            intact[static_cast<std::size_t>(torn.bond[k])] |= torn.lanes[k];
            lanes |= torn.lanes[k];
            broken.count += __builtin_popcount(torn.lanes[k]);
        }
        for (int lane = 0; lane < batch.size; ++lane) {
            if ((lanes >> lane & 1U) == 0) continue;
            GrainView<Dim> before = batch.grain[lane];
            before.alive = BondBits(intact, lane);
            broken.released += energy_of(first + lane, before) - energy_of(first + lane, batch.grain[lane]);
        }
        return broken;
    }

    Scene<Dim>& scene_;
    const MaterialGroup<Dim>& group_;
    const Model& model_;
    double elapsed_;
};

}  // namespace

template <int Dim>
void compute_internal_forces(Scene<Dim>& scene, StepContext<Dim>& now) {
    for (const MaterialGroup<Dim>& group : scene.groups) {  // one dispatch a group
        const Broken broken = std::visit(
            [&](const auto& model) { return Group(scene, group, model, now.part_done() * now.dt).compute(); },
            group.model);
        now.newly_broken += broken.count;
        now.ledger.past.fracture += broken.released;
    }
}

template void compute_internal_forces<2>(Scene<2>&, StepContext<2>&);
template void compute_internal_forces<3>(Scene<3>&, StepContext<3>&);

}  // namespace quern
