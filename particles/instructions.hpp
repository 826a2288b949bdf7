// Instruction sets that the loops over batches exist for.
#pragma once

namespace quern {

/// `best`: the widest that this machine has.
enum class Instructions { best, avx512, avx2, plain };

/// Whether this build and this machine have it.
bool has_instructions(Instructions set);

}  // namespace quern
