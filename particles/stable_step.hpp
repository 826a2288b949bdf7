// The largest time step of an explicit scheme, from the highest frequency of the linearised grain.
#pragma once

#include <functional>
#include <vector>

namespace quern {

/// Highest natural frequency omega [rad/s] of  M u'' = -K u  by the Lanczos method, with a margin of 0.5 %:
///
///     omega = 1.005 sqrt(top + residual)
///
///     add_force(u, f): f [n_unknowns] += -K u, K symmetric and positive semi-definite
///     mass [n_unknowns]: lumped, > 0
///
/// Iterates until the residual is below 0.2 % of the largest Ritz value `top` (0.1 % of omega), at most 200
/// times, from a fixed pseudo-random vector. The residual bounds the eigenvalue that has been found; the
/// margin is for one close above it that has not (seen: 0.27 % with a residual of 1 %, none with this one).
/// Source: Golub & Van Loan, Matrix Computations, 4th ed., ch. 10.
/// Differs from plain power iteration, which needs several times as many products on the crowded top of the
/// spectrum.
double max_frequency(
    const std::vector<double>& mass,
    const std::function<void(const std::vector<double>& u, std::vector<double>& f)>& add_force);

/// Largest stable step [s] of leapfrog when the frequency omega [rad/s] is damped by Kelvin-Voigt bonds of
/// time tau [s] whose rate is taken half a step late:
///
///     dt = 2/omega (sqrt(1 + zeta^2) - zeta),    zeta = tau omega/2
///
/// Source: Belytschko, Liu, Moran, Nonlinear Finite Elements, ch. 6 (stiffness-proportional damping).
double critical_step(double omega, double bond_damping);

}  // namespace quern
