// The contract of every contact method: it is shown a trial state and answers with impulses; it moves
// nothing.
#pragma once

#include <algorithm>
#include <compare>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "grid/cartesian_grid.hpp"
#include "particles/grains.hpp"

namespace quern {

/// A rigid plane; matter stays on the side that the normal points to.
template <int Dim>
struct Wall {
    Vec<Dim> point = Vec<Dim>::Zero();     ///< now [m]
    Vec<Dim> normal = Vec<Dim>::Zero();    ///< unit
    Vec<Dim> velocity = Vec<Dim>::Zero();  ///< during this step [m/s]
    double friction = 0.0;

    double distance(const Vec<Dim>& x) const { return normal.dot(x - point); }
};

/// A broken bond of a grain, by the numbers of its nodes in the shape, lower one first.
struct BrokenBond {
    int first = 0, second = 0;
    auto operator<=>(const BrokenBond&) const = default;
};

/// Friction coefficient of each pair of materials, symmetric.
class FrictionTable {
  public:
    FrictionTable(int n_materials, double value)
        : n_(n_materials), mu_(static_cast<std::size_t>(n_materials * n_materials), value) {}
    double operator()(int a, int b) const { return mu_[static_cast<std::size_t>(a * n_ + b)]; }
    void set(int a, int b, double value) {
        mu_[static_cast<std::size_t>(a * n_ + b)] = mu_[static_cast<std::size_t>(b * n_ + a)] = value;
    }
    bool any() const {
        return std::any_of(mu_.begin(), mu_.end(), [](double mu) { return mu > 0.0; });
    }

  private:
    int n_;
    std::vector<double> mu_;
};

/// What contact reads.
template <int Dim>
struct ContactScene {
    std::span<const Grain<Dim>> grains;
    std::span<const Vec<Dim>> x;     ///< [n] [m]
    std::span<const double> mass;    ///< [n] [kg; 2D: kg/m]
    std::span<const double> volume;  ///< [n] [m^3; 2D: m^2]
    std::span<const Wall<Dim>> walls;
    const FrictionTable* friction = nullptr;
    /// No particle and no wall has gone further than this since the first step [m]: grows from step to step
    /// by the longest way of each. Infinite: not known.
    double travelled = std::numeric_limits<double>::infinity();
};

/// The state between kick and drift. Contact changes `v` and, in the flip coupling, sets `drift`.
template <int Dim>
struct ContactTrial {
    double dt = 0.0;                     ///< [s]
    std::span<const Vec<Dim>> v_before;  ///< [n] velocity before this step's forces [m/s]
    std::span<Vec<Dim>> v;               ///< [n] in: with this step's forces; out: with contact [m/s]
    std::span<Vec<Dim>> drift;  ///< [n] velocity that positions move with; read only if `moves_with_grid`
    /// No particle and no wall is faster, with this step's forces [m/s]. Infinite: not known.
    double largest_speed = std::numeric_limits<double>::infinity();
    bool first = false;    ///< first kick of the clock: half as long, and nothing has moved before it
    bool listing = false;  ///< list_contacts will be called after this step
};

/// Energies are work done on the particles in this step, impulse times the mean of the velocities before
/// and after, so that they sum with the work of the other forces to the change of kinetic energy [J; 2D:
/// J/m].
template <int Dim>
struct ContactReport {
    double normal_work = 0.0;    ///< relative motion along the normals (loss: negative)
    double friction_work = 0.0;  ///< relative motion along the surfaces (loss: negative)
    double wall_work = 0.0;      ///< done by moving walls
    double elastic = 0.0;        ///< stored in springs at the positions given
    double elastic_work = 0.0;   ///< of the springs, against walls at rest, taken with `v_before`
    double slip_loss = 0.0;      ///< lost by tangential springs that slipped on the way to `x`
    double stable_step = std::numeric_limits<double>::infinity();  ///< with the springs found by a search [s]
    std::vector<Vec<Dim>> grain_impulse;                           ///< [n_grains] received [N s; 2D: N s/m]
    std::vector<Vec<Dim>> wall_impulse;                            ///< [n_walls] received
    std::vector<Spin<Dim>> wall_moment;  ///< [n_walls] moment of the wall impulses about the origin
    std::int64_t n_nodes = 0, n_contacts = 0;
    int sweeps = 0;
    bool searched = true;  ///< contact nodes were found anew
    bool converged = true;
};

enum class GridRule { pair, surface, seed };
enum class GridCoupling { impulse, flip };

/// Grid contact. The switches turn single ingredients of the pair rule off, to show what each is for.
struct GridContactOptions {
    GridRule rule = GridRule::pair;
    GridCoupling coupling = GridCoupling::impulse;
    bool exact_walls = false;      ///< walls meet surface particles; false: tiles, one a node
    double interior_weight = 1.0;  ///< q: weight of interior particles in the impulse map, in (0, 1]
    int max_sweeps = 50;
    double tolerance = 1e-3;  ///< sweeps end when sum|dJ| < tolerance * sum J_n
    int debris = 16;          ///< pieces of a broken grain with fewer particles move as debris
    double skin = 0.2;        ///< contact nodes are searched anew when something has moved this far [h]
    bool tile = true;         ///< gap where two fitted profiles come closest; false: at mean positions
    bool curvature = true;    ///< profiles know the reference curvature
    bool rotation = true;     ///< impulses act at one point
    bool gap_test = true;     ///< approach at gap / dt is allowed
    bool exact_mass = true;   ///< exact inverse mass of the impulse map; false: as if the patch were rigid
};

}  // namespace quern
