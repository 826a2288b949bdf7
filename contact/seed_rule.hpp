// The seed rule: each grain's nodal velocity against that of the centre of mass (Bardenhagen, Brackbill,
// Sulsky 1998, eqs 12-24).
//
//     v_a = sum_A m_a^A v_a^A / sum_A m_a^A ;   n^A outward, from the gradient of the quadratic-spline
//     density if (v^A - v).n^A > 0:   v~^A = v^A - v_n (n + mu' t),   v_n = (v^A - v).n^A,  mu' = min(mu,
//     |v_t|/v_n)
//
// One sweep over grains, no iteration. Each grain has a normal of its own, so momentum is not conserved
// exactly. Where materials meet in several pairs, mu is the mean over the other grains, weighted by mass. A
// wall acts as a grain of infinite mass on nodes at and behind its plane, after the grains.
#pragma once

#include <vector>

#include "contact/contact_list.hpp"
#include "contact/contact_nodes.hpp"

namespace quern {

/// Changes the nodal velocities of the slots [n_slots] [m/s]; adds works and impulses to `report`.
/// `nodal_before`: the slots' velocities at the start of the step.
template <int Dim>
void apply_seed_rule(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                     std::vector<Vec<Dim>>& nodal, const std::vector<Vec<Dim>>& nodal_before,
                     ContactReport<Dim>& report);

/// Appends the contacts that the rule finds with these velocities, as contact_list.hpp says.
template <int Dim>
void list_seed_contacts(const ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene,
                        const std::vector<Vec<Dim>>& nodal_trial, std::vector<ContactPoint<Dim>>& points);

}  // namespace quern
