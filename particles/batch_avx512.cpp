// The loops of batch_loops.hpp for AVX-512; compiled with its own flags (CMakeLists.txt).
#define QUERN_BATCH_LOOPS batch_avx512
#define QUERN_BATCH_NAME "avx512"
#include "particles/batch_loops.hpp"
