// Walls that press on the grains as hard as asked.
#pragma once

#include "contact/contact.hpp"
#include "src/deck/expression.hpp"

namespace quern {

/// A plate of mass M in a viscous guide, pushed along its normal:
///
///     M dw/dt = F(t) - R - M c w,   |w| <= w_max
///     w(n+1/2) = [w(n-1/2) (1 - c dt/2) + dt (F(t_n) - R(n-1))/M] / (1 + c dt/2)
///
///     w speed along the normal, towards the grains [m/s], F force asked for [N; 2D: N/m], R = -n.J/dt force
///     that the grains have put on it in the step before, J their impulse [N s; 2D: N s/m], c rate of the
///     guide [1/s], M [kg; 2D: kg/m].
///
/// Source: the numerical servo of Cundall and Strack, Geotechnique 29 (1979) 47, w = (F - R)/(M c), is the
/// limit of small M. Differs: impulses on the grid come in bursts of a step, which w would follow; the mass
/// takes their mean.
///
/// Stable: the grains answer with the force of a spring k, a step late. Growth by the lag is k dt/(2 M), so c
/// > k dt/M is enough, and M must be more than what moves with the wall within a step. By default M is the
/// mass of all grains and c = 2 v/H, critical damping of this mass on a body as high (H) and as stiff (v,
/// speed of sound) as a block of the stiffest material: a packing is softer, so the servo creeps to its force
/// within some 2 M c/k and does not swing. Without contact the wall goes at F/(M c).
///
/// The wall does its work as any moving wall does: it is in the work of walls, not of the plate or its guide.
struct Servo {
    Expression force;        ///< of t, over `per`
    double per = 1.0;        ///< area that a stress acts on [m^2; 2D: m]; 1 for a force
    double mass = 0.0;       ///< M
    double damping = 0.0;    ///< c
    double max_speed = 0.0;  ///< w_max
    double speed = 0.0;      ///< w of the last step
    double pressed = 0.0;    ///< R of the last step

    /// Goes on to w(n+1/2); `dt`: since the velocity before, half as long for the first.
    void steer(double time, double dt);
};

}  // namespace quern
