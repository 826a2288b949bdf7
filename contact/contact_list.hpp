// What touches what in a step, and how hard: a list of points, and the resultant of each pair.
//
// A method of contact lists the impulses that it has given in its last step: a row of the grid, two nodes, a
// particle of debris. A user wants what two grains do to each other (k: points of a pair, all of one step):
//
//     F = sum J_k / dt             n = sum (J_k.n_k) n_k, to unit length
//     F_n = F.n                    F_t = F - F_n n
//     x = sum (J_k.n_k) x_k / sum J_k.n_k        slipping = sum over slipping k of J_k.n_k, over that of all
//
//     F force that the second one receives [N; 2D: N/m], J impulse [N s; 2D: N s/m], dt [s], n unit, from the
//     first to the second, x point [m]; `slipping` in [0, 1]
//
// Two grains that touch in several places are one pair, but across a periodic axis each image counts for
// itself. The pieces of one grain do not count. The moment of F at x is that of the J_k up to what they turn
// about x, so sums of moments (grain stress) take the points. Our own.
//
// Left out: the published dashpots between centres (centre_dashpots.hpp), which act on whole grains. With the
// seed rule every grain has an impulse of its own against all others of a node. It is split among them by
// their masses, as the mean velocity is, and a pair has half the difference of what the two received: action
// is reaction, and what the rule itself loses (contact/README.md) is missing in the sums.
#pragma once

#include <vector>

#include "contact/contact.hpp"

namespace quern {

/// An impulse of one step, at one point.
template <int Dim>
struct ContactPoint {
    int first = 0, second = 0;              ///< grains; second: -1 - wall for a wall
    Vec<Dim> at_first = Vec<Dim>::Zero();   ///< the point [m], next to the particles of the first,
    Vec<Dim> at_second = Vec<Dim>::Zero();  ///< and of the second: elsewhere only across a periodic axis
    Vec<Dim> normal = Vec<Dim>::Zero();     ///< unit, from first to second
    Vec<Dim> impulse = Vec<Dim>::Zero();    ///< that the second receives [N s; 2D: N s/m]
    bool slips = false;                     ///< friction is at its limit; always without friction
};

/// The resultant of the points of a pair.
template <int Dim>
struct PairForce {
    int first = 0, second = 0;                                           ///< as in ContactPoint
    Vec<Dim> at_first = Vec<Dim>::Zero(), at_second = Vec<Dim>::Zero();  ///< [m]
    Vec<Dim> normal = Vec<Dim>::Zero();
    double normal_force = 0.0;                     ///< F_n, on the second along the normal [N; 2D: N/m]
    Vec<Dim> tangential_force = Vec<Dim>::Zero();  ///< F_t, on the second [N; 2D: N/m]
    double slipping = 0.0;
    int n_points = 0;
};

/// Whether an impulse is at the limit of friction.
template <int Dim>
bool at_friction_limit(const Vec<Dim>& impulse, const Vec<Dim>& normal, double mu) {
    const double along = impulse.dot(normal);
    return (impulse - along * normal).norm() >= (1.0 - 1e-6) * mu * along;
}

/// Pairs in the order of their numbers, walls behind grains. `dt`: time in which the impulses were given;
/// `box`: edge lengths of the grid [m].
template <int Dim>
std::vector<PairForce<Dim>> pair_forces(std::vector<ContactPoint<Dim>> points, double dt,
                                        const Vec<Dim>& box);

}  // namespace quern
