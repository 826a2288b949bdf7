// A patch: the particles of a grain that take the impulse of one contact at its surface.
//
// The push goes to surface particles next to the point, the moment that is left to more of them (p: particles
// of the patch; a_p, w_p: their parts in push and turn; s_p = x_p + delta_p nu_p; d_p: distance of s_p from
// the point x_c along the surface; f: where the surface is under x_c; K(z) = (1 - z^2)^2 below 1, else 0):
//
//     dv_p = a_p J/m + w_p (Y (r x J)) x (x_p - x_w),   r = x_c - x_a
//     a_p  = K(d_p/(1.5 dx)) at the surface, 0 inside;      w_p = K(|x_p - f|/(2.5 dx))
//     m    = sum m_p a_p,   x_a = sum m_p a_p x_p / m
//     x_w  = sum m_p w_p x_p / sum m_p w_p,   Y = (sum m_p w_p (|r_p|^2 1 - r_p r_p^T))^-1,  r_p = x_p - x_w
//
// All of J arrives, and all of its moment, at x_c. Velocity is the adjoint, as in pair_rule.hpp:
//
//     u = sum m_p a_p v_p / m + (Y sum m_p w_p r_p x v_p) x r,    W = sum m_p B_p^T B_p with dv_p = B_p J
//
// J in [N s], 2D: per metre of thickness. Why two weights: the less mass a push stops, the less energy a
// first touch costs (restitution of disks of 6 particles a radius 0.954, 0.943, 0.935 with 1.5, 1.8, 2 dx),
// but with less than 1.5 a rolling disk feels its particles; a moment that few particles take shears them
// (spin of a rolling disk off by 0.9 % more with 1.8 than with 2.5 dx). Slots of a node (slot.hpp) have N^2
// in the place of both and move with the grid; a patch moves with the contact.
#pragma once

#include <span>
#include <vector>

#include "contact/contact.hpp"
#include "contact/footprint.hpp"

namespace quern {

template <int Dim>
struct PatchParticle {
    int particle;
    double ma, mw;  ///< m_p a_p, m_p w_p [kg]
    double a, w;
    Vec<Dim> r;  ///< x_p - x_w [m]
};

/// The particles of a patch stand one after another in a list of many patches.
template <int Dim>
struct Patch {
    int first = 0, count = 0;
    double m = 0.0;                 ///< [kg]
    Vec<Dim> r = Vec<Dim>::Zero();  ///< x_c - x_a [m]
    Eigen::Matrix<double, n_spin<Dim>, n_spin<Dim>> Y;
    bool rotates = false;
};

/// Patches of the rows of one page.
template <int Dim>
struct Patches {
    std::vector<Patch<Dim>> patches;
    std::vector<PatchParticle<Dim>> particles;

    void clear() {
        patches.clear();
        particles.clear();
    }
    /// Adds the patch of a grain around the point x_c [m] at its surface particle `nearest`; returns its
    /// number. s: true surface points [m]; foot: f [m]; n: unit normal of the contact; `push_only`: no moment
    /// is passed on.
    int add(const ContactScene<Dim>& scene, const Grain<Dim>& grain, std::span<const Vec<Dim>> s,
            const Footprints<Dim>& footprints, int nearest, const Vec<Dim>& x_c, const Vec<Dim>& foot,
            const Vec<Dim>& n, bool push_only);

    /// u [m/s] of particle velocities v.
    Vec<Dim> velocity(int patch, std::span<const Vec<Dim>> v) const;
    void add_impulse(int patch, const Vec<Dim>& J, std::span<Vec<Dim>> v) const;
    /// W [1/kg]; `exact` false: as if the patch were rigid.
    Mat<Dim> inverse_mass(int patch, std::span<const double> mass, bool exact) const;
};

extern template struct Patches<2>;
extern template struct Patches<3>;

}  // namespace quern
