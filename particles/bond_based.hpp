// The micro-elastic solid: bonds as independent springs.
#pragma once

#include "particles/bond_network.hpp"

namespace quern {

/// Bond-based peridynamics, n = 2 (per metre of thickness) or n = 3.
///
///     F_i = sum_j C w e V_i V_j y/|y|,     W_i = 1/4 sum_j C w e^2 V_j
///     C   = 18 K/m (n = 3),  8 K2/m (n = 2)                                     [N/m^7; 2D: N/m^6]
///
///     y = x_j - x_i, xi = |X_j - X_i|, e = |y| - xi   [m]      w influence [-], V volume
///     K2 = K + G/3 (plane strain), 9 K G/(3 K + 4 G) (plane stress)
///
/// Springs fix the Poisson ratio: 1/4 in space and plane strain (G = 3K/5), 1/3 in plane stress (G = 3K/8).
/// The material must say so; K alone sets the stiffness.
///
/// Source: Silling, J. Mech. Phys. Solids 48 (2000) 175; Silling & Askari, Comput. Struct. 83 (2005) 1526,
/// whose constant micro-modulus per stretch (f = c s) is w = 1/r here. Differs: any influence
/// function.
///
/// Calibration. `discrete`: m is the mean of sum w xi^2 V over the bulk families of the shape (bonds.hpp), so
/// that a lattice has exactly K, and exactly G in the mean over all orientations (see Lps). `none`: m is the
/// integral over the continuous ball. Either way C is one number, so nodes with cut families are soft (half
/// the stiffness on a face); SurfaceCorrection::volume multiplies w by lambda of bonds.hpp against that.
template <int Dim>
class BondBased : public BondNetwork<Dim> {
  public:
    /// Throws InputError for a family that cannot carry load, for moduli or density that are not positive,
    /// and for a shear modulus more than 1 % from the one that springs have.
    BondBased(const Shape<Dim>& shape, const Material& material, const KernelChoice& kernel = {});

    /// f [n] += internal forces [N; 2D: N/m]
    void add_internal_forces(const GrainView<Dim>& grain, std::span<Vec<Dim>> f) const;

  private:
    double C_ = 0.0;
};

}  // namespace quern
