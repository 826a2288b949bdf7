// The fast evaluation of bond forces, one grain at a time.
//
// Every model here has, on a grain of scale 1, an energy of one form,
//
//     E = 1/2 sum_bonds c e^2 + 1/2 sum_i g_i D_i^2,      D_i = sum_j k_ij xi e,     k_ij = w V_i V_j
//     force along a bond = c e + k xi (P_i + P_j),        P_i = g_i D_i
//
//     e = |y| - xi extension [m], xi reference length [m]
//     c bond stiffness [N/m; 2D: N/m^2], g dilatational stiffness of a node [N/m^15; 2D: N/m^12]
//
// so a model only has to say its c and g. Layout: half list (j > i) in rows padded to whole SIMD vectors by
// bonds of zero stiffness; positions gathered into thread-local arrays, one a component. Two passes:
// dilatation at both ends, then force at both ends. Without g the first is skipped. Rows vectorise; the
// partners' sums are added one by one in row order, so results do not depend on anything but the input.
#pragma once

#include <span>
#include <vector>

#include "particles/bonds.hpp"
#include "particles/grain_view.hpp"

namespace quern {

/// What a model gives to the kernel; both for scale 1.
struct BondStiffness {
    std::vector<double> bond;  ///< [n_bonds] c
    std::vector<double> node;  ///< [n] g; empty: a model without dilatation
    std::vector<double> end;   ///< [n] q, with c = k (q_i + q_j); empty where `node` is
};

struct BondSlots;  ///< the arrays of a kernel, as its loops want them

template <int Dim>
class BondKernel {
  public:
    BondKernel() = default;
    BondKernel(const Bonds<Dim>& bonds, const BondStiffness& stiffness);

    /// f [n] += forces of the extensions [N; 2D: N/m]. Safe from any number of threads at once.
    void add_elastic_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const;
    /// f [n] += the same law with `time` [s] times the rate of extension in place of the extension.
    void add_viscous_forces(const GrainView<Dim>& grain, double time, std::span<Vec<Dim>> f) const;
    /// The energy E [J; 2D: J/m].
    double elastic_energy(const GrainView<Dim>& grain) const;
    /// f [n] += forces of small displacements u [n] [m] from the reference X of scale 1 (the exact
    /// derivative).
    void add_linear_forces(std::span<const Vec<Dim>> X, std::span<const Vec<Dim>> u,
                           std::span<Vec<Dim>> f) const;

  private:
    template <bool rate>
    void add_forces(const GrainView<Dim>& grain, double factor, std::span<Vec<Dim>> f) const;
    BondSlots slots() const;

    std::vector<int> row_;        // [n + 1] first slot of a row, whole vectors
    std::vector<int> first_;      // [n + 1] first bond of a row
    std::vector<int> partner_;    // [n_slots]
    std::vector<double> length_;  // [n_slots] xi
    std::vector<double> weight_;  // [n_slots] k
    std::vector<double> bond_;    // [n_slots] c
    std::vector<double> node_;    // [n] g, or empty
    int longest_row_ = 0;         // [slots]
};

}  // namespace quern
