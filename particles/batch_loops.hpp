// Forces of a batch: the same bond of eight grains at once, one grain a lane.
//
// This header is compiled once for every instruction set (batch_avx512.cpp, batch_avx2.cpp, batch_plain.cpp)
// and sees nothing but raw arrays: an inline function of a library that it shared with the rest of the
// program could be linked in from the wrong one. Equations and signs are those of bond_kernel.hpp.
#pragma once

#if defined(__AVX2__)
#include <immintrin.h>
#else
#include <emmintrin.h>
#endif

namespace quern {

inline constexpr int batch_lanes = 8;

/// Constants of one bond, for scale 1, shared by all lanes.
struct BatchBond {
    double length;   ///< xi [m]
    double coupled;  ///< k xi [m^7; 2D: m^5], k = w V_i V_j
    double direct;   ///< c [N/m; 2D: N/m^2]
    double preload;  ///< c xi [N; 2D: N/m]
};

struct BatchTopology {
    int n;                  ///< nodes
    const int* first;       ///< [n + 1] half list: first bond of a row
    const int* partner;     ///< [n_bonds]
    const BatchBond* bond;  ///< [n_bonds]
    const double* node;     ///< [n] g [N/m^15; 2D: N/m^12], or null: no dilatation
};

/// Rows of eight lanes, aligned to 64 bytes.
struct BatchState {
    const double* x;       ///< [n][Dim][8] positions over the lane's scale
    const double* v;       ///< [n][Dim][8] velocities over the lane's scale, or null
    unsigned char* alive;  ///< [n_bonds] a bit a lane, or null: all intact
    const double* limit;   ///< [8] (1 + critical stretch)^2, or null: nothing breaks
    double* f;             ///< [n][Dim][8] out: forces
    double* dilatation;    ///< [n][8] scratch
    int* broken_bond;      ///< [n_bonds] out: what broke just now
    unsigned char* broken_lanes;
    int n_broken;
};

struct BatchLoops {
    const char* name;
    void (*elastic_2d)(const BatchTopology&, BatchState&);
    void (*elastic_3d)(const BatchTopology&, BatchState&);
    void (*viscous_2d)(const BatchTopology&, BatchState&);
    void (*viscous_3d)(const BatchTopology&, BatchState&);
};

}  // namespace quern

#if defined(QUERN_BATCH_LOOPS)
namespace quern::QUERN_BATCH_LOOPS {
namespace {

// What the instruction sets differ in: a pack of lanes, 1/sqrt, which lanes are greater, which are kept.
#if defined(__AVX512F__)
using Pack = __m512d;
constexpr int width = 8;
inline Pack all(double a) {
    return _mm512_set1_pd(a);
}
inline Pack load(const double* p) {
    return _mm512_load_pd(p);
}
inline void store(double* p, Pack a) {
    _mm512_store_pd(p, a);
}
/// 14 bits and two steps of Newton: 2e-16, and a quarter of the time of sqrt and division.
inline Pack rsqrt(Pack a) {
    const Pack half = a * all(0.5);
    Pack y = _mm512_maskz_rsqrt14_pd(0xff, a);
    y = y * (all(1.5) - half * y * y);
    return y * (all(1.5) - half * y * y);
}
inline unsigned greater(Pack a, Pack b) {
    return _mm512_cmp_pd_mask(a, b, _CMP_GT_OQ);
}
inline Pack keep(Pack a, unsigned lanes) {
    return _mm512_maskz_mov_pd(static_cast<__mmask8>(lanes), a);
}
#elif defined(__AVX2__)
using Pack = __m256d;
constexpr int width = 4;
inline Pack all(double a) {
    return _mm256_set1_pd(a);
}
inline Pack load(const double* p) {
    return _mm256_load_pd(p);
}
inline void store(double* p, Pack a) {
    _mm256_store_pd(p, a);
}
inline Pack rsqrt(Pack a) {
    return all(1.0) / _mm256_sqrt_pd(a);
}
inline unsigned greater(Pack a, Pack b) {
    return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_GT_OQ)));
}
inline Pack keep(Pack a, unsigned lanes) {
    const __m256i bits = _mm256_set_epi64x(8, 4, 2, 1);
    const __m256i on = _mm256_and_si256(_mm256_set1_epi64x(lanes), bits);
    return _mm256_and_pd(a, _mm256_castsi256_pd(_mm256_cmpeq_epi64(on, bits)));
}
#else
using Pack = __m128d;
constexpr int width = 2;
inline Pack all(double a) {
    return _mm_set1_pd(a);
}
inline Pack load(const double* p) {
    return _mm_load_pd(p);
}
inline void store(double* p, Pack a) {
    _mm_store_pd(p, a);
}
inline Pack rsqrt(Pack a) {
    return all(1.0) / _mm_sqrt_pd(a);
}
inline unsigned greater(Pack a, Pack b) {
    return static_cast<unsigned>(_mm_movemask_pd(_mm_cmpgt_pd(a, b)));
}
inline Pack keep(Pack a, unsigned lanes) {
    return _mm_mul_pd(a, _mm_set_pd(lanes & 2 ? 1.0 : 0.0, lanes & 1 ? 1.0 : 0.0));
}
#endif

