// Stress of grains by the forces of their contacts.
//
//     sigma_g = (1/V_g) sum_c sym(f_c (x) (x_c - c_g)),   sym(A) = (A + A^T)/2
//     sigma   = (1/V) sum_g phi_g V_g sigma_g             mean of a region, pores included
//
//     sigma [Pa; 2D: N/m per m], tension positive, as the stress of particles; f_c force that the grain
//     receives [N; 2D: N/m], x_c its point, c_g centre of mass [m], V_g volume of the grain, V of the region
//     [m^3; 2D: m^2], phi_g part of the grain that lies in it
//
// Source: Love, A Treatise on the Mathematical Theory of Elasticity, 4th ed. (1927), note B; Weber, Bull.
// Liaison Ponts et Chaussees 20 (1966) 1; Christoffersen, Mehrabadi, Nemat-Nasser, J. Appl. Mech. 48 (1981)
// 339, eq 2.12, where the sum goes over contacts with the branch from centre to centre: the same for grains
// that lie wholly inside. Exact for a grain whose forces and moments balance. One that is accelerated lacks
// (1/V_g) of the sum of m a (x) (x - c_g); weight does not matter, it acts at c_g. The antisymmetric part
// that is left out is half the moment on the grain.
#pragma once

#include <span>
#include <vector>

#include "contact/contact_list.hpp"

namespace quern {

/// [n_grains] stress of each; `centres` [m] and `volumes` [m^3; 2D: m^2], one a grain.
template <int Dim>
std::vector<Mat<Dim>> contact_stress(std::span<const ContactPoint<Dim>> points, double dt,
                                     std::span<const Vec<Dim>> centres, std::span<const double> volumes);

/// Principal values of a symmetric tensor, and in the plane the angle of the axis of the first.
struct Principal {
    double first = 0.0, last = 0.0;  ///< largest and smallest
    double angle = 0.0;              ///< 2D: from x, in (-pi/2, pi/2] [rad]; 3D: 0
    double difference() const { return first - last; }
};
Principal principal(const Mat<2>& tensor);
Principal principal(const Mat<3>& tensor);

}  // namespace quern
