// When a bond breaks: the critical stretch, as given or from a fracture energy.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "particles/bonds.hpp"
#include "particles/material.hpp"

namespace quern {

/// A bond of stretch s = |y|/xi - 1 breaks for good where s > s0; with BreaksIn::both where |s| > s0.
///
/// Given as `critical_stretch`, s0 is that of every grain. From a fracture energy Gc [J/m^2] and a horizon d
/// [m], with the integrals over xi from 0 to d:
///
///     energy_balance  space  s0^2 = (4 Gc/(9 K))  int w xi^4 / int w xi^5
///                     plane  s0^2 = (pi Gc/(4 K2)) int w xi^3 / int w xi^4
///     peridem                s0^2 = Gc/((3 G + (3/4)^4 (K - 5 G/3)) d)
///
///     s0 critical stretch, w influence [-]     K2 resistance to a change of area, 9 K/4 with the constants
///     K, G moduli [Pa]                         of space in the plane (lps.hpp)
///
/// With Calibration::discrete the quotient of the integrals is that of the sums over the bonds of a shape,
///
///     int w xi^3 / int w xi^4  ->  sum w xi^2 V / sum w xi^3 V      (space: xi^4 / xi^5, the same sums)
///
/// over the families with 0.999 of the bulk's m or more. The mean of the energy over all orientations of
/// the plane is then exactly Gc on any stencil, since |cos| averages to 2/pi | 1/2; the lattice keeps its
/// anisotropy (cone, horizon 3.015 dx: 0.978 to 1.015 Gc in the plane, 0.965 to 0.995 in space along five
/// directions). The integrals would be off by 0.977 and 0.982 on top.
///
/// energy_balance: the energy of all bonds across a plane, each stretched to s0, is Gc; exact at the Poisson
/// ratio of springs, where the LPS has no energy of dilatation. d is that of the grain, s times that of its
/// shape, so that s0 falls as s^(-1/2) and grains of every size have Gc.
///
/// BreaksBy::energy takes G alone: 5 G/3 for K, 2 G for K2, 15 G/4 with the constants of space in the plane.
/// The stretch is then that of springs of the same G and sets the work at which a bond breaks
/// (bond_energy.hpp).
///
/// A grain with a strength f (weibull.hpp) breaks at f s0.
///
/// Sources: Silling & Askari, Comput. Struct. 83 (2005) 1526, eqs 26, 27 (w = 1/r; other w and the plane by
/// the same integral; discrete sums: as the moduli in lps.hpp); Jha et al., J. Mech. Phys. Solids 151 (2021)
/// 104376, eq 10. Differs: the public PeriDEM code compares |s| with s0 with a relative tolerance of 1e-5;
/// none here.
struct BreakLimit {
    double stretch = std::numeric_limits<double>::infinity();  ///< s0 of a grain of scale 1
    bool by_energy = false;                                    ///< s0 falls as scale^(-1/2)
    bool in_compression = false;
    bool by_work = false;  ///< s0 is no bound of stretches, but sets the work that breaks (bond_energy.hpp)

    bool bounds_stretch() const { return std::isfinite(stretch) && !by_work; }
    double stretch_of(double scale, double strength = 1.0) const {
        return strength * (by_energy ? stretch / std::sqrt(scale) : stretch);
    }
    /// Longest and shortest |y|/xi of a bond of a grain of this scale and strength.
    double longest(double scale, double strength = 1.0) const { return 1.0 + stretch_of(scale, strength); }
    double shortest(double scale, double strength = 1.0) const {
        return in_compression ? std::max(0.0, 1.0 - stretch_of(scale, strength)) : 0.0;
    }
};

/// By the integrals.
template <int Dim>
BreakLimit make_break_limit(const Material& material, double horizon);
/// As the calibration of the material says.
template <int Dim>
BreakLimit make_break_limit(const Material& material, const Bonds<Dim>& bonds);

}  // namespace quern
