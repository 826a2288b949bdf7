// What a packing is: fraction, overlaps, contacts, grains at edges.
#pragma once

#include <string>
#include <vector>

#include "src/pack/pack_spec.hpp"
#include "src/pack/soft_grains.hpp"

namespace quern {

/// Area of the grains within the region over that of the region. Grains over open edges are cut at them; a
/// polygon that stands for an ellipse counts with the area of the ellipse.
double solid_fraction(const PackedGrains& grains, double factor);

/// Deepest overlap of two grains, or of a grain and a closed edge, over the sum of the inner radii.
double deepest_overlap(const PackedGrains& grains);

/// Contacts a grain: mean number of grains nearer than 0.1 % of the size.
double coordination(const PackedGrains& grains);

/// Group of every grain; "": none.
std::vector<std::string> find_groups(const PackedGrains& grains, const EdgeGroups& edges);

}  // namespace quern
