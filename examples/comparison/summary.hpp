// The main numbers of all cases of a comparison in one table and one picture.
#pragma once

#include <string>
#include <vector>

namespace quern {

/// Reads DIRECTORY/CASE/comparison.json of the cases and writes DIRECTORY/summary.md and summary.png: numbers
/// at the last level of each, the best of a row in bold. Throws InputError, OutputError.
void write_summary(const std::string& directory);

}  // namespace quern
