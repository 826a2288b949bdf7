// Bond forces of up to eight grains of one shape and material at once: lane = grain.
//
// Grains that share a shape share its bonds, whatever their rotation and size: topology, lengths and weights
// are read once for eight grains, positions lie next to each other, and nothing is gathered. Same law, same
// order of sums as BondKernel; a grain's forces do not depend on its lane or on its companions. The loops
// exist for three instruction sets, chosen when the program runs; each gives the same bits always, and they
// differ from each other and from BondKernel by round-off (tests/particles/force_batch.cpp).
#pragma once

#include <array>
#include <memory>
#include <span>
#include <vector>

#include "particles/batch_types.hpp"
#include "particles/bond_kernel.hpp"
#include "particles/break_limit.hpp"
#include "particles/instructions.hpp"

namespace quern {

/// The loops of a set; std::logic_error if `has_instructions` is false.
const BatchLoops& batch_loops(Instructions set);

/// One to eight grains of one shape and material.
template <int Dim>
struct GrainBatch {
    int size = 0;
    std::array<GrainView<Dim>, batch_lanes> grain;  ///< bonds: bit k for grain k, in bytes shared by all
    std::array<Vec<Dim>*, batch_lanes> f;           ///< [n] each: forces are added here [N; 2D: N/m]
};

/// Bonds that broke in one evaluation: (bond, one bit a lane); valid until the thread's next evaluation.
struct BrokenBonds {
    std::span<const int> bond;
    std::span<const std::uint8_t> lanes;
};

template <int Dim>
class BondBatch {
  public:
    BondBatch() = default;
    BondBatch(const Bonds<Dim>& bonds, const BondStiffness& stiffness, Instructions set);

    /// f += forces of the extensions. `alive` [n_bonds], empty: all intact. Bonds beyond `limit` break before
    /// they pull: their bits are cleared. Safe from any number of threads.
    BrokenBonds add_elastic_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive,
                                   const BreakLimit& limit) const;
    /// f += the same law with `time` [s] times the rate of extension in place of the extension.
    void add_viscous_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive, double time) const;

  private:
    template <bool rate>
    BrokenBonds add_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive,
                           const BreakLimit& limit, double factor) const;

    const BatchLoops* loops_ = nullptr;
    std::vector<int> first_;       // [n + 1]
    std::vector<int> partner_;     // [n_bonds]
    std::vector<BatchBond> bond_;  // [n_bonds]
    std::vector<double> node_;     // [n] g, or empty
};

}  // namespace quern
