// Forces of a batch of grains of one shape: the same bond of eight grains at once, one grain a lane.
//
// This header is compiled once for every instruction set (batch_avx512.cpp, batch_avx2.cpp, batch_plain.cpp)
// and sees nothing but raw arrays: an inline function of a library that it shared with the rest of the
// program could be linked in from the wrong one. Equations and signs are those of bond_kernel.hpp.
#pragma once

#include "particles/batch_pack.hpp"

namespace quern::QUERN_BATCH_LOOPS {
namespace {

/// P = g D at every node. Partners come later in the list, so a row finds its own sum complete at its end.
template <int Dim, bool rate, bool masked, Breaking breaking>
void dilate(const BatchTopology& t, BatchState& s, int lane) {
    double* const D = s.dilatation + lane;
    for (int i = 0; i < t.n; ++i) store(D + batch_lanes * i, all(0.0));
    for (int i = 0; i < t.n; ++i) {
        Pack x_i[Dim], v_i[Dim];
        for (int k = 0; k < Dim; ++k) {
            x_i[k] = load(s.x + batch_lanes * (Dim * i + k) + lane);
            if constexpr (rate) v_i[k] = load(s.v + batch_lanes * (Dim * i + k) + lane);
        }
        Pack own = load(D + batch_lanes * i);
        for (int b = t.first[i]; b < t.first[i + 1]; ++b) {
            const int j = t.partner[b];
            const BatchBond& bond = t.bond[b];
            const Ends<Dim> e = ends<Dim>(s.x, x_i, j, lane);
            const Pack inverse = rsqrt(e.squared);
            Pack term;
            if constexpr (rate)
                term = all(bond.coupled) * (opening<Dim>(s.v, v_i, j, lane, e) * inverse);
            else
                term = all(bond.coupled) * (e.squared * inverse - all(bond.length));
            if constexpr (masked) {
                const unsigned on = intact<breaking>(s, b, lane, e.squared, all(bond.length * bond.length));
                if (on != full) [[unlikely]]
                    term = keep(term, on);
            }
            own += term;
            double* const D_j = D + batch_lanes * j;
            store(D_j, load(D_j) + term);
        }
        store(D + batch_lanes * i, own * all(t.node[i]));
    }
}

template <int Dim, bool rate, bool dilating, bool masked, Breaking breaking>
void pull(const BatchTopology& t, BatchState& s, int lane) {
    for (int k = 0; k < Dim * t.n; ++k) store(s.f + batch_lanes * k + lane, all(0.0));
    for (int i = 0; i < t.n; ++i) {
        Pack x_i[Dim], v_i[Dim], own[Dim];
        for (int k = 0; k < Dim; ++k) {
            x_i[k] = load(s.x + batch_lanes * (Dim * i + k) + lane);
            if constexpr (rate) v_i[k] = load(s.v + batch_lanes * (Dim * i + k) + lane);
            own[k] = load(s.f + batch_lanes * (Dim * i + k) + lane);
        }
        Pack P_i = all(0.0);
        if constexpr (dilating) P_i = load(s.dilatation + batch_lanes * i + lane);
        for (int b = t.first[i]; b < t.first[i + 1]; ++b) {
            const int j = t.partner[b];
            const BatchBond& bond = t.bond[b];
            const Ends<Dim> e = ends<Dim>(s.x, x_i, j, lane);
            const Pack inverse = rsqrt(e.squared);
            Pack coupled = all(0.0);  // k xi (P_i + P_j)
            if constexpr (dilating)
                coupled = all(bond.coupled) * (P_i + load(s.dilatation + batch_lanes * j + lane));
            Pack amount;  // force over |y|
            if constexpr (rate) {
                const Pack speed = opening<Dim>(s.v, v_i, j, lane, e) * inverse;
                amount = inverse * (all(bond.direct) * speed + coupled);
            } else {
                amount = all(bond.direct) + inverse * (coupled - all(bond.preload));
            }
            if constexpr (masked) {
                const unsigned on = intact<breaking>(s, b, lane, e.squared, all(bond.length * bond.length));
                if (on != full) [[unlikely]]
                    amount = keep(amount, on);
            }
            for (int k = 0; k < Dim; ++k) {
                double* const f_j = s.f + batch_lanes * (Dim * j + k) + lane;
                const Pack force = amount * e.d[k];
                own[k] += force;
                store(f_j, load(f_j) - force);
            }
        }
        for (int k = 0; k < Dim; ++k) store(s.f + batch_lanes * (Dim * i + k) + lane, own[k]);
    }
}

}  // namespace
}  // namespace quern::QUERN_BATCH_LOOPS
