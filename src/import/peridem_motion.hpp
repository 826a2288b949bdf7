// Displacements, forces and regions of PeriDEM as formulas of a deck.
#pragma once

#include "src/import/peridem_deck.hpp"

namespace quern {

/// The velocity of a displacement set, a formula an axis; "free" on an axis that it does not hold.
///
/// PeriDEM prescribes the displacement of a particle at X at t = 0 [m], with the numbers p of Time_Function
/// and s of Spatial_Function (particleULoading.cpp of 0.1.0 and later):
///
///     u = A(t) g(X) + B(t)
///     constant  A = p0               linear    A = p0 t
///     quadratic A = p0 t, B = p1 t^2 sin       A = p0 sin(pi p1 t)
///     g = 1, sin(pi s0 X_a) or s0 X_a, a = x or y
///     rotation: u = (R(p0 t) - 1)(X - x0), about z, x0 = (p1, p2)
///
/// A deck prescribes velocities at the current place x [m/s]:
///
///     v = A'(t) g(X) + B'(t)         where a is held, X_a = (x_a - B)/(1 + s0 A) for g = s0 X_a
///     rotation: v = (R(p0 dt) - 1)(x - x0)/dt
///
/// The chord of the rotation, not its tangent: steps of dt [s] then turn by p0 dt and keep the distance from
/// x0. Where `a` is free, x_a stands for X_a, with a note. Throws InputError for what has no velocity: a
/// constant other than 0, which would jump; sin of the axis along which it moves; a rotation that holds one
/// of x and y only.
std::vector<std::string> velocity_formulas(const PeridemSet& set, int dimension, bool fixed_step,
                                           ImportNotes& notes);

/// u(X, t) as above [m].
Numbers3 displacement(const PeridemSet& set, const Numbers3& X, double t);

/// Force per volume of a force set, a formula an axis [N/m^3]; the places are current ones, PeriDEM's those
/// at t = 0 (particleFLoading.cpp):
///
///     f = p0 T(t) g(x)
///     constant T = 1    linear T = t    sin T = sin(pi p1 t)
///     linear_step: T grows with t over p1, rests over p2, and again
///     linear_slow_fast: T = p2 t up to t = p1, then p3 t
///     g = 1, s0 hat(x_a) between the sides of the region, s0 sin(pi s0 x_a) or s0^2 x_a
std::vector<std::string> force_formulas(const PeridemSet& set, int dimension);

/// Not 0 inside the region, by the place at t = 0; sides are inside, within 1e-9 of its size.
std::string region_formula(const PeridemGeometry& region, int dimension);

/// Lower and upper corner; nothing for a type that is not known.
std::optional<std::array<Numbers3, 2>> bounding_box(const PeridemGeometry& geometry, int dimension);

}  // namespace quern
