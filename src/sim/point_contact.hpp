// What acts on material points from outside: contact and loads, by way of the grid.
//
// Points move with u = P v (particles/material_points.hpp). Contact sees velocities of points and asks for a
// change c of them; the velocities v get P c, so that the work c.u of an impulse is that of P c, and u gets
// P P c, which is less than c where a surface shares its nodes with the inside. What is still missing after
// one solution of contact is asked for in the next step, which starts from the last one's c (P c of the same
// step, so that nothing is mapped twice):
//
//     u    = P (v* + P c_n-1)                   the trial velocities, with what contact asked for last
//     c_n  = contact(u - c_n-1)                 what it asks for now
//     v    = v* + P c_n
//
//     v*     velocities with the forces of this step [m/s]; c also of grains that are no points, P = 1
//     c_0    = 0; what half a kick leaves counts twice
//
// Contact solves c as if u would get it whole; u - c_n-1 + c_n is what u gets if c stays: where impulses
// change slowly nothing is left. Their change from step to step leaves an approach of (1 - P P) dc: a stiff
// spring, which gives back what it takes, where one solution without memory leaves a dashpot. A dozen
// solutions a step make the step three times as dear; what differs is in docs/material_points.md.
//
// `rule: seed` changes nodal velocities, not those of points; it asks in rounds,
//
//     v += w P c,    hence    u += w P P c,    w = (c, P P c)/(P P c, P P c),   1 <= w <= 2
//
//     ( , )  sum over the particles with their masses
//
// until what is added falls below `round_tolerance` of the first round, at most `max_rounds` times. Springs
// between nodes are forces: asked once, mapped as they are, they keep energy. Our own.
//
// Works: those of friction and walls are what contact books with the velocities that it sees; the normal work
// is the rest of what the velocities v gain.
#pragma once

#include "src/sim/scene.hpp"

namespace quern {

inline constexpr int max_rounds = 12;
inline constexpr double round_tolerance = 0.02;

/// What contact does to `trial.v`; the report holds until the next call. With `trial.listing` the contacts
/// are added to `list`.
template <int Dim>
const ContactReport<Dim>& add_point_impulses(Scene<Dim>& scene, const ContactScene<Dim>& view,
                                             const ContactTrial<Dim>& trial,
                                             std::vector<ContactPoint<Dim>>& list);

/// Forces [n] on points to what their velocities get of them [N; 2D: N/m].
template <int Dim>
void project_forces(Scene<Dim>& scene, std::vector<Vec<Dim>>& f);

}  // namespace quern
