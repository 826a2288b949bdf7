// Velocities as seen through slots: the impulse map and its adjoint.
#pragma once

#include "contact/contact_nodes.hpp"

namespace quern {

/// Particle velocities [m/s] behind the impulse map of pair_rule.hpp.
template <int Dim, class Velocity = Vec<Dim>>
struct ParticleField {
    std::span<Velocity> v;

    /// u = sum m w B^T v: the slot's velocity at lever r.
    Vec<Dim> velocity(const Slot<Dim>& slot, const Vec<Dim>& r) const {
        Vec<Dim> P = Vec<Dim>::Zero();
        Spin<Dim> L = Spin<Dim>::Zero();
        for (int k = 0; k < slot.n_support; ++k) {
            const Support<Dim>& e = slot.support[k];
            const Vec<Dim> p = e.mw * v[e.particle];
            P += p;
            L += moment(Vec<Dim>(e.d - slot.xb), p);
        }
        Vec<Dim> u = P / slot.m;
        if (slot.rotates) u += cross(Spin<Dim>(slot.Y * L), r);
        return u;
    }
    /// dv_p = w B J.
    void add_impulse(const Slot<Dim>& slot, const Vec<Dim>& r, const Vec<Dim>& J) {
        const Vec<Dim> dv = J / slot.m;
        const Spin<Dim> domega =
            slot.rotates ? Spin<Dim>(slot.Y * moment(r, J)) : Spin<Dim>(Spin<Dim>::Zero());
        for (int k = 0; k < slot.n_support; ++k) {
            const Support<Dim>& e = slot.support[k];
            v[e.particle] += e.w * (dv + cross(domega, Vec<Dim>(e.d - slot.xb)));
        }
    }
};

/// One velocity a slot [m/s]: the flip coupling.
template <int Dim, class Velocity = Vec<Dim>>
struct NodalField {
    std::span<Velocity> v;   ///< [n_slots]
    const Slot<Dim>* first;  ///< of all slots

    Vec<Dim> velocity(const Slot<Dim>& slot, const Vec<Dim>&) const { return v[&slot - first]; }
    void add_impulse(const Slot<Dim>& slot, const Vec<Dim>&, const Vec<Dim>& J) {
        v[&slot - first] += J / slot.m;
    }
};

/// Exact inverse mass of a slot at lever r: W = sum m w^2 B^T B [1/kg]. `exact` false: the patch as a rigid
/// body of its weighted mass.
template <int Dim>
Mat<Dim> inverse_mass(const Slot<Dim>& slot, const Vec<Dim>& r, bool exact);

}  // namespace quern
