// A packing as files: CSV for decks, JSON for programs, PNG for eyes.
#pragma once

#include <string>
#include <vector>

#include "src/pack/make_packing.hpp"

namespace quern {

/// What is known of a finished packing.
struct PackingReport {
    double deepest = 0.0, coordination = 0.0;
    std::vector<std::string> groups;  ///< of every grain
};

/// A grain a row, as `grains: - {file: ...}` reads it: x, y, then `radius` where all grains are disks, else
/// `scale` (size over that of the shape as given), angle and shape; group where any edge has one.
std::string packing_csv(const PackSpec& spec, const Packing& packing, const PackingReport& report);

std::string packing_json(const PackSpec& spec, const Packing& packing, const PackingReport& report);

/// Grains in colours: grey and one colour a group where there are groups, else all different. Images across
/// periodic edges are drawn, too.
void draw_packing(const PackSpec& spec, const Packing& packing, const PackingReport& report,
                  const std::string& file);

}  // namespace quern
