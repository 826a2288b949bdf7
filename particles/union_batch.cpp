#include "particles/union_batch.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "particles/batch_scratch.hpp"

namespace quern {
namespace {

/// Sorts cells as a shape does: axis 0 fastest. Shapes have at most 2e7 nodes, so 2^20 cells to a side.
template <int Dim>
std::int64_t key_of(const IntVec<Dim>& cell) {
    std::int64_t key = 0;
    for (int a = Dim - 1; a >= 0; --a) key = (key << 21) + cell[a] + (1 << 20);
    return key;
}

/// What bonds of one length have in common on any lattice: the cells between their ends, whatever the signs.
template <int Dim>
std::int64_t offset_of(const UnionMember<Dim>& member, int i, int j) {
    return key_of<Dim>(((*member.cell)[j] - (*member.cell)[i]).cwiseAbs());
}

/// Sorted, each once.
void make_set(std::vector<std::int64_t>& keys) {
    std::sort(keys.begin(), keys.end());
    keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
}

int place_in(const std::vector<std::int64_t>& set, std::int64_t key) {
    return static_cast<int>(std::lower_bound(set.begin(), set.end(), key) - set.begin());
}

/// visit(i, j, bond) for every bond of a member.
template <int Dim, class Visit>
void for_each_bond(const UnionMember<Dim>& member, Visit&& visit) {
    const Bonds<Dim>& bonds = *member.bonds;
    for (int i = 0; i < bonds.n_nodes(); ++i)
        for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) visit(i, bonds.partner[b], b);
}

/// W of a bond, see UnionTopology.
template <int Dim>
double weight_of(const UnionMember<Dim>& member, int i, int j, int b) {
    const Bonds<Dim>& bonds = *member.bonds;
    if (!member.stiffness->node.empty()) return bonds.weight[b] * bonds.length[b];
    return member.stiffness->bond[b] * bonds.length[b] / (bonds.volume[i] * bonds.volume[j]);
}

constexpr LaneRow every(double value) {
    return {{value, value, value, value, value, value, value, value}};
}

}  // namespace

template <int Dim>
CellUnion<Dim>::CellUnion(std::span<const UnionMember<Dim>> members) {
    std::vector<std::int64_t> nodes, pairs;
    for (const UnionMember<Dim>& member : members)
        for (const IntVec<Dim>& cell : *member.cell) nodes.push_back(key_of<Dim>(cell));
    make_set(nodes);
    for (std::size_t lane = 0; lane < members.size(); ++lane) {
        for (const IntVec<Dim>& cell : *members[lane].cell)
            node_of[lane].push_back(place_in(nodes, key_of<Dim>(cell)));
        for_each_bond(members[lane], [&](int i, int j, int) {
            pairs.push_back((std::int64_t{node_of[lane][i]} << 32) + node_of[lane][j]);
        });
    }
    make_set(pairs);
    first.assign(nodes.size() + 1, 0);
    for (const std::int64_t pair : pairs) {
        ++first[static_cast<std::size_t>(pair >> 32) + 1];
        partner.push_back(static_cast<int>(pair & 0xffffffff));
    }
    std::partial_sum(first.begin(), first.end(), first.begin());
    for (std::size_t lane = 0; lane < members.size(); ++lane)
        for_each_bond(members[lane], [&](int i, int j, int) {
            bond_of[lane].push_back(
                place_in(pairs, (std::int64_t{node_of[lane][i]} << 32) + node_of[lane][j]));
        });
}

template <int Dim>
double CellUnion<Dim>::fill() const {
    double own = 0.0;
    for (const std::vector<int>& bonds : bond_of) own += static_cast<double>(bonds.size());
    return own / (batch_lanes * static_cast<double>(n_bonds()));
}

