// Forces of a batch of grains of unlike shape on one lattice: as batch_loops.hpp, over the union of their
// nodes.
//
// Same law with its constants taken apart, because they belong to the shape: with W = k xi/(V_i V_j), a value
// a lane and kind of bond, and c = k (q_i + q_j),
//
//     P_i   = g_i V_i sum_j W V_j e
//     force = W V_i V_j ((q_i + q_j)(1/xi - 1/|y|) + (P_i + P_j)/|y|) y
//
// A node or bond that a lane lacks adds zero times a finite number, in its place of the sum: the sums of a
// lane have the same bits in every union.
#pragma once

#include "particles/batch_pack.hpp"

namespace quern::QUERN_BATCH_LOOPS {
namespace {

/// P - q at every node; P alone if `rate`.
template <int Dim, bool rate, bool masked, Breaking breaking>
void dilate(const UnionTopology& t, BatchState& s, int lane) {
    double* const D = s.dilatation + lane;
    for (int i = 0; i < t.n; ++i) store(D + batch_lanes * i, all(0.0));
    for (int i = 0; i < t.n; ++i) {
        Pack x_i[Dim], v_i[Dim];
        for (int k = 0; k < Dim; ++k) {
            x_i[k] = load(s.x + batch_lanes * (Dim * i + k) + lane);
            if constexpr (rate) v_i[k] = load(s.v + batch_lanes * (Dim * i + k) + lane);
        }
        const Pack V_i = load(t.volume + batch_lanes * i + lane);
        Pack own = load(D + batch_lanes * i);
        for (int b = t.first[i]; b < t.first[i + 1]; ++b) {
            const UnionBond& bond = t.bond[b];
            const int j = bond.partner;
            const Pack length = load(t.length + 2 * batch_lanes * bond.length + lane);
            const Ends<Dim> e = ends<Dim>(s.x, x_i, j, lane);
            const Pack inverse = rsqrt(e.squared);
            Pack term = load(t.weight + batch_lanes * bond.weight + lane);
            if constexpr (rate)
                term *= opening<Dim>(s.v, v_i, j, lane, e) * inverse;
            else
                term *= e.squared * inverse - length;
            if constexpr (masked) term = keep(term, intact<breaking>(s, b, lane, e.squared, length * length));
            own += term * load(t.volume + batch_lanes * j + lane);
            double* const D_j = D + batch_lanes * j;
            store(D_j, load(D_j) + term * V_i);
        }
        own *= load(t.node + batch_lanes * i + lane);
        if constexpr (!rate) own -= load(t.end + batch_lanes * i + lane);
        store(D + batch_lanes * i, own);
    }
}

template <int Dim, bool rate, bool dilating, bool masked, Breaking breaking>
void pull(const UnionTopology& t, BatchState& s, int lane) {
    for (int k = 0; k < Dim * t.n; ++k) store(s.f + batch_lanes * k + lane, all(0.0));
    for (int i = 0; i < t.n; ++i) {
        Pack x_i[Dim], v_i[Dim], own[Dim];
        for (int k = 0; k < Dim; ++k) {
            x_i[k] = load(s.x + batch_lanes * (Dim * i + k) + lane);
            if constexpr (rate) v_i[k] = load(s.v + batch_lanes * (Dim * i + k) + lane);
            own[k] = load(s.f + batch_lanes * (Dim * i + k) + lane);
        }
        const Pack V_i = load(t.volume + batch_lanes * i + lane);
        Pack P_i = all(0.0), q_i = all(0.0);
        if constexpr (dilating) {
            P_i = load(s.dilatation + batch_lanes * i + lane);
            q_i = load(t.end + batch_lanes * i + lane);
        }
        for (int b = t.first[i]; b < t.first[i + 1]; ++b) {
            const UnionBond& bond = t.bond[b];
            const int j = bond.partner;
            const double* const length = t.length + 2 * batch_lanes * bond.length + lane;
            const Ends<Dim> e = ends<Dim>(s.x, x_i, j, lane);
            const Pack inverse = rsqrt(e.squared);
            Pack amount = load(length + batch_lanes);  // 1/xi; then force over |y| and over W V_i V_j
            if constexpr (dilating) amount *= q_i + load(t.end + batch_lanes * j + lane);
            if constexpr (rate) amount *= opening<Dim>(s.v, v_i, j, lane, e) * inverse;
            if constexpr (dilating) {
                const Pack coupled = P_i + load(s.dilatation + batch_lanes * j + lane);
                amount = rate ? inverse * (amount + coupled) : amount + inverse * coupled;
            } else {
                amount = rate ? inverse * amount : amount - inverse;
            }
            amount *= load(t.weight + batch_lanes * bond.weight + lane) *
                      (V_i * load(t.volume + batch_lanes * j + lane));
            if constexpr (masked) {
                const Pack xi = load(length);
                amount = keep(amount, intact<breaking>(s, b, lane, e.squared, xi * xi));
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
