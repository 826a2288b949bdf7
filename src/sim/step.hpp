// One time step: leapfrog, with contact between kick and drift.
//
//     v*        = v(n-1/2) + dt f(x(n)) / m          kick with the forces of this position
//     v(n+1/2)  = contact(v*, x(n))                  impulses, nothing moves
//     x(n+1)    = x(n) + dt v(n+1/2)                 drift
//
// Material points move with u(n+1/2), v(n+1/2) by way of the grid, and their stress follows (particles/
// material_points.hpp).
//
// One kick and one drift a step: a body without forces moves by v dt. The clock starts with half a kick, so
// that the velocity given at t = 0 is that of t = 0. Prescribed velocities are taken at t(n+1/2): what they
// move goes where the formula says, exactly if its velocity is linear in time, else within dt^2 (a(t) -
// a(0))/24, a acceleration.
#pragma once

#include <cstdint>

#include "src/sim/scene.hpp"

namespace quern {

/// Seconds spent in each stage of the step, in its order.
struct StageTimes {
    double internal_forces = 0, loads = 0, kick = 0, contact = 0, points = 0, drift = 0, output = 0;
};

/// Works done on the particles since the clock started, up to the middle of the last step [J; 2D: J/m], and
/// what the step at hand adds: at a time n half of it has happened.
template <int Dim>
struct Ledger {
    struct Entry {
        double damping = 0, load = 0, constraint = 0, normal = 0, friction = 0, wall = 0, fracture = 0,
               plastic = 0, transfer = 0;
        Vec<Dim> impulse = Vec<Dim>::Zero();   ///< from outside [N s]
        Spin<Dim> moment = Spin<Dim>::Zero();  ///< about the origin [N m s]
        Entry& operator+=(const Entry& other);
    };
    Entry past;                              ///< up to n-1/2
    Entry now;                               ///< the step at hand
    double damping_half = 0, load_half = 0;  ///< half of this step's work, taken with v(n-1/2)
    double kinetic = 0;                      ///< at time n [J]
    double contact_elastic = 0;              ///< at time n [J]
};

/// What a holder (a wall, a constraint, all that holds a grain with `wall: true`) receives from the grains,
/// and what it does to them. That of a constraint is all that it takes to move the particles as prescribed:
/// contact, forces inside the body, weight, loads, inertia, with the other sign.
template <int Dim>
struct Reaction {
    Vec<Dim> impulse = Vec<Dim>::Zero();   ///< received since it was last zeroed [N s; 2D: N s/m]
    Spin<Dim> moment = Spin<Dim>::Zero();  ///< of it about the origin [N m s; 2D: N s]
    double work = 0.0;                     ///< done on the grains up to n-1/2 [J; 2D: J/m]
    double work_now = 0.0;                 ///< in the step at hand
};

template <int Dim>
struct StepContext {
    double dt = 0.0;
    double time = 0.0;  ///< of the positions [s]
    std::int64_t step = 0;
    bool first = true;  ///< the next kick is half a kick
    Ledger<Dim> ledger;
    StageTimes stages;
    std::vector<Vec<Dim>> grain_impulse;  ///< [n_grains] contact impulse since it was last zeroed [N s]
    /// Of the walls, the constraints, and the held grains with `wall: true`, in this order.
    std::vector<Reaction<Dim>> reactions;
    double largest_speed = 0.0;  ///< of the particles, with this step's forces, before contact [m/s]
    std::int64_t unconverged = 0, first_unconverged = -1;
    /// Searches whose contact springs ask for a smaller step, and the smallest such step [s].
    std::int64_t unstable = 0, first_unstable = -1;
    double least_stable_step = std::numeric_limits<double>::infinity();
    std::int64_t newly_broken = 0;
    /// Share of this step's works that has happened at the time of the positions: the first kick starts
    /// there.
    double part_done() const { return first ? 0.0 : 0.5; }

    std::int64_t contact_nodes = 0, contacts = 0, sweeps = 0, searches = 0;  ///< summed over the steps

    bool listing = false;                         ///< the next kick lists its contacts
    std::vector<ContactPoint<Dim>> contact_list;  ///< of the last kick that did; positions in Scene::grains
    double kick_time() const { return first ? 0.5 * dt : dt; }  ///< for which the forces of a kick act [s]
};

/// At time 0, nothing done yet.
template <int Dim>
StepContext<Dim> make_context(const Scene<Dim>& scene, double dt);

/// Forces and contact at the present position: velocities become those of n+1/2; nothing moves.
template <int Dim>
void kick(Scene<Dim>& scene, StepContext<Dim>& now);

/// Moves particles and walls by dt. Throws SimulationError naming grain, particle and step if a particle has
/// left the grid or is no number.
template <int Dim>
void drift(Scene<Dim>& scene, StepContext<Dim>& now);

}  // namespace quern
