// The only place that knows of threads.
//
// Every loop body writes to places of its own, and every sum is taken over fixed blocks in a fixed order:
// results have the same bits for any number of threads.
#pragma once

#include <omp.h>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <vector>

namespace quern::parallel {

inline int n_threads() {
    return omp_get_max_threads();
}
inline void set_threads(int n) {
    omp_set_num_threads(std::max(1, n));
}
inline int thread_id() {
    return omp_get_thread_num();
}

/// Calls body(i) for i in [0, n). Bodies must be independent. Loops shorter than `serial_below` stay on the
/// calling thread, where waking the others would cost more than it saves.
template <class Body>
void for_each(std::size_t n, Body&& body, std::size_t serial_below = 2) {
    if (n < serial_below || n_threads() == 1) {
        for (std::size_t i = 0; i < n; ++i) body(i);
        return;
    }
    const auto count = static_cast<std::ptrdiff_t>(n);
    const auto chunk = std::max<std::ptrdiff_t>(1, count / (16 * n_threads()));
#pragma omp parallel for schedule(dynamic, chunk)
    for (std::ptrdiff_t i = 0; i < count; ++i) body(static_cast<std::size_t>(i));
}

/// Sum of term(i) over [0, n) in blocks, added block by block: the same bits for any number of threads. T
/// needs `+=` and a zero value given as `zero`. `block`: 256 for terms of a particle, 1 for those that
/// are a thread's work; fewer than max(2, block / 16) blocks stay on the calling thread.
template <class T, class Term>
T sum(std::size_t n, const T& zero, Term&& term, std::size_t block = 256) {
    const std::size_t n_blocks = (n + block - 1) / block;
    std::vector<T> partial(n_blocks, zero);
    for_each(
        n_blocks,
        [&](std::size_t b) {
            T total = zero;
            for (std::size_t i = b * block, end = std::min(n, i + block); i < end; ++i) total += term(i);
            partial[b] = total;
        },
        std::max<std::size_t>(2, block / 16));
    T total = zero;
    for (const T& part : partial) total += part;
    return total;
}

}  // namespace quern::parallel
