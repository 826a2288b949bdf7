#include "tests/benchmark/roofline.hpp"

#include <algorithm>
#include <chrono>

#include "grid/parallel.hpp"
#include "particles/instructions.hpp"
#include "tests/benchmark/machine.hpp"

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace quern::bench {

namespace {

using Clock = std::chrono::steady_clock;

/// Least seconds of several runs of body(thread) on all threads.
template <class Body>
double best_time(int threads, Body&& body) {
    double best = 1e300;
    for (int k = 0; k < 9; ++k) {
        const auto start = Clock::now();
        parallel::for_each(static_cast<std::size_t>(threads), body);
        best = std::min(best, std::chrono::duration<double>(Clock::now() - start).count());
    }
    return best;
}

/// [GB/s] of `repeats` passes over three arrays of n doubles a thread.
double triad(int threads, std::size_t n, int repeats) {
    struct Arrays {
        std::vector<double> a, b, c;
    };
    std::vector<Arrays> all(static_cast<std::size_t>(threads));
    parallel::for_each(all.size(), [&](std::size_t t) {
        all[t].a.assign(n, 0.0);
        all[t].b.assign(n, 1.0);
        all[t].c.assign(n, 2.0);
    });
    const double seconds = best_time(threads, [&](std::size_t t) {
        double *a = all[t].a.data(), *b = all[t].b.data();
        const double* const c = all[t].c.data();
        for (int k = 0; k < repeats; ++k) {
            for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + 3.0 * c[i];
            std::swap(a, b);
        }
    });
    return 24.0 * static_cast<double>(n) * repeats * threads / seconds * 1e-9;
}

/// Chains of multiply and add that do not wait for each other; more of them than the units can hold.
constexpr int chains = 12;
constexpr int n_fma = 1 << 20;

#if defined(__x86_64__)
__attribute__((target("avx512f"))) double fma_avx512() {
    __m512d a[chains];
    for (int i = 0; i < chains; ++i) a[i] = _mm512_set1_pd(1.0 + i);
    const __m512d b = _mm512_set1_pd(0.999), c = _mm512_set1_pd(0.001);
    for (int k = 0; k < n_fma; ++k)
        for (int i = 0; i < chains; ++i) a[i] = _mm512_fmadd_pd(a[i], b, c);
    double sum = 0.0;
    for (int i = 0; i < chains; ++i) sum += _mm512_cvtsd_f64(a[i]);
    return sum;
}

__attribute__((target("avx2,fma"))) double fma_avx2() {
    __m256d a[chains];
    for (int i = 0; i < chains; ++i) a[i] = _mm256_set1_pd(1.0 + i);
    const __m256d b = _mm256_set1_pd(0.999), c = _mm256_set1_pd(0.001);
    for (int k = 0; k < n_fma; ++k)
        for (int i = 0; i < chains; ++i) a[i] = _mm256_fmadd_pd(a[i], b, c);
    double sum = 0.0;
    for (int i = 0; i < chains; ++i) sum += _mm256_cvtsd_f64(a[i]);
    return sum;
}
#endif

double multiply_add() {
    double a[chains];
    for (int i = 0; i < chains; ++i) a[i] = 1.0 + i;
    for (int k = 0; k < n_fma; ++k)
        for (int i = 0; i < chains; ++i) a[i] = a[i] * 0.999 + 0.001;
    double sum = 0.0;
    for (int i = 0; i < chains; ++i) sum += a[i];
    return sum;
}

/// [GFlop/s]
double fma_peak(int threads) {
    double (*loop)() = multiply_add;
    int width = 1;
#if defined(__x86_64__)
    if (has_instructions(Instructions::avx512)) {
        loop = fma_avx512;
        width = 8;
    } else if (has_instructions(Instructions::avx2)) {
        loop = fma_avx2;
        width = 4;
    }
#endif
    std::vector<double> keep(static_cast<std::size_t>(threads));
    const double seconds = best_time(threads, [&](std::size_t t) { keep[t] += loop(); });
    return 2.0 * chains * width * static_cast<double>(n_fma) * threads / seconds * 1e-9;
}

}  // namespace

Roofline measure_roofline(int threads) {
    set_threads(threads);
    Roofline roof;
    roof.threads = threads;
    roof.triad = triad(threads, std::size_t{8} << 20, 1);
    roof.triad_cache = triad(threads, std::size_t{32} << 10, 200);
    roof.fma = fma_peak(threads);
    return roof;
}

}  // namespace quern::bench
