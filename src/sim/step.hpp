// One time step: leapfrog, with contact between kick and drift.
//
//     v*        = v(n-1/2) + dt f(x(n)) / m          kick with the forces of this position
//     v(n+1/2)  = contact(v*, x(n))                  impulses, nothing moves
//     x(n+1)    = x(n) + dt v(n+1/2)                 drift
//
// One kick and one drift a step: a body without forces moves by v dt. The clock starts with half a kick, so
// that the velocity given at t = 0 is that of t = 0.
#pragma once

#include <cstdint>

#include "src/sim/scene.hpp"

namespace quern {

/// Seconds spent in each stage of the step, in its order.
struct StageTimes {
    double internal_forces = 0, loads = 0, kick = 0, contact = 0, drift = 0, output = 0;
};

/// Works done on the particles since the clock started, up to the middle of the last step [J; 2D: J/m], and
/// what the step at hand adds: at a time n half of it has happened.
template <int Dim>
struct Ledger {
    struct Entry {
        double damping = 0, load = 0, constraint = 0, normal = 0, friction = 0, wall = 0, fracture = 0,
               transfer = 0;
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

template <int Dim>
struct StepContext {
    double dt = 0.0;
    double time = 0.0;  ///< of the positions [s]
    std::int64_t step = 0;
    bool first = true;  ///< the next kick is half a kick
    Ledger<Dim> ledger;
    StageTimes stages;
    std::vector<Vec<Dim>> grain_impulse;  ///< [n_grains] contact impulse since it was last zeroed [N s]
    std::vector<Vec<Dim>> wall_impulse;   ///< [n_walls]
    double largest_speed = 0.0;           ///< of the particles, with this step's forces, before contact [m/s]
    std::int64_t unconverged = 0, first_unconverged = -1;
    /// Searches whose contact springs ask for a smaller step, and the smallest such step [s].
    std::int64_t unstable = 0, first_unstable = -1;
    double least_stable_step = std::numeric_limits<double>::infinity();
    std::int64_t newly_broken = 0;
    /// Share of this step's works that has happened at the time of the positions: the first kick starts
    /// there.
    double part_done() const { return first ? 0.0 : 0.5; }

    std::int64_t contact_nodes = 0, contacts = 0, sweeps = 0, searches = 0;  ///< summed over the steps
};

/// Forces and contact at the present position: velocities become those of n+1/2; nothing moves.
template <int Dim>
void kick(Scene<Dim>& scene, StepContext<Dim>& now);

/// Moves particles and walls by dt. Throws SimulationError naming grain, particle and step if a particle has
/// left the grid or is no number.
template <int Dim>
void drift(Scene<Dim>& scene, StepContext<Dim>& now);

}  // namespace quern
