// What acts on material points from outside: contact and loads, by way of the grid.
//
// Points move with u = P v (particles/material_points.hpp). Contact sees u, asks for a change c of it, and
// the velocities get
//
//     v += w P c,    hence    u += w P P c,    w = (c, P P c)/(P P c, P P c),   1 <= w <= 2
//
//     c      what contact adds to u, of all particles [m/s]; P = 1 for those that are no points
//     ( , )  sum over the particles with their masses
//
// P P c is less than c, where a surface shares its nodes with the inside, so contact is asked again until
// what is added falls below `round_tolerance` of the first round, at most `max_rounds` times; w is the best
// step along c. P is symmetric: J.u = (P J).v, so the works that contact books with u are those of v, but for
// the rounds, whose sum is booked as it is. Springs between nodes are forces: asked once, mapped with w = 1,
// they keep energy. A list of contacts holds the impulses of all rounds, each times its w. Our own.
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
