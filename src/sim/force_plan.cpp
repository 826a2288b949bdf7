#include "src/sim/force_plan.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace quern {

namespace {

constexpr double least_fill = 0.5;

template <int Dim>
UnionMember<Dim> member_of(const Scene<Dim>& scene, int g) {
    return std::visit(
        [&](const auto& model) {
            return UnionMember<Dim>{&scene.grains[g].shape->cell, &model.bonds(), &model.stiffness(),
                                    model.break_limit()};
        },
        scene.group_of(g).model);
}

/// Bytes for the bonds of a task in which every grain has a bit.
template <int Dim>
void place_bits(Scene<Dim>& scene, const ForceTask& task) {
    const MaterialGroup<Dim>& group = scene.group_of(task.grain[0]);
    if (!group.breakable) return;
    const std::size_t begin = scene.alive.size();
    if (task.union_batch >= 0) {
        const std::vector<std::uint8_t> intact = scene.unions[task.union_batch].intact();
        scene.alive.insert(scene.alive.end(), intact.begin(), intact.end());
    } else {
        const int n_bonds = std::visit([](const auto& model) { return model.n_bonds(); }, group.model);
        scene.alive.resize(begin + static_cast<std::size_t>(n_bonds), 0xff);
    }
    for (int lane = 0; lane < task.size; ++lane) {
        const int g = task.grain[lane];
        scene.bond_bytes[static_cast<std::size_t>(g)] = {
            begin, scene.alive.size() - begin, lane,
            task.union_batch >= 0 ? scene.unions[task.union_batch].places(lane).data() : nullptr,
            scene.works.size()};
        if (!group.breaks_by_work) continue;
        const int n_bonds =
            std::visit([](const auto& model) { return model.n_bonds(); }, scene.group_of(g).model);
        scene.works.resize(scene.works.size() + static_cast<std::size_t>(n_bonds));
    }
}

/// Lattice grains outside of batches, those alike next to each other: by material, cells along the axes,
/// bonds.
template <int Dim>
std::vector<int> sort_by_size(const Scene<Dim>& scene) {
    using Key = std::tuple<int, std::array<int, Dim>, int, int>;
    std::vector<Key> keys;
    for (const MaterialGroup<Dim>& group : scene.groups) {
        const Grain<Dim>& grain = scene.grains[group.first_grain];
        const std::vector<IntVec<Dim>>& cells = grain.shape->cell;
        if (group.batched || cells.empty() || std::holds_alternative<Correspondence<Dim>>(group.model))
            continue;
        const int n_bonds = std::visit([](const auto& model) { return model.n_bonds(); }, group.model);
        IntVec<Dim> low = cells[0], high = cells[0];
        for (const IntVec<Dim>& cell : cells) {
            low = low.cwiseMin(cell);
            high = high.cwiseMax(cell);
        }
        std::array<int, Dim> extent;
        for (int a = 0; a < Dim; ++a) extent[a] = high[a] - low[a];
        for (int g = group.first_grain; g < group.last_grain; ++g)
            keys.emplace_back(grain.material, extent, n_bonds, g);
    }
    std::sort(keys.begin(), keys.end());
    std::vector<int> sorted;
    for (const Key& key : keys) sorted.push_back(std::get<3>(key));
    return sorted;
}

template <int Dim>
void make_unions(const Deck& deck, Scene<Dim>& scene) {
    const std::vector<int> sorted = sort_by_size(scene);
    for (std::size_t k = 0; k < sorted.size();) {
        ForceTask task;
        std::vector<UnionMember<Dim>> members;
        const int material = scene.grains[sorted[k]].material;
        for (std::size_t i = k; i < sorted.size() && task.size < batch_lanes; ++i) {
            if (scene.grains[sorted[i]].material != material) break;
            task.grain[task.size++] = sorted[i];
            members.push_back(member_of(scene, sorted[i]));
        }
        CellUnion<Dim> cells(members);
        if (cells.fill() < least_fill) {
            ++k;
            continue;
        }
        k += static_cast<std::size_t>(task.size);
        task.union_batch = static_cast<int>(scene.unions.size());
        scene.unions.emplace_back(members, std::move(cells), deck.materials[material],
                                  deck.compute.instructions, scene.group_of(task.grain[0]).breakable);
        scene.force_tasks.push_back(task);
    }
}

}  // namespace

bool makes_batches(const ComputeDeck& deck, int n_grains) {
    return deck.kernel == ForceKernel::automatic && n_grains >= 4;
}

template <int Dim>
void plan_forces(const Deck& deck, Scene<Dim>& scene) {
    if (deck.compute.kernel == ForceKernel::automatic) make_unions(deck, scene);
    std::vector<bool> in_union(scene.grains.size(), false);
    for (const ForceTask& task : scene.force_tasks)
        for (int lane = 0; lane < task.size; ++lane)
            in_union[static_cast<std::size_t>(task.grain[lane])] = true;
    for (const MaterialGroup<Dim>& group : scene.groups)
        for (int g = group.first_grain; g < group.last_grain;) {
            ForceTask task;
            task.alone = !group.batched;
            task.size = group.batched ? std::min(batch_lanes, group.last_grain - g) : 1;
            for (int lane = 0; lane < task.size; ++lane) task.grain[lane] = g + lane;
            if (!in_union[static_cast<std::size_t>(g)]) scene.force_tasks.push_back(task);
            g += task.size;
        }
    scene.bond_bytes.resize(scene.grains.size());
    for (const ForceTask& task : scene.force_tasks) place_bits(scene, task);
}

template void plan_forces<2>(const Deck&, Scene<2>&);
template void plan_forces<3>(const Deck&, Scene<3>&);

}  // namespace quern
