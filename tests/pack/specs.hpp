// Specs of packings on disk for the tests: a small one, and variants of it.
#pragma once

#include "src/pack/make_packing.hpp"
#include "src/pack/measure.hpp"
#include "tests/deck/deck_files.hpp"

namespace quern {

/// Its lines are counted by the tests of messages.
inline const std::string plain_spec = R"(title: Disks
params: {mean: 57 um}
seed: 3
region:
  type: box
  origin: [1 mm, -1 mm]
  extent: [0.5 mm, 0.4 mm]
  x: closed
  y: periodic
solid_fraction: 0.8
sizes:
  type: power_law
  min: 31 um
  max: 100 um
  mean: ${mean}
shapes:
  round: {type: disk, radius: 1 mm}
edges: {x-: held, x+: moved}
)";

inline PackSpec read_spec_text(const std::string& text, const std::vector<std::string>& overrides = {}) {
    const TempFolder folder;
    return read_pack_spec(folder.write("spec.yaml", text), overrides);
}

/// A box of a metre and equal grains, for what does not depend on their sizes.
inline PackSpec unit_spec(EdgeRule x, EdgeRule y, double size, double fraction) {
    PackSpec spec;
    spec.region.high = {1.0, 1.0};
    spec.region.rule = {x, y};
    spec.solid_fraction = fraction;
    spec.sizes.values = {size};
    return spec;
}

inline PackShape shape_of(const std::string& name, ShapeKind kind) {
    PackShape shape;
    shape.name = name;
    shape.kind = kind;
    shape.radius = 1.0;
    shape.sides = 6;
    shape.size = {2.0, 1.0, 0.0};
    shape.semi_axes = {2.0, 1.0};
    shape.vertices = {{0.0, 0.0}, {2.0, 0.0}, {2.0, 1.0}, {0.5, 2.0}};
    return shape;
}

}  // namespace quern
