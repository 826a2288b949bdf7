// Bond forces of up to eight lattice grains of unlike shape and one material at once: lane = grain.
//
// Grains on a square or cubic lattice have bonds between the same pairs of cells, as far as they reach. A
// batch goes through the union of their nodes and bonds, middle upon middle; the spacing may differ. The
// cells, the bonds and what they break are shared; a lane has
//
//     its own     node volumes V (0: no such node), q = a/m and g of the nodes (bonds.hpp, lps.hpp)
//     a cell offset  xi, and the weight w of its horizon (0: no such bond)
//     a bond         w, if the surface correction makes it differ from bond to bond
//
// so that every lane has exactly its own forces, and the same bits in any union (union_loops.hpp). The alive
// bits of lanes that lack a bond are zero; GrainView::alive finds the bits of a grain by `places`. It pays
// while half of the bonds times eight are real (`fill`): one by one they take three times as long.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "particles/bond_batch.hpp"

namespace quern {

/// What a grain brings to a union: its cells (Shape::cell) and its bonds.
template <int Dim>
struct UnionMember {
    const std::vector<IntVec<Dim>>* cell = nullptr;
    const Bonds<Dim>* bonds = nullptr;
    const BondStiffness* stiffness = nullptr;
    BreakLimit limit;
};

/// The cells and bonds that at least one of eight members has.
template <int Dim>
class CellUnion {
  public:
    explicit CellUnion(std::span<const UnionMember<Dim>> members);

    int n_nodes() const { return static_cast<int>(first.size()) - 1; }
    int n_bonds() const { return static_cast<int>(partner.size()); }
    /// Bonds of the members over eight times those of the union.
    double fill() const;

    std::vector<int> first;                             ///< [n + 1] half list: first bond of a row
    std::vector<int> partner;                           ///< [n_bonds] ascending within a row
    std::array<std::vector<int>, batch_lanes> node_of;  ///< [lane][own node] node of the union, ascending
    std::array<std::vector<int>, batch_lanes> bond_of;  ///< [lane][own bond] bond of the union, ascending
};

template <int Dim>
class UnionBatch {
  public:
    /// `members` in the order of the lanes, one to eight; read here only. `with_bits`: bonds may be missing
    /// or break.
    UnionBatch(std::span<const UnionMember<Dim>> members, CellUnion<Dim> cells, const Material& material,
               Instructions set, bool with_bits);

    /// As BondBatch. `batch`: the grains of the members, in their order.
    BrokenBonds add_elastic_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive) const;
    void add_viscous_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive) const;

    std::vector<std::uint8_t> intact() const;  ///< [n_bonds] a bit for every bond of every lane
    /// [own bonds] where a lane's bonds are in the bytes; empty without bits.
    std::span<const int> places(int lane) const { return bond_of_[lane]; }

  private:
    void set_nodes(std::span<const UnionMember<Dim>> members);
    void set_lengths(std::span<const UnionMember<Dim>> members, const CellUnion<Dim>& cells);
    void set_weights(std::span<const UnionMember<Dim>> members, const CellUnion<Dim>& cells);
    void to_rows(const GrainBatch<Dim>& batch, std::span<const Vec<Dim>> GrainView<Dim>::*member,
                 bool positions, LaneRow* rows) const;
    template <bool rate>
    BrokenBonds add_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive, double factor) const;

    const BatchLoops* loops_;
    double damping_;  // [s]
    std::array<BreakLimit, batch_lanes> limit_;
    std::vector<int> first_;                    // [n + 1]
    std::vector<UnionBond> bond_;               // [n_bonds]
    std::vector<LaneRow> length_, weight_;      // see UnionTopology
    std::vector<LaneRow> volume_, end_, node_;  // [n], or empty
    std::array<std::vector<int>, batch_lanes> node_of_, absent_, bond_of_;
    std::array<double, batch_lanes> apart_;  // between the nodes that a lane lacks [m]
};

}  // namespace quern
