// The packing of examples/granular_shear comes out of its file again, to the last digit.
#include <doctest/doctest.h>

#include <algorithm>
#include <sstream>

#include "src/pack/packing_files.hpp"
#include "tests/pack/specs.hpp"

using namespace quern;

TEST_CASE("examples/granular_shear: the packing is that of its seed") {
    const PackSpec spec = read_pack_spec("examples/granular_shear/packing.yaml");
    const Packing packing = make_packing(spec);
    const PackedGrains& g = packing.grains;
    CHECK(packing.reached);
    CHECK(g.n() == 369);
    CHECK(std::abs(packing.fraction - 0.89) < 1e-4);  // measured 5e-5, bound 1e-4
    CHECK(*std::min_element(g.size.begin(), g.size.end()) > 31e-6);
    CHECK(*std::max_element(g.size.begin(), g.size.end()) < 250e-6);
    CHECK(deepest_overlap(g) < 1e-6);
    const PackingReport report{0.0, 0.0, find_groups(g, spec.edges)};
    CHECK(std::count(report.groups.begin(), report.groups.end(), "held") == 18);
    CHECK(std::count(report.groups.begin(), report.groups.end(), "moved") == 18);
    std::ifstream file("examples/granular_shear/packing.csv");
    std::ostringstream text;
    text << file.rdbuf();
    CHECK(packing_csv(spec, packing, report) == text.str());
}
