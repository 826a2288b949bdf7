// Numbers of a contact network: coordination, rattlers, fabric, who carries the load.
//
//     Z   = mean of C_g over the grains            C_g pairs of grain g, walls included
//     Z_m = the same over the grains and pairs that are left when rattlers are taken away
//     R   = (1/N_c) sum_c n (x) n                  over pairs of two grains; trace 1, isotropic: 1/d
//
// A rattler has at most one pair; pairs of a rattler are none, so others may become rattlers, until all are
// found. (Without friction a grain needs more than two pairs to be held; that is not asked for.)
//
// Source: R: Satake, Proc. U.S.-Japan Sem. Continuum Mech. Stat. Approaches Mech. Granular Mater. (1978) 47;
// Oda, Soils Found. 22 (1982) 96. Z_m: Thornton, Geotechnique 50 (2000) 43, who takes away rattlers once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "contact/contact_list.hpp"

namespace quern {

struct Coordination {
    std::vector<int> pairs;             ///< [n_grains] C_g
    std::vector<std::uint8_t> rattler;  ///< [n_grains]
    std::vector<int> pairs_held;        ///< [n_grains] pairs without those of rattlers
};

/// `wall` [n_grains]: grains that stand for walls and are none of the network.
template <int Dim>
Coordination coordination(std::span<const PairForce<Dim>> pairs, std::span<const std::uint8_t> wall);

/// R of the pairs of two grains among those given; zero if there is none.
template <int Dim>
Mat<Dim> fabric(std::span<const PairForce<Dim>> pairs);

/// Smallest part of the grains that together carry half of the load, in (0, 0.5]; 0 if nothing is carried.
/// Loads below 0 carry nothing.
double part_with_half_the_load(std::vector<double> loads);

}  // namespace quern
