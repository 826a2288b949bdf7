// What BondBatch and UnionBatch share: rows of lanes, and the arrays of a thread.
#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include "particles/bond_batch.hpp"

namespace quern {

/// Arrays of one thread, grown to the largest batch it has met and then kept.
struct BatchScratch {
    std::vector<LaneRow> x, v, f, dilatation;
    LaneRow limit;
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
BatchState make_batch_state(BatchScratch& scratch, std::size_t n, std::size_t n_bonds, int size,
                            std::span<std::uint8_t> alive, double critical_stretch) {
    BatchState state{};
    state.x = BatchScratch::at_least(scratch.x, n * Dim)->lane;
    state.v = rate ? BatchScratch::at_least(scratch.v, n * Dim)->lane : nullptr;
    state.f = BatchScratch::at_least(scratch.f, n * Dim)->lane;
    state.dilatation = BatchScratch::at_least(scratch.dilatation, n)->lane;
    state.alive = alive.empty() ? nullptr : alive.data();
    if (!rate && state.alive != nullptr && std::isfinite(critical_stretch)) {
        const double longest = (1.0 + critical_stretch) * (1.0 + critical_stretch);
        for (int lane = 0; lane < batch_lanes; ++lane)  // an empty lane owns no bits that could break
            scratch.limit.lane[lane] = lane < size ? longest : std::numeric_limits<double>::infinity();
        state.limit = scratch.limit.lane;
        const std::size_t most = 4 * n_bonds;  // the narrowest set goes through the bonds four times
        state.broken_bond = BatchScratch::at_least(scratch.broken_bond, most);
        state.broken_lanes = BatchScratch::at_least(scratch.broken_lanes, most);
    }
    return state;
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
