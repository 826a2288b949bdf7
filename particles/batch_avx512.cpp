// The loops of batch_table.hpp for AVX-512; compiled with its own flags (CMakeLists.txt).
#define QUERN_BATCH_LOOPS batch_avx512
#define QUERN_BATCH_NAME "avx512"
#include "particles/batch_table.hpp"
