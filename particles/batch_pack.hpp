// What the loops over batches are made of, once an instruction set: a pack of lanes and its operations.
//
// Included by the headers with the loops only; see batch_loops.hpp.
#pragma once

#include "particles/batch_types.hpp"

#if defined(__AVX2__)
#include <immintrin.h>
#else
#include <emmintrin.h>
#endif

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

enum class Breaking { none, tension, both };

/// Lanes of bond b that are intact, after the break test if this pass makes it.
template <Breaking breaking>
inline unsigned intact(BatchState& s, int b, int lane, Pack squared, Pack squared_length) {
    unsigned on = (s.alive[b] >> lane) & full;
    if constexpr (breaking != Breaking::none) {
        unsigned torn = greater(squared, load(s.longest + lane) * squared_length);
        if constexpr (breaking == Breaking::both)
            torn |= greater(load(s.shortest + lane) * squared_length, squared);
        torn &= on;
        if (torn != 0) [[unlikely]] {
            if (s.kept != nullptr) torn &= ~(static_cast<unsigned>(s.kept[b]) >> lane);
            if (torn == 0) return on;
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

}  // namespace
}  // namespace quern::QUERN_BATCH_LOOPS
