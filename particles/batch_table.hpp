// The loops of one instruction set as the rest of the program calls them.
#pragma once

#include "particles/batch_loops.hpp"
#include "particles/union_loops.hpp"

namespace quern::QUERN_BATCH_LOOPS {
namespace {

template <int Dim, bool rate, bool masked, Breaking breaking, class Topology>
void both_passes(const Topology& t, BatchState& s) {
    for (int lane = 0; lane < batch_lanes; lane += width)
        if (t.node != nullptr) {
            dilate<Dim, rate, masked, breaking>(t, s, lane);
            pull<Dim, rate, true, masked, Breaking::none>(t, s, lane);
        } else {
            pull<Dim, rate, false, masked, breaking>(t, s, lane);
        }
}

template <int Dim, bool rate, class Topology>
void evaluate(const Topology& t, BatchState& s) {
    s.n_broken = 0;
    if (s.alive == nullptr) return both_passes<Dim, rate, false, Breaking::none>(t, s);
    if constexpr (!rate) {
        if (s.shortest != nullptr) return both_passes<Dim, rate, true, Breaking::both>(t, s);
        if (s.longest != nullptr) return both_passes<Dim, rate, true, Breaking::tension>(t, s);
    }
    both_passes<Dim, rate, true, Breaking::none>(t, s);
}

template <class Topology>
constexpr BatchLoops::Set<Topology> set{evaluate<2, false, Topology>, evaluate<3, false, Topology>,
                                        evaluate<2, true, Topology>, evaluate<3, true, Topology>};

}  // namespace

extern const BatchLoops loops;
const BatchLoops loops{QUERN_BATCH_NAME, set<BatchTopology>, set<UnionTopology>};

}  // namespace quern::QUERN_BATCH_LOOPS
