// What BondBatch and UnionBatch share: rows of lanes, and the arrays of a thread.
#pragma once

#include <limits>
#include <vector>

#include "particles/bond_batch.hpp"

namespace quern {

/// Arrays of one thread, grown to the largest batch it has met and then kept.
struct BatchScratch {
    std::vector<LaneRow> x, v, f, dilatation;
    LaneRow longest, shortest;
    std::vector<int> broken_bond;
    std::vector<std::uint8_t> broken_lanes;

    template <class T>
    static T* at_least(std::vector<T>& a, std::size_t size) {
        if (a.size() < size) a.resize(size);
        return a.data();
    }
};

/// Arrays for n nodes and n_bonds bonds; positions and velocities are left to fill in.
template <int Dim, bool rate>
BatchState make_batch_state(BatchScratch& scratch, std::size_t n, std::span<std::uint8_t> alive) {
    BatchState state{};
    state.x = BatchScratch::at_least(scratch.x, n * Dim)->lane;
    state.v = rate ? BatchScratch::at_least(scratch.v, n * Dim)->lane : nullptr;
    state.f = BatchScratch::at_least(scratch.f, n * Dim)->lane;
    state.dilatation = BatchScratch::at_least(scratch.dilatation, n)->lane;
    state.alive = alive.empty() ? nullptr : alive.data();
    return state;
}

/// Lets bonds break where the limit of their lane says so; limit_of(lane) for every grain, all in the same
/// directions.
template <int Dim, class LimitOf>
void set_break_limits(BatchScratch& scratch, BatchState& state, const GrainBatch<Dim>& batch,
                      std::size_t n_bonds, LimitOf&& limit_of) {
    const BreakLimit& first = limit_of(0);
    if (state.alive == nullptr || !first.bounds_stretch()) return;
    for (int lane = 0; lane < batch_lanes; ++lane) {
        const double scale = batch.grain[lane].scale, strength = batch.grain[lane].strength;
        const bool own = lane < batch.size;  // an empty lane owns no bits that could break
        const double longest =
            own ? limit_of(lane).longest(scale, strength) : std::numeric_limits<double>::infinity();
        const double shortest = own ? limit_of(lane).shortest(scale, strength) : 0.0;
        scratch.longest.lane[lane] = longest * longest;
        scratch.shortest.lane[lane] = shortest * shortest;
    }
    state.longest = scratch.longest.lane;
    const BondBits& kept = batch.grain[0].kept;
    state.kept = kept.empty() ? nullptr : kept.bytes().data();
    if (first.in_compression) state.shortest = scratch.shortest.lane;
    const std::size_t most = 4 * n_bonds;  // the narrowest set goes through the bonds four times
    state.broken_bond = BatchScratch::at_least(scratch.broken_bond, most);
    state.broken_lanes = BatchScratch::at_least(scratch.broken_lanes, most);
}

/// The loop of a set for this dimension.
template <int Dim, bool rate, class Topology>
void run_loop(const BatchLoops::Set<Topology>& set, const Topology& topology, BatchState& state) {
    if constexpr (rate)
        (Dim == 2 ? set.viscous_2d : set.viscous_3d)(topology, state);
    else
        (Dim == 2 ? set.elastic_2d : set.elastic_3d)(topology, state);
}

}  // namespace quern
