// The largest time step of an explicit scheme, from the highest frequency of the linearised grain.
#pragma once

#include <functional>
#include <vector>

namespace quern {

/// Highest natural frequency omega [rad/s] of  M u'' = -K u  by the Lanczos method, never below the Ritz
/// value: the square root of (largest Ritz value + its residual), which bounds the eigenvalue it has found.
///
///     add_force(u, f): f [n_unknowns] += -K u, K symmetric and positive semi-definite
///     mass [n_unknowns]: lumped, > 0
///
/// Iterates until the residual is below 1 % of the Ritz value (0.5 % of omega), at most 200 times; the start
/// vector is a fixed pseudo-random one. The margin on omega is therefore between 0 and 0.5 %.
/// Source: Golub & Van Loan, Matrix Computations, 4th ed., 10.1 (Lanczos) and 10.1.4 (residual bound).
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
/// Source: Belytschko, Liu, Moran, Nonlinear Finite Elements, 2nd ed., eq. 6.2.15 (stiffness-proportional).
double critical_step(double omega, double bond_damping);

}  // namespace quern
