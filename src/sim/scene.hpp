// Everything a step works on: grains, forces, contact, loads. Built once from a deck.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "contact/contact_method.hpp"
#include "particles/bond_energy.hpp"
#include "particles/grains.hpp"
#include "particles/material_points.hpp"
#include "particles/peridynamic_model.hpp"
#include "particles/union_batch.hpp"
#include "src/deck/deck.hpp"
#include "src/sim/fragments.hpp"
#include "src/sim/servo.hpp"

namespace quern {

/// Grains of one shape and one material, next to each other: one dispatch serves them all.
template <int Dim>
struct MaterialGroup {
    PeridynamicModel<Dim> model;
    int first_grain = 0, last_grain = 0;  ///< range [first, last)
    bool damped = false;
    bool breakable = false;       ///< bonds may break, or are missing from the start
    bool plastic = false;         ///< has an entry a particle in Scene::plastic
    bool breaks_by_work = false;  ///< by the law of particles/bond_energy.hpp
    bool batched = false;         ///< forces by batches of eight of its own, in the order of the grains
    double bond_damping = 0.0;    ///< [s]
    double density = 0.0;         ///< [kg/m^3]
};

/// Body force on some particles.
template <int Dim>
struct Load {
    std::vector<int> particles;
    bool per_mass = true;
    std::array<Expression, Dim> value;  ///< [m/s^2] or [N/m^3]
};

/// Prescribed velocity of some particles.
template <int Dim>
struct Constraint {
    std::vector<int> particles;
    std::vector<int> wall;  ///< [particles] place of their grain in Scene::held_walls; -1: it is none
    std::array<std::optional<Expression>, Dim> velocity;  ///< [m/s]
};

/// Forces of the present step [N; 2D: N/m] and velocities around it [m/s], one entry a particle.
template <int Dim>
struct StepArrays {
    std::vector<Vec<Dim>> internal, damping, load;
    std::vector<Vec<Dim>> v_before;  ///< velocity half a step back
    std::vector<Vec<Dim>> drift;     ///< flip coupling, material points: velocity that moves positions
    std::vector<Vec<Dim>> drift_before;
    std::vector<Vec<Dim>> wall_v_before;  ///< [n_walls] velocity half a step back
};

/// Velocities and their changes while contact acts on material points, point_contact.hpp [m/s], all [n].
template <int Dim>
struct PointContact {
    std::vector<Vec<Dim>> last, mapped;           ///< c, P c of the last step
    double part = 1.0;                            ///< of a whole step that they belong to
    std::vector<Vec<Dim>> u, asked, once, twice;  ///< of the step at hand
    ContactReport<Dim> report;
};

/// Where a grain's bits are.
struct BondBytes {
    std::size_t begin = 0, count = 0;
    int bit = 0;
    const int* place = nullptr;  ///< [n_bonds] byte of each bond; null: in their order
    std::size_t first_work = 0;  ///< into Scene::works
};

/// Grains whose bond forces are evaluated at once: one, a batch of one shape, or a union.
struct ForceTask {
    std::array<int, batch_lanes> grain{};
    int size = 0;
    bool alone = false;
    int union_batch = -1;  ///< index into Scene::unions; -1: grains of one shape
};

template <int Dim>
struct Scene {
    explicit Scene(const CartesianGrid<Dim>& background) : grid(background), friction(1, 0.0) {}

