// Friction of debris: what a push along the surface does to a particle and to what stands next to it.
//
// Two balls that touch in c rub there, a lever l = c - x_p off their centres. J_t acts at p and its moment on
// p and its neighbours, those of the same piece within 1.5 spacings in the reference shape
// (node_patch.hpp):
//
//     dv_p    = J_t/m_p + (Y tau) x (x_p - xb),   dv_k = (Y tau) x (x_k - xb),   tau = l x J_t
//     u_p     = v_p + omega x l,   omega = Y sum m_k (x_k - xb) x v_k             the adjoint
//     W_p     = 1/m_p + 2 (Y tau).(r x t) + tau.Y tau     with tau = l x t, r = x_p - xb, t unit, across n
//
//     J_t [N s; 2D: N s/m], m [kg; 2D: kg/m], l, r, x [m], u, v [m/s], omega [rad/s], tau [N m s; 2D: N s],
//     Y inverse inertia of p and its neighbours about their centre xb
//
// c lies between the two as their radii. A particle without neighbours takes no moment: c is its centre then,
// and two such particles do not rub. In space W is summed over two directions t: at most twice the largest.
// Our own; momentum and moment of momentum are exact, energy falls.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "contact/bodies.hpp"
#include "contact/node_patch.hpp"

namespace quern {

template <int Dim>
class LooseFriction {
  public:
    /// Lists the neighbours of the particles in `pairs`; none of them if nothing rubs.
    void search(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene,
                std::span<const CrackPair> pairs);

    /// Whether p and q, d from p to q [m], can rub in this step. Their number, to be used until clear(); -1:
    /// no.
    int add(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene, int p, int q, const Vec<Dim>& d,
            double radius_p, double radius_q);
    void clear() { rubs_.clear(); }

    /// visit(particle) for all that friction of a pair moves.
    template <class Visit>
    void for_each_moved(int rub, Visit&& visit) const {
        for (const Side* side : {&rubs_[rub].p, &rubs_[rub].q}) {
            visit(side->particle);
            for (const int k : side->patch) visit(k);
        }
    }
    double friction(int rub) const { return rubs_[rub].friction; }
    double inverse_mass(int rub) const { return rubs_[rub].W; }
    /// Levers l of p and q [m].
    Vec<Dim> lever_p(int rub) const { return rubs_[rub].p.lever; }
    Vec<Dim> lever_q(int rub) const { return rubs_[rub].q.lever; }
    /// u_p - u_q, with its part along n.
    Vec<Dim> slip(int rub, const ContactScene<Dim>& scene, std::span<const Vec<Dim>> v) const;
    /// Gives J to q and takes it from p.
    void push(int rub, const ContactScene<Dim>& scene, const Vec<Dim>& J, std::span<Vec<Dim>> v) const;

  private:
    struct Side {
        int particle = 0;
        const Grain<Dim>* owner = nullptr;
        std::span<const int> patch;
        PatchMotion<Dim> motion;
        Vec<Dim> lever = Vec<Dim>::Zero();
        bool turns = false;
    };
    struct Rub {
        Side p, q;
        double W = 0.0, friction = 0.0;
    };
    Side side(const ContactBodies<Dim>& bodies, const ContactScene<Dim>& scene, int p) const;

    const NodePatches<Dim>& patches_of(const Shape<Dim>& shape);

    std::vector<std::pair<const Shape<Dim>*, std::unique_ptr<NodePatches<Dim>>>> patches_;
    std::vector<int> patch_of_;  // [n] -1: none
    std::vector<int> first_, members_;
    std::vector<Rub> rubs_;
};

}  // namespace quern
