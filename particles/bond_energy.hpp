// Breaking by energy: a bond breaks when the work done on it has reached its share of the fracture energy.
#pragma once

#include <span>

#include "particles/bond_kernel.hpp"
#include "particles/break_limit.hpp"

namespace quern {

/// With the force f = c e + k xi (g_i D_i + g_j D_j) of bond_kernel.hpp, the work done on a bond is
///
///     W   = sum over the steps of 1/2 (f + f') (e - e')        W >= Wc = 1/2 c (sG xi)^2 breaks,
///           and e > 0 unless bonds break in both directions
///
///     e extension [m], c stiffness [N/m; 2D: N/m^2]; k, xi, g, D as there           W, Wc [J; 2D: J/m]
///     f', e' at the step before, f' after what broke there [N; 2D: N/m]
///     sG    critical stretch of break_limit.hpp with the moduli of springs of the same G: 5 G/3 for K, 2 G
///           for K2
///
/// All for scale 1; a grain of scale s and strength f takes f sG/sqrt(s). The works of all bonds, broken ones
/// included, sum to round-off to what is stored and what has been set free: halves that part have set free
/// the sum of W over the bonds between them, at every Poisson ratio. Wc has no part of the dilatation: its
/// sum over the bonds across a unit of plane is Gc, in the mean over orientations exactly (break_limit.hpp).
/// Where g = 0 (springs) the rule is the critical stretch. Near a free surface Wc grows with c, which m of a
/// cut family makes stiffer: surfaces are no weaker than the inside.
///
/// W depends on the way, since f is no function of e alone: ahead of a crack the dilatation grows before the
/// extension does. Two rules without that memory were tried, 1/2 f e and the energy that a bond sets free at
/// fixed positions: halves that part release Gc with the second as well, but a crack in a strip begins to run
/// at 2.0 to 2.4 Gc at Poisson ratio 0.4 where it does at 1.35 at 0.25 (with W: 1.35). The price: a bond of a
/// body that turns under load or rings gathers +- W in every cycle in which f and e are out of phase.
///
/// Source: Foster, Silling & Chen, Int. J. Multiscale Comput. Eng. 9 (2011) 675 (work of the
/// force states over the extension, w_c). Differs: Wc
/// goes as w xi^2, so that it is a stretch for springs; their w_c = 4 Gc/(pi d^4) is the same for all bonds.
/// A bond does not break while it is compressed.
struct BondWork {
    double work = 0.0;       ///< W
    double extension = 0.0;  ///< e of the last step
    double force = 0.0;      ///< f of the last step, after what broke
};

/// Wc of a bond, s: f sG/sqrt(scale).
inline double critical_work(double c, double xi, double s) {
    return 0.5 * c * (s * xi) * (s * xi);
}

/// Carries `works` [n_bonds] on to the positions of the grain and clears the bits of the bonds that break
/// now, none of those that never do, in `alive`, which is the bytes of grain.alive. Number newly broken.
template <int Dim>
int break_by_energy(const Bonds<Dim>& bonds, const BondStiffness& stiffness, const BreakLimit& limit,
                    const GrainView<Dim>& grain, std::span<BondWork> works, std::span<std::uint8_t> alive);

}  // namespace quern
