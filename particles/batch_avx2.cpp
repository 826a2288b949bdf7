// The loops of batch_table.hpp for AVX2 and FMA; compiled with its own flags (CMakeLists.txt).
#define QUERN_BATCH_LOOPS batch_avx2
#define QUERN_BATCH_NAME "avx2"
#include "particles/batch_table.hpp"
