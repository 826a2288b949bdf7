// Pictures of a report.
#pragma once

#include "tests/benchmark/entry.hpp"

namespace quern::bench {

/// Cost of a step and memory against the number of grains, forces by width of the vectors, and the roofline.
/// Charts without a point are left out.
void draw_report(const Report& report, const std::string& file);

}  // namespace quern::bench
