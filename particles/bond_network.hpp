// What all models made of bonds have in common: everything but their stiffness.
#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "particles/bond_batch.hpp"
#include "particles/bond_kernel.hpp"
#include "particles/bonds.hpp"
#include "particles/grain_view.hpp"
#include "particles/material.hpp"

namespace quern {

/// How internal forces are evaluated: by the fast loops, or by the formulas of the model as printed, for
/// comparison; and with which instructions batches are.
enum class Kernel { fast, reference };
struct KernelChoice {
    Kernel kernel = Kernel::fast;
    Instructions instructions = Instructions::best;
    bool batches = true;  ///< add_batch_forces will be called; false saves its table of bonds
};

/// Base of the bond models, not for use by itself. A grain of scale s is evaluated at y/s:
///
///     F(s, y) = s^(Dim-1) F(1, y/s)      E = s^Dim E(1, y/s)      omega = omega(1)/s
///
/// All functions are const and may run on any number of threads at once; sizes are those of GrainView.
/// Broken bonds leave the sums of extensions; m stays that of the reference state, so that the force remains
/// minus the gradient of `elastic_energy` for every pattern of broken bonds.
template <int Dim>
class BondNetwork {
  public:
    /// f [n] += Kelvin-Voigt bond forces [N; 2D: N/m]: the elastic law with bond_damping * (d e/dt) in the
    /// place of e, hence a stress of bond_damping * stiffness * strain rate, for all moduli. The factors of
    /// the two ends enter as 1/m_i + 1/m_j: no net force or moment; none in rigid motion, rotation included;
    /// the power is -2 bond_damping times the energy of the rates, never positive.
    void add_damping_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const;

    /// Forces of up to eight grains at once, where Kernel::fast and `batches` are chosen: what
    /// add_internal_forces adds, after the bonds that are stretched too far have broken (cleared in `alive`,
    /// [n_bonds], empty: none can).
    BrokenBonds add_batch_forces(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive) const {
        return batch_.add_elastic_forces(batch, alive, limit_);
    }
    void add_batch_damping(const GrainBatch<Dim>& batch, std::span<std::uint8_t> alive) const {
        batch_.add_viscous_forces(batch, alive, material_.bond_damping);
    }

    /// f [n] += derivative of the internal forces at the reference state along u [n] [m], at scale 1.
    void add_linear_forces(std::span<const Vec<Dim>> u, std::span<Vec<Dim>> f) const;

    /// [J; 2D: J/m]
    double elastic_energy(const GrainView<Dim>& grain) const;

    /// Clears alive [n_bonds], read by its lowest bit, where the stretch |y|/(s xi) - 1 is beyond
    /// `break_limit` and the bond is none of `kept`; never sets it. Number newly broken.
    int break_bonds(const GrainView<Dim>& grain, std::span<std::uint8_t> alive) const;

    /// The same where BreakLimit::by_work, by the law of bond_energy.hpp; `alive`: the bytes of grain.alive.
    int break_by_energy(const GrainView<Dim>& grain, std::span<BondWork> works,
                        std::span<std::uint8_t> alive) const;

    /// damage [n] = volume of the broken part of the family over that of the whole family, in [0, 1]; family:
    /// what the cracks of the start have left of it, so that a notch is no damage.
    void compute_damage(const GrainView<Dim>& grain, std::span<double> damage) const;

    /// stretch [n] = max_j s_ij/s0 over all bonds of a node, broken ones included, those that cracks of the
    /// start cross and those that never break left out; s = |y|/(s xi) - 1 where bonds break in tension only,
    /// its absolute value where they break in both directions; where they break by energy, the root of
    /// an intact bond's work over the critical one. From 1 up the bond that has it is broken.
    /// Source: Z of Jha et al., J. Mech. Phys. Solids 151 (2021) 104376, eq 14, which takes |u_j - u_i|/xi
    /// for s and so grows when a grain turns; their code takes |s|.
    void compute_relative_stretch(const GrainView<Dim>& grain, std::span<double> stretch) const;

    /// stress [n * 4: xx, yy, xy, zz | n * 6: xx, yy, zz, xy, yz, xz] = Cauchy stress [Pa] of the non-local
    /// deformation gradient over the intact bonds,
    ///
    ///     F = (sum w y (x) xi V_j) (sum w xi (x) xi V_j)^-1
    ///
    /// (Silling et al., J. Elasticity 88 (2007) 151). For output only: the force law is not this
    /// one. Zero where the intact bonds no longer span space and so tell no gradient.
    void compute_stress(const GrainView<Dim>& grain, std::span<double> stress) const;

    /// Highest frequency [rad/s] of a free grain of scale 1, 0.5 to 0.6 % above the true one
    /// (stable_step.hpp).
    double max_frequency() const { return max_frequency_; }

    int n_bonds() const { return bonds_.n_bonds(); }   ///< undirected
    double horizon() const { return bonds_.horizon; }  ///< of scale 1 [m]
    const Bonds<Dim>& bonds() const { return bonds_; }
    const BondStiffness& stiffness() const { return stiffness_; }
    const BreakLimit& break_limit() const { return limit_; }

  protected:
    BondNetwork(const Shape<Dim>& shape, const Material& material, const KernelChoice& kernel);

    /// To be called once by the constructor of a model.
    void set_stiffness(BondStiffness stiffness);

    /// f [n] += what `density`(i, j, bond, y) [N/m^6; 2D: N/m^5] says of every directed bond, as a plain sum
    /// over all families; y = current bond vector of scale 1.
    template <class Density>
    void add_reference_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f, Density&& density) const;

    bool is_alive(const GrainView<Dim>& grain, int bond) const {
        return grain.alive.empty() || grain.alive[bond];
    }
    bool was_whole(const GrainView<Dim>& grain, int bond) const {
        return grain.whole.empty() || grain.whole[bond];
    }
    bool never_breaks(const GrainView<Dim>& grain, int bond) const {
        return !grain.kept.empty() && grain.kept[bond];
    }
    Vec<Dim> bond_vector(const GrainView<Dim>& grain, int i, int j) const {
        return (grain.x[j] - grain.x[i]) / grain.scale;
    }

    Material material_;
    KernelChoice kernel_;
    Bonds<Dim> bonds_;
    BreakLimit limit_;
    BondKernel<Dim> fast_;
    BondBatch<Dim> batch_;

  private:
    BondStiffness stiffness_;
    double max_frequency_ = 0.0;
};

template <int Dim>
template <class Density>
void BondNetwork<Dim>::add_reference_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f,
                                            Density&& density) const {
    const double back = std::pow(grain.scale, Dim - 1);
    for (int i = 0; i < bonds_.n_nodes(); ++i)
        for (const auto [j, b] : bonds_.family_of(i)) {
            if (!is_alive(grain, b)) continue;
            const Vec<Dim> y = bond_vector(grain, i, j);
            f[i] += back * bonds_.volume[i] * bonds_.volume[j] * density(i, j, b, y.norm()) * y.normalized();
        }
}

}  // namespace quern
