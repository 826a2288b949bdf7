// What a run hands to its writers: flat arrays of any dimension, no simulation types.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace quern {

/// Particles at one time. Vector fields are [n * dimension], particle-major. Double where differences of
/// nearby numbers matter, float where seven digits tell all.
struct Frame {
    int dimension = 2;
    std::int64_t step = 0;
    double time = 0.0;                  ///< [s]
    std::vector<double> position;       ///< [n * dimension] [m]
    std::vector<float> velocity;        ///< [n * dimension] [m/s]
    std::vector<float> damage;          ///< [n] fraction of broken bonds
    std::vector<float> plastic_strain;  ///< [n] equivalent plastic strain; empty: nothing can yield
    std::vector<float> damage_z;  ///< [n] stretch of the worst bond over the critical; empty: none can break
    std::vector<float>
        stress;  ///< [n * (4 in 2D: xx, yy, xy, zz | 6 in 3D: xx, yy, zz, xy, yz, xz)] Cauchy [Pa]
    std::vector<std::int32_t> grain;     ///< [n]
    std::vector<std::int32_t> fragment;  ///< [n]; empty: none can break
    std::vector<double> volume;          ///< [n] reference volume [m^2 | m^3]
    std::size_t n() const { return grain.size(); }
};

/// Energy budget at one time [J; 2D: J/m]. Works are counted from the start of the clock.
/// kinetic + elastic + contact_elastic + gravity + damping + friction + contact_loss + fracture +
/// plastic + transfer_loss - external_work
/// - (its value at the start) = residual.
struct EnergyBudget {
    double kinetic = 0, elastic = 0, contact_elastic = 0, gravity = 0;  ///< stored
    double damping = 0, friction = 0, contact_loss = 0, fracture = 0, plastic = 0,
           transfer_loss = 0;  ///< dissipated; plastic: what hardening stores as well
    double external_work = 0;  ///< by loads, constraints and moving walls
    double residual = 0;       ///< what is missing
    double throughput = 0;     ///< largest stored plus dissipated energy that changed hands so far
};

struct HistoryRow {
    double time = 0;
    EnergyBudget energy;
    double momentum[3] = {0, 0, 0};          ///< [kg m/s]
    double angular_momentum[3] = {0, 0, 0};  ///< about the origin [kg m^2/s]; 2D: component 2
    std::int64_t broken_bonds = 0, fragments = 0, debris = 0;  ///< debris: pieces
};

struct GrainRow {
    double time = 0;
    int grain = 0;
    double position[3] = {0, 0, 0}, velocity[3] = {0, 0, 0};
    double angle = 0;             ///< about z, unwrapped [rad]
    double omega = 0;             ///< about z [rad/s]
    double force[3] = {0, 0, 0};  ///< contact force, mean since the row before [N]
};

/// A wall, a constraint, or a held grain with `wall: true`.
struct ReactionRow {
    double time = 0;
    std::string name;                    ///< of the wall, "constraints[0]", "grains[0]"
    double position[3] = {0, 0, 0};      ///< point of the wall; centre of the particles held [m]
    double displacement[3] = {0, 0, 0};  ///< since the start [m]
    double force[3] = {0, 0, 0};         ///< received from the grains, mean since the row before [N]
    double moment[3] = {0, 0, 0};        ///< of it about the origin [N m]; 2D: component 2
    double work = 0;                     ///< done on the grains since the start [J]
};

/// A piece of a grain, or a grain that could break.
struct FragmentRow {
    double time = 0;
    std::int64_t fragment = 0, grain = 0, parent = -1;  ///< parent -1: as placed
    double born = 0;                                    ///< [s]
    std::int64_t born_step = 0, particles = 0;
    double mass = 0;                                          ///< [kg; 2D: kg/m]
    double position[3] = {0, 0, 0}, velocity[3] = {0, 0, 0};  ///< of the centre of mass
    double omega[3] = {0, 0, 0};                              ///< rate of rotation [rad/s]; 2D: component 2
    double stress[6] = {0, 0, 0, 0, 0, 0};                    ///< mean, components as in Frame [Pa]
    double damage = 0;                                        ///< mean fraction of broken bonds
};

/// A column of a table of numbers.
struct TableColumn {
    std::string name, unit;
    std::vector<std::string> words = {};  ///< what cells 0, 1, ... stand for; below 0: nothing
};

/// A table that grows with the frames: NAME.csv, and /observed/NAME in results.h5.
struct TableLayout {
    std::string name;
    std::vector<TableColumn> columns;
};

/// Cells of some rows of a table, row after row.
using TableRows = std::vector<double>;

struct Summary {
    std::string version, title, deck_hash, state_hash,
        outcome,       ///< "done", "interrupted", "failed: ..."
        instructions;  ///< of the batches of grains: "avx512", "avx2", "plain"
    int dimension = 2, threads = 1;
    std::int64_t steps = 0, n_particles = 0, n_bonds = 0, n_grains = 0;
    double simulated_time = 0, time_step = 0, stable_step = 0;
    double wall_seconds = 0, ns_per_particle_step = 0, peak_memory_bytes = 0;
    std::vector<std::pair<std::string, double>> stages;  ///< seconds a stage, in the order of the step
    double writer_seconds = 0;                           ///< spent writing, beside the steps
    /// Contact nodes, pairs with a row, sweeps and searches, mean of a step.
    std::vector<std::pair<std::string, double>> contact_per_step;
    std::vector<ReactionRow> reactions;  ///< at the end
    std::vector<FragmentRow> fragments;  ///< at the last frame
    EnergyBudget energy;
    double residual_relative = 0;       ///< |residual| / throughput, largest over the run
    double momentum_error_linear = 0;   ///< |p - p0 - impulses| / momentum scale, largest over the run
    double momentum_error_angular = 0;  ///< no number on periodic axes, which are no frame that may turn
    std::vector<std::pair<std::string, std::int64_t>> warnings;  ///< text (with the first step), count
};

/// How far the files of a run have come: what lies behind is not of a run that goes on from here.
struct ResultPosition {
    std::int64_t n_frames = 0;
    std::int64_t history_bytes = 0, grains_bytes = 0, reactions_bytes = 0;
    std::int64_t xdmf_bytes = 0, pvd_bytes = 0;  ///< without the closing tags
    std::int64_t fragments_bytes = 0;
    std::vector<std::int64_t> tables_bytes = {};  ///< of each TableLayout
};

}  // namespace quern
