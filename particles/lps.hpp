// The linear peridynamic solid: the default internal-force model.
#pragma once

#include "particles/bond_network.hpp"

namespace quern {

/// Ordinary state-based linear peridynamic solid, n = 2 (plane strain, plane stress; per metre of thickness)
/// or n = 3. Any Poisson ratio.
///
///     theta_i = (n/m_i) sum_j w xi e V_j
///     t_ij    = w/m_i [ (n Kn - a/n) theta_i xi + a e ]
///     F_i     = sum_j (t_ij + t_ji) V_i V_j y/|y|
///     W_i     = (Kn/2 - a/(2 n^2)) theta_i^2 + a/(2 m_i) sum_j w e^2 V_j
///
///     y = x_j - x_i, xi = |X_j - X_i|, e = |y| - xi   [m]      theta dilatation, in-plane in 2D [-]
///     w influence [-], V volume, m = sum_j w xi^2 V_j [m^4 | m^5]
///     n = 3: Kn = K, a = 15 G;  n = 2: Kn = K + G/3 (plane strain), 9 K G/(3 K + 4 G) (plane stress), a = 8
///     G
///
/// Constants::three_dimensional takes n = 3, Kn = K, a = 15 G in the plane as well, as Jha et al., J. Mech.
/// Phys. Solids 151 (2021) 104376, eqs 7 to 13, and the public PeriDEM code do. Then theta is 3/2 of the
/// in-plane dilatation, since sum w xi (xi.A.xi)/xi V averages to m/2 tr A and not to m/3 tr A, and of a
/// strain A
///
///     W = (K/2 - 5 G/6) (3/2 tr A)^2 + 15 G/16 ((tr A)^2 + 2 A:A) = 9 K/8 (tr A)^2 + 15 G/8 dev A : dev A
///
/// so the body has the area modulus 9 K/4 and the shear modulus 15 G/8. At K = 5 G/3 (Poisson ratio 1/4)
/// both are 15/8 of plane strain, and its waves are 1.37 times as fast.
///
/// W is Kn theta^2/2 plus the deviatoric energy a/(2m) sum w (e - theta xi/n)^2 V written out. With broken
/// bonds it is this form, not the deviatoric one, of which t is the exact gradient; it stays >= Kn theta^2/2.
///
/// Source: Silling et al., J. Elasticity 88 (2007) 151 (n = 3); Le, Chan, Schwartz, Int. J.
/// Numer. Meth. Eng. 98 (2014) 547 (n = 2). Differs: one form of the constants for both n; m may be
/// calibrated.
///
/// Calibration. `discrete`: m_i is the sum over the node's own bonds. A uniform dilatation then costs exactly
/// K at every node, and the mean over all orientations of the shear modulus is exactly G for any stencil,
/// since sum w (xi.A.xi)^2/xi^2 averages to 2 m/(n(n+2)) A:A for traceless A; what is left is lattice
/// anisotropy (2D, horizon 3.015 dx, cone: 0.964 and 1.036 G). `none`: m is the integral over the continuous
/// ball, so moduli are off by the quadrature error of the stencil and surface nodes are soft. With the
/// surface correction the factor lambda of bonds.hpp enters w everywhere, m_i included.
template <int Dim>
class Lps : public BondNetwork<Dim> {
  public:
    /// Throws InputError for a family that cannot carry load, or for moduli or density that are not positive.
    Lps(const Shape<Dim>& shape, const Material& material, const KernelChoice& kernel = {});

    /// f [n] += internal forces [N; 2D: N/m]
    void add_internal_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const;

  private:
    void add_printed_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const;

    std::vector<double> m_;  // [n] weighted volume in use
    double n_ = Dim;         // of the constants
    double a_ = 0.0;         // [Pa]
    double b_ = 0.0;         // n Kn - a/n [Pa]
};

}  // namespace quern
