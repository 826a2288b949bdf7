// Stabilised correspondence: peridynamic grains with the stress of a continuum law, elastic or plastic.
#pragma once

#include "particles/bond_network.hpp"
#include "particles/von_mises.hpp"

namespace quern {

/// Least G_i/G of the stabilisation.
inline constexpr double least_secant = 0.02;

/// Non-ordinary state-based peridynamics by correspondence, with the law of von_mises.hpp and Silling's
/// stabilisation:
///
///     F_i  = (sum_j w y (x) xi V_j) K_i^-1,      K_i = sum_j w xi (x) xi V_j
///     P_i  = tau(F_i, history) F_i^-T                                              [Pa]
///     z_ij = y - F_i xi                          what is not uniform in the family  [m]
///     T_ij = w (P_i K_i^-1 xi + g_i z_ij),       g_i = chi n G_i/m_i               [N/m^6; 2D: N/m^5]
///     G_i  = max(G/(1 + 3 G alpha_i/(sigma_y + H alpha_i)), G/50)                  [Pa]
///     f_i  = sum_j (T_ij - T_ji) V_i V_j
///     E    = sum_i V_i (W(F_i, history) + g_i/2 sum_j w |z_ij|^2 V_j)
///
///     y = x_j - x_i, xi = X_j - X_i [m];  w influence [-];  V volume;  m_i = sum_j w |xi|^2 V_j [m^4 | m^5]
///     K_i shape tensor [m^4 | m^5];  G shear modulus;  alpha plastic strain;  n = 2 (plane strain) | 3
///     chi = Material::stabilization [-]
///
/// f is the exact gradient of E at constant history. Uniform strains are exact at every node, faces included;
/// moments balance since sum_j w z xi V_j = 0.
///
/// G_i is the secant shear modulus of the law in proportional straining. z is zero in uniform strain, but
/// grows with gradients of plastic strain, and with the elastic G a bent bar would harden for ever by it.
/// The bound of a fiftieth holds corners together whose family is a quarter of a ball: without it one that
/// had flowed to alpha = 11 turned inside out (docs/plasticity.md). What a falling g_i sets free of E is
/// plastic work; by the mean of |z|^2 over the step, to second order.
///
/// Source: Silling et al., J. Elasticity 88 (2007) 151; Silling, Comput. Methods Appl. Mech.
/// Engrg. 322 (2017) 42. Differs: the stiffness of the stabilisation is chi n G_i/m_i of the
/// node's own family in the place of a micromodulus over the whole ball, so that it is even at faces, and it
/// goes by the secant modulus. What chi does: docs/plasticity.md.
///
/// Total Lagrangian: families are those of the reference. These materials do not break: a lost bond would
/// change K_i under the plastic strain that has been found with it.
template <int Dim>
class Correspondence : public BondNetwork<Dim> {
  public:
    /// Throws InputError for a family that cannot carry load, or for moduli or density that are not positive.
    Correspondence(const Shape<Dim>& shape, const Material& material, const KernelChoice& kernel = {});

    /// f [n] += internal forces [N; 2D: N/m] of the stress that follows from grain.plastic at this position.
    void add_internal_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const;

    /// The same, and plastic [n], of which grain.plastic is a view, becomes that of this position. Plastic
    /// work [J; 2D: J/m]. Called once more at the position, neither forces nor strain change but by
    /// round-off.
    double flow(const GrainView<Dim>& grain, std::span<PlasticStrain<Dim>> plastic,
                std::span<Vec<Dim>> f) const;

    /// [J; 2D: J/m] of the plastic strain as it is.
    double elastic_energy(const GrainView<Dim>& grain) const;

    /// stress [n * n_stress] = Cauchy stress tau/J [Pa] of the plastic strain as it is.
    void compute_stress(const GrainView<Dim>& grain, std::span<double> stress) const;

    /// f [n] += derivative of the internal forces at the unstrained reference along u [n] [m], at scale 1.
    void add_linear_forces(std::span<const Vec<Dim>> u, std::span<Vec<Dim>> f) const;

    double max_frequency() const { return max_frequency_; }  ///< as BondNetwork's
    const VonMises& law() const { return law_; }

  private:
    /// What a node gives to its bonds: force of a bond = c ((B_i + B_j) xi + (g_i + g_j) y).
    struct NodeForce {
        double B[Dim * Dim];  ///< by columns
        double g;
    };

    /// sum [n] = sum_j c z (x) xi and sum_j c |z|^2 of the bond differences of z.
    void sum_outer(std::span<const Vec<Dim>> z, std::vector<NodeForce>& sum) const;
    Mat<Dim> gradient(const NodeForce& sum, int i) const;
    NodeForce node_force(const Mat<Dim>& P, const Mat<Dim>& F, double g, int i) const;
    double softening(double alpha) const;  ///< G_i/G
    void add_bond_forces(std::span<const Vec<Dim>> z, const std::vector<NodeForce>& node, double factor,
                         std::span<Vec<Dim>> f) const;
    template <class Visit>
    double evaluate(const GrainView<Dim>& grain, std::span<Vec<Dim>> f, Visit&& visit) const;

    VonMises law_;
    std::vector<double> c_;          // [n_bonds] w V_i V_j
    std::vector<Vec<Dim>> xi_;       // [n_bonds]
    std::vector<Mat<Dim>> inverse_;  // [n] (V_i K_i)^-1
    std::vector<double> g_;          // [n] g_i
    double max_frequency_ = 0.0;
};

}  // namespace quern
