// Continuum constants in the plane and in space, and the stress of a deformation gradient.
#pragma once

#include "grid/vec.hpp"
#include "particles/material.hpp"

namespace quern {

/// Number of stress components written: 2D xx, yy, xy, zz; 3D xx, yy, zz, xy, yz, xz.
template <int Dim>
inline constexpr int n_stress = Dim == 2 ? 4 : 6;

/// Resistance to a change of area (2D) or of volume (3D) [Pa]:
///
///     plane strain  K2 = K + G/3        plane stress  K2 = 9 K G/(3 K + 4 G)        space  K
///
/// so that equal in-plane strains eps cost the energy 2 K2 eps^2 per area (3D: 9/2 K eps^2 per volume).
template <int Dim>
double dilatational_modulus(const Material& material);

/// Whether the law of a material takes its constants from space: Constants::three_dimensional, see lps.hpp.
template <int Dim>
bool uses_space_constants(const Material& material) {
    return Dim == 3 ||
           (material.model != ForceModel::bond_based && material.constants == Constants::three_dimensional);
}

/// Cauchy stress [Pa] of a St Venant-Kirchhoff solid at the deformation gradient F [no unit]:
///
///     E = (F^T F - 1)/2,    S = (K - 2G/3) tr(E) 1 + 2 G E,    sigma = F S F^T / det F
///
/// Plane strain: E_zz = 0. Plane stress: E_zz from S_zz = 0, and det F includes the thinning. Writes
/// n_stress<Dim> values to `out`.
template <int Dim>
void compute_cauchy_stress(const Mat<Dim>& F, const Material& material, double* out);

}  // namespace quern
