// What the machine gives at best: bandwidth of memory and of the nearest caches, and arithmetic.
#pragma once

#include "tests/benchmark/entry.hpp"

namespace quern::bench {

/// Best of several runs; `threads` of them at once, each on arrays of its own.
Roofline measure_roofline(int threads);

}  // namespace quern::bench
