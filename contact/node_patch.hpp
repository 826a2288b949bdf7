// The rotation of a grain around one of its nodes: what a force beside the node needs.
//
//     xb      = sum m_k x_k / sum m_k            over the node and its neighbours in the reference shape
//     omega   = Y L,   L = sum m_k (x_k - xb) x v_k,   Y = inverse of the inertia sum m_k (|r|^2 1 - r r^T)
//     u       = v + omega x l                    velocity of the grain at the lever l from the node
//     dv_k    = (Y tau) x (x_k - xb)             what the moment tau = l x J does: the adjoint of u
//
// so J at the node and tau around it change momentum by J, moment of momentum by (x + l) x J, and energy by
// J.u. xb, x, l, r [m], m [kg; 2D: kg/m], omega [rad/s], J [N s], tau [N m s]
//
// Friction between nodes that are R apart acts at two points of which neither is on the surface: without this
// its moment would be off by R, and a body that turns as a whole would seem to slip.
#pragma once

#include <span>
#include <vector>

#include "particles/grains.hpp"

namespace quern {

/// The neighbours of each node of a shape: those within 1.5 spacings, itself included.
template <int Dim>
class NodePatches {
  public:
    explicit NodePatches(const Shape<Dim>& shape);
    std::span<const int> of(int node) const {
        return {nodes_.data() + first_[node], nodes_.data() + first_[node + 1]};
    }

  private:
    std::vector<int> first_, nodes_;
};

template <int Dim>
struct PatchMotion {
    Vec<Dim> centre = Vec<Dim>::Zero();   ///< xb [m]
    Spin<Dim> omega = Spin<Dim>::Zero();  ///< [rad/s]
    Eigen::Matrix<double, n_spin<Dim>, n_spin<Dim>> inverse =
        Eigen::Matrix<double, n_spin<Dim>, n_spin<Dim>>::Zero();  ///< Y; 0 where the patch cannot turn
};

/// Motion of a patch. Members that have gone further than 3 spacings from the node, beyond a crack, do not
/// count.
template <int Dim>
PatchMotion<Dim> patch_motion(const Grain<Dim>& grain, std::span<const int> patch, int node,
                              std::span<const Vec<Dim>> x, std::span<const Vec<Dim>> v,
                              std::span<const double> mass);

/// omega of a patch for other velocities.
template <int Dim>
Spin<Dim> patch_spin(const PatchMotion<Dim>& motion, const Grain<Dim>& grain, std::span<const int> patch,
                     int node, std::span<const Vec<Dim>> x, std::span<const Vec<Dim>> v,
                     std::span<const double> mass);

/// v [n] += what the moment impulse tau [N m s; 2D: N s] does.
template <int Dim>
void turn_patch(const PatchMotion<Dim>& motion, const Spin<Dim>& tau, const Grain<Dim>& grain,
                std::span<const int> patch, int node, std::span<const Vec<Dim>> x, std::span<Vec<Dim>> v);

}  // namespace quern
