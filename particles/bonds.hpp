// The bonds of one shape: who is joined to whom, how strongly, and how full each family is.
//
// Built once for a shape and a material, then read only and shared by all grains of both.
#pragma once

#include <span>
#include <vector>

#include "particles/material.hpp"
#include "particles/shape.hpp"

namespace quern {

/// One member of a node's family.
struct Neighbor {
    int node;
    int bond;  ///< index of the undirected bond to it
};

/// Reference bonds of a shape at scale 1. Nodes are joined when 0 < xi <= horizon = horizon_ratio dx, or the
/// length that the material gives; with HorizonRim::excluded when xi < horizon. The horizon of a grain of
/// scale s is s times that of its shape, so that both have the same bonds.
///
///     w_ij    = influence(xi/horizon) beta_ij lambda_ij                         no unit
///     m_i     = sum_j w_ij xi^2 V_j                                             [m^4 | m^5]
///     beta    = 1, or with VolumeCorrection::linear  min(1, (horizon + h/2 - xi)/h)
///               h the smallest distance of two nodes of the shape               [m]
///     lambda  = 1, or with SurfaceCorrection::volume  2 V0 / (Vf_i + Vf_j)
///     Vf_i    = sum_j V_j, family volume; V0 that of a full family              [m^2 | m^3]
///
/// beta is the share of a cell of width h that lies within the horizon. The public PeriDEM code has it (in m,
/// theta and force, hence in w here), the paper of Jha et al., J. Mech. Phys. Solids 151 (2021) 104376, has
/// not. That code gives every grain the horizon of its material, whatever its scale; here it scales.
///
/// Source of lambda: Le & Bobaru, Comput. Mech. 61 (2018) 499, "volume method".
/// Differs: V0 is the mean over the bulk families of the shape itself, so that a lattice has lambda = 1
/// inside. Bulk: at least one horizon below the true surface, by Shape::surface. A shape too thin to have
/// such a node falls back on the integrals over the ball.
///
/// What lambda does, measured (plane, cone, horizon 3.015 dx; tests/particles/force_elasticity.cpp): equal
/// strains of a block of 20 x 20 nodes miss 12 % of their bond-based energy without it and 0.7 % with it; a
/// strip 16 nodes wide pulled along its faces is 3.6 % soft without and 5.9 % stiff with it (the bonds a face
/// lacks point mostly across the pull). Lps, which normalises every family by itself, is 6.1 % stiff there,
/// and 7.2 % with lambda: the correction is for bond-based materials.
template <int Dim>
struct Bonds {
    double horizon = 0.0;             ///< [m]
    std::vector<Vec<Dim>> X;          ///< [n] reference positions [m]
    std::vector<double> volume;       ///< [n] nodal volumes V [m^2 | m^3]
    std::vector<int> first;           ///< [n + 1] bonds first[i] .. first[i + 1] join i to partners j > i
    std::vector<int> partner;         ///< [n_bonds] j, ascending within a row
    std::vector<double> length;       ///< [n_bonds] xi [m]
    std::vector<double> weight;       ///< [n_bonds] w, no unit
    std::vector<int> family_first;    ///< [n + 1] rows of `family`
    std::vector<Neighbor> family;     ///< [2 n_bonds] every bond at both of its ends
    std::vector<double> moment;       ///< [n] m, the sum over the node's own family [m^4 | m^5]
    double bulk_moment = 0.0;         ///< mean of m over the bulk families, lambda left out [m^4 | m^5]
    double bulk_family_volume = 0.0;  ///< V0 [m^2 | m^3]

    int n_nodes() const { return static_cast<int>(X.size()); }
    int n_bonds() const { return static_cast<int>(partner.size()); }
    std::span<const Neighbor> family_of(int i) const {
        return {family.data() + family_first[i], family.data() + family_first[i + 1]};
    }
};

/// Throws InputError when nodes coincide, when a node has fewer than Dim + 1 neighbours or all of them on one
/// line (2D) or plane (3D): such a node could move without a force. Cost O(n) by a cell list.
template <int Dim>
Bonds<Dim> make_bonds(const Shape<Dim>& shape, const Material& material);

}  // namespace quern
