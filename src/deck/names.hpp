// Nearest valid name for a mistyped one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace quern {

/// The candidate with the smallest edit distance to `name` (insertions, deletions, substitutions and swaps of
/// neighbours), or "" if none is near: more than a third of the letters, at least two, would have to change.
std::string nearest_name(std::string_view name, const std::vector<std::string>& candidates);

/// "did you mean density?", or "" if nothing is near.
std::string did_you_mean(std::string_view name, const std::vector<std::string>& candidates);

/// "a, b, c".
std::string join(const std::vector<std::string>& words, std::string_view separator = ", ");

}  // namespace quern