constexpr unsigned full = (1U << width) - 1U;

/// Lanes of bond b that are intact, after the break test if this pass makes it.
template <bool breaking>
inline unsigned intact(BatchState& s, int b, int lane, Pack squared, double length) {
    unsigned on = (s.alive[b] >> lane) & full;
    if constexpr (breaking) {
        const unsigned torn = greater(squared, load(s.limit + lane) * all(length * length)) & on;
        if (torn != 0) [[unlikely]] {
            on &= ~torn;
            const unsigned char bits = static_cast<unsigned char>(torn << lane);
            s.alive[b] = static_cast<unsigned char>(s.alive[b] & ~bits);
            s.broken_bond[s.n_broken] = b;
            s.broken_lanes[s.n_broken++] = bits;
        }
    }
    return on;
}

template <int Dim>
struct Ends {
    Pack d[Dim];   ///< from i to j
    Pack squared;  ///< |y|^2
};

template <int Dim>
inline Ends<Dim> ends(const double* x, const Pack* x_i, int j, int lane) {
    Ends<Dim> e;
    const double* const x_j = x + Dim * batch_lanes * j + lane;
    for (int k = 0; k < Dim; ++k) e.d[k] = load(x_j + batch_lanes * k) - x_i[k];
    e.squared = e.d[0] * e.d[0] + e.d[1] * e.d[1];
    if constexpr (Dim == 3) e.squared += e.d[2] * e.d[2];
    return e;
}

/// Velocity along the bond times its length.
template <int Dim>
inline Pack opening(const double* v, const Pack* v_i, int j, int lane, const Ends<Dim>& e) {
    const double* const v_j = v + Dim * batch_lanes * j + lane;
    Pack sum = e.d[0] * (load(v_j) - v_i[0]);
    for (int k = 1; k < Dim; ++k) sum += e.d[k] * (load(v_j + batch_lanes * k) - v_i[k]);
    return sum;
}

/// P = g D at every node. Partners come later in the list, so a row finds its own sum complete at its end.
template <int Dim, bool rate, bool masked, bool breaking>
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
                const unsigned on = intact<breaking>(s, b, lane, e.squared, bond.length);
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

template <int Dim, bool rate, bool dilating, bool masked, bool breaking>
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
                const unsigned on = intact<breaking>(s, b, lane, e.squared, bond.length);
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

template <int Dim, bool rate, bool masked, bool breaking>
void both_passes(const BatchTopology& t, BatchState& s) {
    for (int lane = 0; lane < batch_lanes; lane += width)
        if (t.node != nullptr) {
            dilate<Dim, rate, masked, breaking>(t, s, lane);
            pull<Dim, rate, true, masked, false>(t, s, lane);
        } else {
            pull<Dim, rate, false, masked, breaking>(t, s, lane);
        }
}

template <int Dim, bool rate>
void evaluate(const BatchTopology& t, BatchState& s) {
    s.n_broken = 0;
    if (s.alive == nullptr)
        both_passes<Dim, rate, false, false>(t, s);
    else if (s.limit == nullptr || rate)
        both_passes<Dim, rate, true, false>(t, s);
    else
        both_passes<Dim, rate, true, true>(t, s);
}

}  // namespace

extern const BatchLoops loops;
const BatchLoops loops{QUERN_BATCH_NAME, evaluate<2, false>, evaluate<3, false>, evaluate<2, true>,
                       evaluate<3, true>};

}  // namespace quern::QUERN_BATCH_LOOPS
#endif