template <int Dim>
UnionBatch<Dim>::UnionBatch(std::span<const UnionMember<Dim>> members, CellUnion<Dim> cells,
                            const Material& material, Instructions set, bool with_bits)
    : loops_(&batch_loops(set)), damping_(material.bond_damping) {
    for (std::size_t lane = 0; lane < members.size(); ++lane) limit_[lane] = members[lane].limit;
    for (const int j : cells.partner) bond_.push_back({j, 0, 0});
    set_lengths(members, cells);
    set_weights(members, cells);
    first_ = std::move(cells.first);
    node_of_ = std::move(cells.node_of);
    set_nodes(members);
    if (with_bits) bond_of_ = std::move(cells.bond_of);
}

template <int Dim>
void UnionBatch<Dim>::set_nodes(std::span<const UnionMember<Dim>> members) {
    const std::size_t n = first_.size() - 1;
    volume_.assign(n, every(0.0));
    apart_.fill(members[0].bonds->horizon);
    if (!members[0].stiffness->node.empty()) node_ = end_ = volume_;
    for (std::size_t lane = 0; lane < members.size(); ++lane) {
        const UnionMember<Dim>& member = members[lane];
        apart_[lane] = member.bonds->horizon;
        for (int i = 0; i < member.bonds->n_nodes(); ++i) {
            const int u = node_of_[lane][i];
            volume_[u].lane[lane] = member.bonds->volume[i];
            if (node_.empty()) continue;
            node_[u].lane[lane] = member.stiffness->node[i] * member.bonds->volume[i];
            end_[u].lane[lane] = member.stiffness->end[i];
        }
    }
    for (int lane = 0; lane < batch_lanes; ++lane)
        for (std::size_t u = 0; u < n; ++u)
            if (volume_[u].lane[lane] == 0.0) absent_[lane].push_back(static_cast<int>(u));
}

template <int Dim>
void UnionBatch<Dim>::set_lengths(std::span<const UnionMember<Dim>> members, const CellUnion<Dim>& cells) {
    std::map<std::int64_t, int> row_of;
    for (std::size_t lane = 0; lane < members.size(); ++lane)
        for_each_bond(members[lane], [&](int i, int j, int b) {
            const auto [at, is_new] =
                row_of.try_emplace(offset_of(members[lane], i, j), static_cast<int>(row_of.size()));
            if (is_new) length_.resize(length_.size() + 2, every(1.0));
            LaneRow* const row = &length_[2 * static_cast<std::size_t>(at->second)];
            row[0].lane[lane] = members[lane].bonds->length[b];
            row[1].lane[lane] = 1.0 / row[0].lane[lane];
            bond_[static_cast<std::size_t>(cells.bond_of[lane][b])].length = at->second;
        });
}

/// A row an offset where all bonds of it weigh the same in their lanes, else a row a bond.
template <int Dim>
void UnionBatch<Dim>::set_weights(std::span<const UnionMember<Dim>> members, const CellUnion<Dim>& cells) {
    std::vector<LaneRow> own(bond_.size(), every(0.0));
    weight_.assign(length_.size() / 2, every(0.0));
    LaneRow largest = every(0.0);
    for (std::size_t lane = 0; lane < members.size(); ++lane)
        for_each_bond(members[lane], [&](int i, int j, int b) {
            const int u = cells.bond_of[lane][b];
            const double w = own[u].lane[lane] = weight_of(members[lane], i, j, b);
            weight_[bond_[u].length].lane[lane] = w;
            largest.lane[lane] = std::max(largest.lane[lane], w);
        });
    bool by_offset = true;
    for (int i = 0; i < cells.n_nodes(); ++i)
        for (int u = cells.first[i]; u < cells.first[i + 1]; ++u) {
            bond_[u].weight = bond_[u].length;
            for (std::size_t lane = 0; lane < members.size(); ++lane) {
                const std::vector<int>& nodes = cells.node_of[lane];
                if (own[u].lane[lane] == 0.0 &&
                    !(std::binary_search(nodes.begin(), nodes.end(), i) &&
                      std::binary_search(nodes.begin(), nodes.end(), cells.partner[u])))
                    continue;
                by_offset &= std::abs(own[u].lane[lane] - weight_[bond_[u].weight].lane[lane]) <=
                             1e-13 * largest.lane[lane];
            }
        }
    if (by_offset) return;
    weight_ = std::move(own);
    for (std::size_t u = 0; u < bond_.size(); ++u) bond_[u].weight = static_cast<int>(u);
}

