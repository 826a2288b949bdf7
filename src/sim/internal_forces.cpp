#include "src/sim/internal_forces.hpp"

#include <algorithm>

#include "grid/parallel.hpp"

namespace quern {

namespace {

struct Losses {
    std::int64_t broken = 0;
    double released = 0.0;  ///< energy of the bonds that broke [J; 2D: J/m]
    double plastic = 0.0;   ///< work of plastic flow [J; 2D: J/m]
    Losses& operator+=(const Losses& other) {
        broken += other.broken;
        released += other.released;
        plastic += other.plastic;
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

/// The forces of a task.
template <int Dim>
class TaskForces {
  public:
    TaskForces(Scene<Dim>& scene, double elapsed) : scene_(scene), elapsed_(elapsed) {}

    Losses compute(const ForceTask& task) const {
        const MaterialGroup<Dim>& group = scene_.group_of(task.grain[0]);
        Losses losses;
        if (group.breaks_by_work && !task.alone)
            for (int lane = 0; lane < task.size; ++lane) losses += break_by_energy(task.grain[lane]);
        if (task.union_batch >= 0) {
            losses += compute_union(task, group, scene_.unions[task.union_batch]);
            return losses;
        }
        losses += std::visit(
            [&](const auto& model) {
                return task.alone ? compute_grain(task.grain[0], group, model)
                                  : compute_batch(task, group, model);
            },
            group.model);
        return losses;
    }

  private:
    std::span<Vec<Dim>> zeroed(std::vector<Vec<Dim>>& forces, int g) const {
        const Grain<Dim>& grain = scene_.grains[g];
        std::span<Vec<Dim>> f(forces.data() + grain.first, static_cast<std::size_t>(grain.count));
        std::fill(f.begin(), f.end(), Vec<Dim>::Zero());
        return f;
    }

    double energy_of(int g, const GrainView<Dim>& view) const {
        const std::vector<Vec<Dim>>& v = scene_.moves_with_grid() ? scene_.arrays.drift : scene_.particles.v;
        return std::visit(
            [&](const auto& model) {
                return energy_now<Dim>(model, view, v.data() + scene_.grains[g].first, elapsed_);
            },
            scene_.group_of(g).model);
    }

    void mark_torn(int g) const { scene_.torn[static_cast<std::size_t>(g)] = 1; }

    /// Energy that the bonds of a grain set free between the bytes `intact` and now.
    double released(int g, const GrainView<Dim>& view, std::span<const std::uint8_t> intact) const {
        GrainView<Dim> before = view;
        before.alive = view.alive.in(intact);
        return energy_of(g, before) - energy_of(g, view);
    }

    /// Bonds of a grain that have got their work, before its forces.
    Losses break_by_energy(int g) const {
        const GrainView<Dim> view = scene_.view(g);
        thread_local std::vector<std::uint8_t> intact;
        intact.assign(view.alive.bytes().begin(), view.alive.bytes().end());
        Losses losses;
        losses.broken = std::visit(
            [&](const auto& model) {
                return model.break_by_energy(view, scene_.works_of(g), scene_.alive_of(g));
            },
            scene_.group_of(g).model);
        if (losses.broken > 0) {
            losses.released = released(g, view, intact);
            mark_torn(g);
        }
        return losses;
    }

    template <class Model>
    Losses compute_grain(int g, const MaterialGroup<Dim>& group, const Model& model) const {
        const GrainView<Dim> view = scene_.view(g);
        Losses losses;
        if (group.breaks_by_work) {
            losses = break_by_energy(g);
        } else if (group.breakable) {
            thread_local std::vector<std::uint8_t> intact;
            intact.assign(view.alive.bytes().begin(), view.alive.bytes().end());
            losses.broken = model.break_bonds(view, scene_.alive_of(g));
            if (losses.broken > 0) {
                losses.released = released(g, view, intact);
                mark_torn(g);
            }
        }
        const std::span<Vec<Dim>> f = zeroed(scene_.arrays.internal, g);
        if constexpr (std::is_same_v<Model, Correspondence<Dim>>) {
            if (group.plastic) {
                losses.plastic = model.flow(view, scene_.plastic_of(g), f);
                return losses;
            }
        }
        model.add_internal_forces(view, f);
        if (group.damped) model.add_damping_forces(view, zeroed(scene_.arrays.damping, g));
        return losses;
    }

    GrainBatch<Dim> gather(const ForceTask& task, std::vector<Vec<Dim>>& forces) const {
        GrainBatch<Dim> batch;
        batch.size = task.size;
        for (int lane = 0; lane < batch.size; ++lane) {
            batch.grain[lane] = scene_.view(task.grain[lane]);
            batch.f[lane] = zeroed(forces, task.grain[lane]).data();
        }
        return batch;
    }

    template <class Model>
    Losses compute_batch(const ForceTask& task, const MaterialGroup<Dim>& group, const Model& model) const {
        const GrainBatch<Dim> batch = gather(task, scene_.arrays.internal);
        const std::span<std::uint8_t> alive = scene_.alive_of(task.grain[0]);
        const Losses losses = count(task, model.add_batch_forces(batch, alive), batch, alive);
        if (group.damped) model.add_batch_damping(gather(task, scene_.arrays.damping), alive);
        return losses;
    }

    Losses compute_union(const ForceTask& task, const MaterialGroup<Dim>& group,
                         const UnionBatch<Dim>& forces) const {
        const GrainBatch<Dim> batch = gather(task, scene_.arrays.internal);
        const std::span<std::uint8_t> alive = scene_.alive_of(task.grain[0]);
        const Losses losses = count(task, forces.add_elastic_forces(batch, alive), batch, alive);
        if (group.damped) forces.add_viscous_forces(gather(task, scene_.arrays.damping), alive);
        return losses;
    }

    Losses count(const ForceTask& task, const BrokenBonds& torn, const GrainBatch<Dim>& batch,
                 std::span<const std::uint8_t> alive) const {
        Losses losses;
        if (torn.bond.empty()) return losses;
        thread_local std::vector<std::uint8_t> intact;
        intact.assign(alive.begin(), alive.end());
        unsigned lanes = 0;
        for (std::size_t k = 0; k < torn.bond.size(); ++k) {
            intact[static_cast<std::size_t>(torn.bond[k])] |= torn.lanes[k];
            lanes |= torn.lanes[k];
            losses.broken += __builtin_popcount(torn.lanes[k]);
        }
        for (int lane = 0; lane < batch.size; ++lane)
            if ((lanes >> lane & 1U) != 0) {
                losses.released += released(task.grain[lane], batch.grain[lane], intact);
                mark_torn(task.grain[lane]);
            }
        return losses;
    }

    Scene<Dim>& scene_;
    double elapsed_;
};

}  // namespace

template <int Dim>
void compute_internal_forces(Scene<Dim>& scene, StepContext<Dim>& now) {
    const TaskForces<Dim> forces(scene, now.part_done() * now.dt);
    const Losses losses = parallel::sum(
        scene.force_tasks.size(), Losses{},
        [&](std::size_t i) { return forces.compute(scene.force_tasks[i]); }, 1);
    if (scene.points) scene.points->compute_forces(scene.particles, scene.arrays.internal);
    now.newly_broken += losses.broken;
    now.ledger.past.fracture += losses.released;
    now.ledger.past.plastic += losses.plastic;
}

template void compute_internal_forces<2>(Scene<2>&, StepContext<2>&);
template void compute_internal_forces<3>(Scene<3>&, StepContext<3>&);

}  // namespace quern
