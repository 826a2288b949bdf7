// The nodes of one grain of material points at one position: what goes to them and comes back.
#pragma once

#include <array>
#include <span>
#include <utility>
#include <vector>

#include "grid/shape_functions.hpp"
#include "particles/point_functions.hpp"

namespace quern {

/// A box of nodes around a grain, and the maps between its points p and its nodes a:
///
///     velocity    v_a = [q(A) S v]_a,      [S v]_a = sum_p m_p N_ap v_p / m_a,    m_a = sum_p m_p N_ap
///     motion      at p: u_p = sum_a N_ap v_a,       L_p = sum_a v_a (x) grad N_ap
///     force       f_a = - sum_p V_p tau_p grad N_ap      at p: m_p sum_a N_ap [q(A) f/m]_a
///     q(A)        = sum_{k < order} (1 - A)^k,      A = S N
///
///     m mass [kg; 2D: kg/m], V reference volume [m^3; 2D: m^2], tau Kirchhoff stress [Pa], L velocity
///     gradient [1/s]
///
/// The force is the adjoint of the velocity gradient: sum m v.a = - sum V tau:L to round-off. Momentum is
/// exact, and u, a symmetric map of v, adds none to the angular momentum.
///
/// Order 1 is the lumped mass of Sulsky, Chen, Schreyer, Comput. Methods Appl. Mech. Eng. 118 (1994) 179: v_a
/// is then the velocity at the middle of the mass that a node has, which near a surface is not where the
/// node is, and the moments of the f_a about these middles do not vanish: grains lose spin. q(A) tends to
/// A^-1, the full mass matrix, which takes any linear motion over as it is; every order brings the map nearer
/// to that. The series is that of XPIC(order): Hammerquist & Nairn, Comput. Methods Appl. Mech. Eng. 318
/// (2017) 724, who filter velocities with it. Differs: it serves force and motion alike, so that both stay
/// adjoint, and the velocities of the points are not filtered.
template <int Dim, PointFunctions functions>
class PointField {
  public:
    using Stencil = PointStencil<Dim, functions>;

    /// Weights of the points at x [m], with half widths [cells] and masses, all [n]. `wraps`: points may lie
    /// anywhere along periodic axes, and meet those one period further.
    void place(const CartesianGrid<Dim>& grid, std::span<const Vec<Dim>> x, std::span<const double> half,
               std::span<const double> mass, bool wraps);

    void scatter_velocities(std::span<const double> mass, std::span<const Vec<Dim>> v, int order);
    /// stress(p): tau of point p as a matrix [Pa].
    template <class Stress>
    void scatter_forces(std::span<const double> mass, std::span<const double> volume, int order,
                        Stress&& stress);
    /// f [n]: mass times what comes back [N; 2D: N/m]
    void gather_forces(std::span<const double> mass, std::span<Vec<Dim>> f) const;
    void gather_velocities(std::span<Vec<Dim>> u) const;
    /// take(p, u, L)
    template <class Take>
    void gather_motion(Take&& take) const;

  private:
    static constexpr int width = Stencil::width;
    /// One line of nodes along axis 0: where it starts, and the product of the other axes' functions.
    struct Row {
        std::size_t node;
        double value;
        Vec<Dim> slope;  ///< entry a: with the slope of axis a; entry 0 unused
    };
    template <class Visit>
    void for_each_row(const Stencil& s, Visit&& visit) const;
    Pack value_at(const Stencil& s, const std::vector<Pack>& nodes) const;
    void add(const Stencil& s, const Pack& amount, std::vector<Pack>& nodes) const;
    /// Nodes past the end of a periodic axis and those that they stand for get the sum of both.
    void find_twins(const CartesianGrid<Dim>& grid, const IntVec<Dim>& n_nodes);
    template <class T>
    void join_twins(std::vector<T>& nodes) const;
    /// Nodal sums to nodal values: over the mass, then the terms of q beyond the first.
    void finish(std::span<const double> mass, int order);

    std::vector<Stencil> stencils_;
    std::vector<double> mass_;       ///< [n_nodes] sums, from `place` on inverse, 0 where no mass is
    std::vector<Pack> nodes_;        ///< [n_nodes] velocity or force over mass
    std::vector<Pack> term_, next_;  ///< [n_nodes] of q
    std::vector<std::pair<std::size_t, std::size_t>> twins_;  ///< past the end, and within; axis after axis
    IntVec<Dim> low_;
    std::array<std::size_t, Dim> stride_{};
    double inverse_h_ = 0.0;
};

}  // namespace quern
