// The loops of batch_table.hpp for any x86-64 machine; compiled with its own flags (CMakeLists.txt).
#define QUERN_BATCH_LOOPS batch_plain
#define QUERN_BATCH_NAME "plain"
#include "particles/batch_table.hpp"
