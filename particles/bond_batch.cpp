#include "particles/bond_batch.hpp"

#include <cmath>
#include <stdexcept>

#include "particles/batch_scratch.hpp"

namespace quern {

#if defined(QUERN_BATCH_X86)
namespace batch_avx512 {
extern const BatchLoops loops;
}
namespace batch_avx2 {
extern const BatchLoops loops;
}
#endif
namespace batch_plain {
extern const BatchLoops loops;
}

namespace {

/// rows [n * Dim] = (source - its first entry, if `from_first`) over the scale of each lane. Lanes without a
/// grain repeat the first.
template <int Dim>
void to_rows(const GrainBatch<Dim>& batch, std::span<const Vec<Dim>> GrainView<Dim>::*member, bool from_first,
             LaneRow* rows) {
    for (int lane = 0; lane < batch_lanes; ++lane) {
        const GrainView<Dim>& grain = batch.grain[lane < batch.size ? lane : 0];
        const std::span<const Vec<Dim>> source = grain.*member;
        // From the first node: differences of nearby numbers are exact, so a grain far from the origin loses
        // no digits in the division by its scale.
        const Vec<Dim> base = from_first ? source[0] : Vec<Dim>(Vec<Dim>::Zero());
        const double inverse = 1.0 / grain.scale;
        for (std::size_t i = 0; i < source.size(); ++i)
            for (int d = 0; d < Dim; ++d) rows[Dim * i + d].lane[lane] = (source[i][d] - base[d]) * inverse;
    }
}

}  // namespace

bool has_instructions(Instructions set) {
#if defined(QUERN_BATCH_X86)
    if (set == Instructions::avx512)
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
               __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
    if (set == Instructions::avx2) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
    return true;
#else
    return set == Instructions::best || set == Instructions::plain;
#endif
}

const BatchLoops& batch_loops(Instructions set) {
#if defined(QUERN_BATCH_X86)
    if (set == Instructions::best)
        set = has_instructions(Instructions::avx512)
                  ? Instructions::avx512
                  : (has_instructions(Instructions::avx2) ? Instructions::avx2 : Instructions::plain);
    if (set == Instructions::avx512 && has_instructions(set)) return batch_avx512::loops;
    if (set == Instructions::avx2 && has_instructions(set)) return batch_avx2::loops;
#endif
    if (!has_instructions(set))
        throw std::logic_error("batch_loops: an instruction set that this machine lacks");
    return batch_plain::loops;
}

template <int Dim>
BondBatch<Dim>::BondBatch(const Bonds<Dim>& bonds, const BondStiffness& stiffness, Instructions set)
    : loops_(&batch_loops(set)), first_(bonds.first), partner_(bonds.partner), node_(stiffness.node) {
    for (int i = 0; i < bonds.n_nodes(); ++i)
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
            const double k = bonds.weight[b] * bonds.volume[i] * bonds.volume[bonds.partner[b]];
            const double xi = bonds.length[b], c = stiffness.bond[b];
            bond_.push_back({xi, k * xi, c, c * xi});
        }
}

template <int Dim>
template <bool rate>
BrokenBonds BondBatch<Dim>::add_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive,
                                       const BreakLimit& limit, double factor) const {
    thread_local BatchScratch scratch;
    const std::size_t n = first_.size() - 1;
    BatchState state = make_batch_state<Dim, rate>(scratch, n, alive);
    set_break_limits(scratch, state, batch, bond_.size(), [&](int) -> const BreakLimit& { return limit; });
    to_rows<Dim>(batch, &GrainView<Dim>::x, true, scratch.x.data());
    if constexpr (rate) to_rows<Dim>(batch, &GrainView<Dim>::v, false, scratch.v.data());
    const BatchTopology topology{static_cast<int>(n), first_.data(), partner_.data(), bond_.data(),
                                 node_.empty() ? nullptr : node_.data()};
    run_loop<Dim, rate>(loops_->one_shape, topology, state);

    const LaneRow* const f = scratch.f.data();
    for (int lane = 0; lane < batch.size; ++lane) {
        const double back = factor * std::pow(batch.grain[lane].scale, Dim - 1);
        Vec<Dim>* const out = batch.f[lane];
        for (std::size_t i = 0; i < n; ++i)
            for (int d = 0; d < Dim; ++d) out[i][d] += back * f[Dim * i + d].lane[lane];
    }
    const std::size_t n_broken = static_cast<std::size_t>(state.n_broken);
    return {{state.broken_bond, n_broken}, {state.broken_lanes, n_broken}};
}

template <int Dim>
BrokenBonds BondBatch<Dim>::add_elastic_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive,
                                               const BreakLimit& limit) const {
    return add_forces<false>(batch, alive, limit, 1.0);
}

template <int Dim>
void BondBatch<Dim>::add_viscous_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive,
                                        double time) const {
    add_forces<true>(batch, alive, {}, time);
}

template class BondBatch<2>;
template class BondBatch<3>;

}  // namespace quern
