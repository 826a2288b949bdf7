// The file that asks for a packing: what it says, and every kind of bad input.
#include <doctest/doctest.h>

#include <sstream>

#include "grid/error.hpp"
#include "tests/pack/specs.hpp"

using namespace quern;

TEST_CASE("read_pack_spec: values, parameters, units and defaults") {
    const PackSpec spec = read_spec_text(plain_spec, {"params.mean=58 um"});
    CHECK(spec.seed == 3);
    CHECK(spec.region.low == std::array<double, 2>{1e-3, -1e-3});
    CHECK(spec.region.high[0] == doctest::Approx(1.5e-3));
    CHECK(spec.region.rule == std::array<EdgeRule, 2>{EdgeRule::closed, EdgeRule::periodic});
    CHECK(spec.solid_fraction == 0.8);
    CHECK(spec.count == 0);
    CHECK(*spec.sizes.mean == 58e-6);
    CHECK(spec.shapes.size() == 1);
    CHECK(spec.shapes[0].share == 1.0);
    CHECK(spec.edges.x_high == "moved");
}

TEST_CASE("read_pack_spec: sizes from a column of a CSV") {
    const TempFolder folder;
    folder.write("sieve.csv", "# sieved\nname,d\na,30\nb, 50\n");
    const std::string from = "  type: power_law\n  min: 31 um\n  max: 100 um\n  mean: ${mean}\n";
    const auto read = [&](const std::string& sizes) {
        return read_pack_spec(folder.write("spec.yaml", replaced(plain_spec, from, sizes)));
    };
    const PackSpec spec = read("  type: file\n  file: sieve.csv\n  column: d\n  unit: 1 um\n");
    REQUIRE(spec.sizes.values.size() == 2);
    CHECK(spec.sizes.values[0] == doctest::Approx(30e-6));
    CHECK(spec.sizes.values[1] == doctest::Approx(50e-6));
    CHECK_THROWS_WITH_AS(read("  {type: file, file: sieve.csv, column: nam}\n"),
                         doctest::Contains("did you mean name?"), InputError);
    CHECK_THROWS_WITH_AS(read("  {type: file, file: sieve.csv, column: name}\n"),
                         doctest::Contains("sieve.csv:3: name: got 'a', expected a number > 0"), InputError);
    CHECK_THROWS_WITH_AS(read("  {type: file, file: none.csv}\n"), doctest::Contains("an existing file"),
                         InputError);
}

TEST_CASE("read_pack_spec: bad input names file, line, key, and what is expected") {
    struct Bad {
        const char *from, *to;
        std::vector<std::string> parts;
    };
    const Bad cases[] = {
        {"seed: 3", "sed: 3", {"spec.yaml:3: sed", "unknown key", "did you mean seed?"}},
        {"  x: closed", "  x: close", {"spec.yaml:8: region.x", "did you mean closed?"}},
        {"  type: box", "  type: bx", {"spec.yaml:5: region.type", "one of box, circle"}},
        {"  type: power_law", "  type: power", {"sizes.type", "one of list, file, uniform"}},
        {"solid_fraction: 0.8", "solid_fraction: 1.2", {"spec.yaml:10: solid_fraction", "in (0, 1)"}},
        {"solid_fraction: 0.8\n", "", {"neither count nor solid_fraction"}},
        {"  max: 100 um", "  max: 20 um", {"spec.yaml:14: sizes.max", "more than min"}},
        {"${mean}", "20 um", {"spec.yaml:15: sizes.mean", "between min and max"}},
        {"  mean: ${mean}", "", {"neither mean nor exponent", "exactly one of"}},
        {"  mean: ${mean}", "  deviation: 0.3", {"sizes.deviation", "to power_law", "only to lognormal"}},
        {"power_law", "lognormal\n  deviation: 0.3\n  exponent: 2", {"sizes.exponent", "only to power_law"}},
        {"radius: 1 mm", "radius: 1 mm, share: 0", {"shapes.round.share", "a number > 0"}},
        {"disk, radius: 1 mm", "sphere, radius: 1 mm", {"shapes.round.type", "got sphere"}},
        {"disk, radius: 1 mm", "mesh", {"shapes.round.type", "got mesh", "convex polygon"}},
        {"{type: disk, radius: 1 mm}",
         "{type: polygon, vertices: [[0, 0], [1, 0], [0.1, 0.1], [0, 1]]}",
         {"spec.yaml:17: shapes.round.vertices", "not convex"}},
        {"x-: held", "y-: held", {"edges.y-", "an edge that is periodic"}},
        {"x-: held", "rim: held", {"edges.rim", "one of x-, x+"}},
        {"x-: held", "x-: 3", {"spec.yaml:18: edges.x-", "the name of a group"}},
        {"x-: held", "x-: all", {"edges.x-", "'all'", "not all"}},
    };
    for (const Bad& bad : cases) {
        CAPTURE(bad.to);
        std::string message;
        try {
            read_spec_text(replaced(plain_spec, bad.from, bad.to));
        } catch (const InputError& error) {
            message = error.what();
        }
        CAPTURE(message);
        for (const std::string& part : bad.parts) CHECK(message.find(part) != std::string::npos);
    }
}

TEST_CASE("make_packing: grains that do not fit the region are refused") {
    PackSpec spec = read_spec_text(plain_spec);
    spec.sizes = {};
    spec.sizes.values = {0.2e-3};
    CHECK_THROWS_WITH_AS(make_packing(spec), doctest::Contains("twice the largest grain"), InputError);
    spec.sizes.values = {1e-9};
    CHECK_THROWS_WITH_AS(make_packing(spec), doctest::Contains("check the units"), InputError);
}

TEST_CASE("docs/pack.md: holds the reference made from the table of keys, its example is read") {
    std::ifstream file("docs/pack.md");
    REQUIRE(file.good());
    std::ostringstream text;
    text << file.rdbuf();
    const std::string docs = text.str();
    CHECK(docs.find(pack_reference()) != std::string::npos);
    const std::size_t begin = docs.find("```yaml\n"), end = docs.find("```", begin + 8);
    REQUIRE(begin != std::string::npos);
    CHECK(read_spec_text(docs.substr(begin + 8, end - begin - 8)).seed == 1);
}