template <int Dim>
std::vector<std::uint8_t> UnionBatch<Dim>::intact() const {
    std::vector<std::uint8_t> bytes(bond_.size(), 0);
    for (int lane = 0; lane < batch_lanes; ++lane)
        for (const int b : bond_of_[lane]) bytes[b] |= static_cast<std::uint8_t>(1U << lane);
    return bytes;
}

/// As those of a BondBatch. Nodes that a lane lacks have no volume; they only must not meet another node, so
/// they stand far away, one behind the other.
template <int Dim>
void UnionBatch<Dim>::to_rows(const GrainBatch<Dim>& batch, std::span<const Vec<Dim>> GrainView<Dim>::*member,
                              bool positions, LaneRow* rows) const {
    for (int lane = 0; lane < batch_lanes; ++lane) {
        for (const int u : absent_[lane])
            for (int d = 0; d < Dim; ++d)
                rows[Dim * u + d].lane[lane] = positions ? apart_[lane] * ((1 << 20) + u) : 0.0;
        if (lane >= batch.size) continue;
        const GrainView<Dim>& grain = batch.grain[lane];
        const std::span<const Vec<Dim>> source = grain.*member;
        const Vec<Dim> base = positions ? source[0] : Vec<Dim>(Vec<Dim>::Zero());
        const double inverse = 1.0 / grain.scale;
        for (std::size_t i = 0; i < source.size(); ++i)
            for (int d = 0; d < Dim; ++d)
                rows[Dim * node_of_[lane][i] + d].lane[lane] = (source[i][d] - base[d]) * inverse;
    }
}

template <int Dim>
template <bool rate>
BrokenBonds UnionBatch<Dim>::add_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive,
                                        double factor) const {
    thread_local BatchScratch scratch;
    const std::size_t n = first_.size() - 1;
    BatchState state = make_batch_state<Dim, rate>(scratch, n, alive);
    if constexpr (!rate)
        set_break_limits(scratch, state, batch, bond_.size(),
                         [&](int lane) -> const BreakLimit& { return limit_[lane]; });
    to_rows(batch, &GrainView<Dim>::x, true, scratch.x.data());
    if constexpr (rate) to_rows(batch, &GrainView<Dim>::v, false, scratch.v.data());
    const bool dilating = !node_.empty();
    const UnionTopology topology{static_cast<int>(n),
                                 first_.data(),
                                 bond_.data(),
                                 length_.data()->lane,
                                 weight_.data()->lane,
                                 volume_.data()->lane,
                                 dilating ? end_.data()->lane : nullptr,
                                 dilating ? node_.data()->lane : nullptr};
    run_loop<Dim, rate>(loops_->lattice, topology, state);

    const LaneRow* const f = scratch.f.data();
    for (int lane = 0; lane < batch.size; ++lane) {
        const double back = factor * std::pow(batch.grain[lane].scale, Dim - 1);
        Vec<Dim>* const out = batch.f[lane];
        const std::vector<int>& node = node_of_[lane];
        for (std::size_t i = 0; i < node.size(); ++i)
            for (int d = 0; d < Dim; ++d) out[i][d] += back * f[Dim * node[i] + d].lane[lane];
    }
    const std::size_t n_broken = static_cast<std::size_t>(state.n_broken);
    return {{state.broken_bond, n_broken}, {state.broken_lanes, n_broken}};
}

template <int Dim>
BrokenBonds UnionBatch<Dim>::add_elastic_forces(const GrainBatch<Dim>& batch,
                                                std::span<std::uint8_t> alive) const {
    return add_forces<false>(batch, alive, 1.0);
}

template <int Dim>
void UnionBatch<Dim>::add_viscous_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive) const {
    add_forces<true>(batch, alive, damping_);
}

template class CellUnion<2>;
template class CellUnion<3>;
template class UnionBatch<2>;
template class UnionBatch<3>;

}  // namespace quern
