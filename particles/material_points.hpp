// Grains of material points: internal forces and motion by way of the background grid.
#pragma once

#include <cstdint>
#include <span>
#include <variant>
#include <vector>

#include "particles/grains.hpp"
#include "particles/point_field.hpp"
#include "particles/von_mises.hpp"

namespace quern {

/// Grains that carry their stress on their particles and have their gradients from a field of velocities on
/// the nodes of the grid, one field a grain (point_field.hpp). A step from n to n+1, N_ap at x(n):
///
///     f_a    = - sum_p V_p tau_p grad N_ap,    f_p = m_p sum_a N_ap [q f/m]_a              compute_forces
///     ... the velocities v_p become those of n+1/2 by these and all other forces, and by contact ...
///     v_a    = [q S v]_a,    u_p = sum_a N_ap v_a,    L_p = sum_a v_a (x) grad N_ap         move
///     x(n+1) = x(n) + dt u_p,    F(n+1) = (1 + dt L_p) F(n),  and be, alpha, J as of von_mises.hpp
///
/// Points move with u = P v, P = N q S, so a force F at places x does work as F.u = (P F).v: what acts on the
/// points from outside has to reach their velocities by way of P as well (`project`), or it would feed parts
/// of v that no position and no stress ever shows. P is symmetric with respect to the masses.
///
/// Sources: Sulsky, Zhou, Schreyer, Comput. Phys. Commun. 87 (1995) 236 (velocities mapped anew before the
/// strain); Bardenhagen, Brackbill, Sulsky, J. Comput. Phys. 135 (1998), one field a grain. Differs: forces
/// and contact act on the velocities of the points, so that every contact method serves both kinds of grain;
/// all forces are adjoint to the motion, so that kinetic and elastic energy change hands without loss.
///
/// One field for all grains (`one_field`) is the method before contact: Sulsky, Chen, Schreyer, Comput.
/// Methods Appl. Mech. Eng. 118 (1994) 179. What shares a node moves with it: grains stick to each other,
/// without any law of contact. Grains that are led (`make_rigid`) count a million times their mass in S and
/// in m_a, so that the nodes that they share follow them, and keep the stress that they have.
///
/// 2D: plane strain, per metre of thickness.
template <int Dim>
class MaterialPoints {
  public:
    MaterialPoints(const CartesianGrid<Dim>& grid, const PointOptions& options, bool one_field);

    /// Grains in the order of their particles. `volume` [grain.count].
    void add_grain(const Grain<Dim>& grain, std::span<const double> volume, const VonMises& law);

    /// Grain k is led: what it shares nodes with follows it.
    void make_rigid(const Particles<Dim>& particles, int k);

    /// Sets f of the points of all grains [N; 2D: N/m]. Begins a step: what follows is at these positions.
    void compute_forces(const Particles<Dim>& particles, std::vector<Vec<Dim>>& f);

    /// out = P v for points, v for all other particles; both [n] of all particles, may be the same.
    void project(const Particles<Dim>& particles, std::span<const Vec<Dim>> v, std::vector<Vec<Dim>>& out);

    /// Takes stress and strain from n to n+1 with the velocities of n+1/2, and sets the velocity [m/s] that
    /// moves each particle. Plastic work of the step [J; 2D: J/m].
    double move(const Particles<Dim>& particles, double dt, std::vector<Vec<Dim>>& drift);

    double elastic_energy(const Particles<Dim>& particles) const;  ///< [J; 2D: J/m]

    /// Components as in compute_cauchy_stress, of the points of grain k (as added) [count * n_stress].
    void compute_stress(int k, std::span<double> stress) const;

    void compute_plastic_strain(int k, std::span<float> alpha) const;  ///< of the points of grain k [count]
    bool yields() const;                                               ///< some grain has a yield stress

    /// Highest frequency of grain k (of all, if they have one field) without stress [rad/s], by Lanczos on
    /// the forces that the points would have (stable_step.hpp), with a margin for where it lies in its cells:
    /// from place to place it differs by 2 to 6 % with gimp and quadratic functions, by up to 40 % with
    /// linear ones.
    double max_frequency(const Particles<Dim>& particles, int k) const;

    int n_grains() const { return static_cast<int>(grains_.size()); }
    /// First particle that is a point; all that follow are.
    std::size_t first_point() const { return grains_.front().first; }
    std::span<PlasticState<Dim>> states() { return states_; }

  private:
    struct Range {
        std::size_t first = 0, count = 0;  ///< particles
        std::size_t state = 0;             ///< place of the first in the arrays below
    };
    struct Member : Range {
        VonMises law;
        bool rigid = false;
    };
    const Member& grain_at(std::size_t state) const { return grains_[grain_of_[state]]; }
    /// Of the points of a body in S and in the forces [kg; 2D: kg/m].
    std::span<const double> weights(const Particles<Dim>& particles, const Range& body) const;
    template <PointFunctions functions>
    using Fields = std::vector<PointField<Dim, functions>>;

    CartesianGrid<Dim> grid_;
    PointOptions options_;
    bool one_field_;
    std::vector<Member> grains_;
    std::vector<Range> bodies_;            ///< what has a field of its own
    std::vector<std::uint32_t> grain_of_;  ///< of each state
    std::vector<PlasticState<Dim>> states_;
    std::vector<double> weights_;  ///< one a state; empty: the masses
    std::vector<double> half_;     ///< half widths of the points [cells]
    /// One a body, at the positions of the step.
    std::variant<Fields<PointFunctions::linear>, Fields<PointFunctions::gimp>,
                 Fields<PointFunctions::quadratic>>
        fields_;
};

}  // namespace quern
