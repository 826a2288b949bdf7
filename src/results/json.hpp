// The little JSON that a run writes.
#pragma once

#include <string>
#include <string_view>

#include "src/results/records.hpp"

namespace quern {

/// A quoted JSON string; control characters are escaped, bytes that are not UTF-8 become U+FFFD.
std::string json_string(std::string_view text);

/// Shortest number that reads back to the same double; null for a number that is not finite (JSON has none).
std::string json_number(double value);

/// summary.json, keys in a fixed order.
std::string make_summary_json(const Summary& summary);

}  // namespace quern