    CartesianGrid<Dim> grid;
    std::vector<std::unique_ptr<Shape<Dim>>> shapes;
    std::vector<MaterialGroup<Dim>> groups;
    std::vector<UnionBatch<Dim>> unions;
    std::vector<ForceTask> force_tasks;         ///< every peridynamic grain once
    std::optional<MaterialPoints<Dim>> points;  ///< none: all grains are peridynamic
    PointContact<Dim> point_contact;
    std::vector<double> point_frequency;  ///< [points->n_grains()] highest of each grain [rad/s]
    /// Peridynamic grains, sorted by group, then those of material points. Grain::id is the number in the
    /// deck.
    std::vector<Grain<Dim>> grains;
    std::vector<int> grain_of_id;  ///< [n_grains] position of each deck number in `grains`
    Particles<Dim> particles;
    std::vector<Vec<Dim>> x_start;            ///< positions as placed [m]
    std::int64_t n_cut = 0;                   ///< bonds that cracks cross at the start
    std::vector<PlasticStrain<Dim>> plastic;  ///< [n] as of the last force; empty: nothing can yield
    /// Bonds of breakable grains. A grain has a bit in each of its bytes; those of a batch share the bytes.
    std::vector<std::uint8_t> alive;
    std::vector<std::uint8_t> whole;    ///< `alive` as the cracks of the start left it; empty: no cracks
    std::vector<std::uint8_t> kept;     ///< bits of bonds that never break, as `alive`; empty: none
    std::vector<BondBytes> bond_bytes;  ///< [n_grains] into `alive`
    std::vector<BondWork> works;  ///< of the bonds that break by energy, grain by grain; empty: none does
    std::int64_t n_bonds = 0;

    std::vector<Wall<Dim>> walls;
    std::vector<std::array<Expression, Dim>> wall_velocity;
    std::vector<std::optional<Servo>> servos;  ///< [n_walls]
    FrictionTable friction;
    std::optional<ContactMethod<Dim>> contact;
    std::vector<std::uint8_t> torn;  ///< [n_grains] lost bonds in this step; empty: none can
    Fragments fragments;
    bool contact_in_pieces = true;  ///< on the grid the fragments of a grain are bodies of their own
    double travelled = 0.0;  ///< sum over the steps of the longest way that a particle or a wall has gone [m]
    Vec<Dim> gravity = Vec<Dim>::Zero();  ///< [m/s^2]
    double mass_damping = 0.0;            ///< [1/s]
    std::vector<Load<Dim>> loads;
    std::vector<Load<Dim>> prepare_loads;  ///< added to `loads` before the clock starts
    std::vector<Constraint<Dim>> constraints;
    /// Masses that contact on the grid meets [kg; 2D: kg/m]: what is held on every axis does not give way, so
    /// it counts `held_heavier` times. Empty: nothing is held.
    std::vector<double> contact_mass;
    int held_in_part = 0;  ///< particles held along some axes only, which grid contact takes for free ones
    std::vector<int> held_walls;  ///< grains with `wall: true` that constraints hold, in the deck's order
    StepArrays<Dim> arrays;

    GrainView<Dim> view(int grain) const;
    std::span<std::uint8_t> alive_of(int grain);  ///< bytes of its bonds; empty: cannot break
    std::span<PlasticStrain<Dim>> plastic_of(int grain);
    std::span<BondWork> works_of(int grain);              ///< [n_bonds]; empty: does not break by energy
    const MaterialGroup<Dim>& group_of(int grain) const;  ///< of a peridynamic grain
    /// Number of a grain in `points`; negative: it is peridynamic.
    int point_grain(int grain) const {
        return points ? grain - static_cast<int>(grains.size()) + points->n_grains() : -1;
    }
    std::vector<BrokenBond> broken_bonds(int grain) const;  ///< ascending
    bool moves_with_grid() const;                           ///< positions move with StepArrays::drift
    /// What contact reads of it.
    ContactScene<Dim> contact_scene() const;
    double elastic_energy() const;  ///< [J; 2D: J/m]
    double stable_step() const;     ///< largest stable time step, damping and contact included [s]
};

/// A held particle gives way to a contact by the inverse of this part of what a free one would. Sums over
/// impulses keep six digits less than round-off.
inline constexpr double held_heavier = 1e6;

/// Builds the scene of a deck. Throws InputError (grain outside the grid, grains overlapping, material or
/// shape that cannot be built).
template <int Dim>
std::unique_ptr<Scene<Dim>> make_scene(const Deck& deck);

/// Velocities of the deck: translation and spin of every grain.
template <int Dim>
void set_initial_velocities(const Deck& deck, Scene<Dim>& scene);

}  // namespace quern
