// Packings: no overlap, the fraction asked for, images, edges, shapes, the same bits again.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "grid/error.hpp"
#include "src/pack/packing_files.hpp"
#include "tests/pack/specs.hpp"

using namespace quern;

namespace {

constexpr double pi = std::numbers::pi;

/// Deepest overlap of disks over their mean size, by all pairs and all images.
double overlap_of_disks(const PackedGrains& g) {
    double deepest = 0.0;
    const int nx = g.region.periodic(0) ? 1 : 0, ny = g.region.periodic(1) ? 1 : 0;
    for (int i = 0; i < g.n(); ++i)
        for (int j = 0; j < g.n(); ++j)
            for (int a = -nx; a <= nx; ++a)
                for (int b = -ny; b <= ny; ++b) {
                    if (i == j && a == 0 && b == 0) continue;
                    const double dx = g.x[j] + a * g.region.length(0) - g.x[i];
                    const double dy = g.y[j] + b * g.region.length(1) - g.y[i];
                    const double touch = 0.5 * (g.size[i] + g.size[j]);
                    deepest = std::max(deepest, 1.0 - std::hypot(dx, dy) / touch);
                }
    return deepest;
}

double sum_of_areas(const PackedGrains& g) {
    double sum = 0.0;
    for (const double size : g.size) sum += 0.25 * pi * size * size;
    return sum;
}

}  // namespace

TEST_CASE("make_packing: closed and periodic boxes hold the fraction asked for without overlap") {
    for (const EdgeRule x : {EdgeRule::closed, EdgeRule::periodic}) {
        PackSpec spec = unit_spec(x, EdgeRule::periodic, 0.1, 0.78);
        spec.sizes.values = {0.06, 0.1, 0.14};
        const Packing packing = make_packing(spec);
        const PackedGrains& g = packing.grains;
        REQUIRE(packing.reached);
        CHECK(overlap_of_disks(g) < 1e-6);  // measured 0, bound 1e-6
        CHECK(deepest_overlap(g) < 1e-6);
        CHECK(sum_of_areas(g) == doctest::Approx(packing.fraction).epsilon(1e-12));
        CHECK(packing.fraction == doctest::Approx(0.78).epsilon(1e-6));
        CHECK(std::abs(packing.size_factor - 1.0) < 0.5 / g.n());
        for (int i = 0; i < g.n(); ++i) {
            const double inside = x == EdgeRule::closed ? (1.0 - 1e-6) * 0.5 * g.size[i] : 0.0;
            CHECK(std::min(g.x[i], 1.0 - g.x[i]) >= inside);
            CHECK(std::min(g.y[i], 1.0 - g.y[i]) >= 0.0);
        }
    }
}

TEST_CASE("make_packing: grains over open edges count with what lies inside") {
    PackSpec spec = unit_spec(EdgeRule::open, EdgeRule::periodic, 0.1, 0.8);
    spec.sizes.values = {0.06, 0.1, 0.14};
    spec.edges.x_low = "held";
    spec.edges.x_high = "moved";
    const Packing packing = make_packing(spec);
    const PackedGrains& g = packing.grains;
    REQUIRE(packing.reached);
    CHECK(std::abs(packing.fraction - 0.8) < 1e-4);  // measured 2e-6, bound 1e-4
    CHECK(overlap_of_disks(g) < 1e-6);
    double cut = sum_of_areas(g);
    const std::vector<std::string> groups = find_groups(g, spec.edges);
    int n_held = 0;
    for (int i = 0; i < g.n(); ++i) {
        const double r = 0.5 * g.size[i];
        CHECK(g.x[i] >= 0.0);
        CHECK(g.x[i] <= 1.0);
        for (const double inside : {g.x[i], 1.0 - g.x[i]})
            if (inside < r)  // a segment of the circle
                cut -= r * r * std::acos(inside / r) - inside * std::sqrt(r * r - inside * inside);
        CHECK(groups[i] == (g.x[i] < r ? "held" : g.x[i] > 1.0 - r ? "moved" : ""));
        n_held += groups[i] == "held";
    }
    CHECK(cut == doctest::Approx(packing.fraction).epsilon(1e-12));
    CHECK(n_held > 5);
    CHECK(std::abs(packing.size_factor - 1.0) < 0.03);  // measured 0.005, bound 0.03
}

TEST_CASE("make_packing: count and fraction, count alone") {
    PackSpec spec = unit_spec(EdgeRule::periodic, EdgeRule::periodic, 0.1, 0.7);
    spec.count = 85;
    Packing packing = make_packing(spec);
    CHECK(packing.grains.n() == 85);
    CHECK(packing.fraction == doctest::Approx(0.7).epsilon(1e-6));
    CHECK(packing.size_factor == doctest::Approx(std::sqrt(0.7 / (85 * 0.25 * pi * 0.01))).epsilon(1e-6));
    spec.solid_fraction.reset();
    packing = make_packing(spec);
    CHECK(packing.size_factor == 1.0);
    CHECK(packing.fraction == doctest::Approx(85 * 0.25 * pi * 0.01).epsilon(1e-6));
    spec.solid_fraction = 0.7;
    spec.count = 120;
    CHECK_THROWS_WITH_AS(make_packing(spec), doctest::Contains("count: 89 would do"), InputError);
}

TEST_CASE("make_packing: every shape alone, and all mixed by their shares") {
    PackSpec spec = unit_spec(EdgeRule::closed, EdgeRule::periodic, 0.12, 0.72);
    const ShapeKind kinds[] = {ShapeKind::rectangle, ShapeKind::regular_polygon, ShapeKind::polygon,
                               ShapeKind::ellipse, ShapeKind::disk};
    for (const ShapeKind kind : kinds) {
        CAPTURE(static_cast<int>(kind));
        spec.shapes = {shape_of("alone", kind)};
        const Packing packing = make_packing(spec);
        CHECK(packing.reached);
        CHECK(deepest_overlap(packing.grains) < 1e-6);
        CHECK(packing.fraction == doctest::Approx(0.72).epsilon(1e-4));
        CHECK(packing.shrink < 0.01);
    }
    spec.shapes.clear();
    for (const ShapeKind kind : kinds)
        spec.shapes.push_back(shape_of(fmt::format("s{}", static_cast<int>(kind)), kind));
    spec.shapes[0].share = 3.0;
    const Packing packing = make_packing(spec);
    CHECK(packing.reached);
    CHECK(deepest_overlap(packing.grains) < 1e-6);
    const auto n_first = std::count(packing.grains.outline.begin(), packing.grains.outline.end(), 0);
    CHECK(std::abs(static_cast<double>(n_first) - packing.grains.n() * 3.0 / 7.0) <= 0.5);
}

TEST_CASE("make_packing: grains stay inside a circle, those at its rim are told") {
    PackSpec spec = unit_spec(EdgeRule::closed, EdgeRule::closed, 0.1, 0.75);
    spec.region.circle = true;
    spec.region.centre = {0.5, 0.5};
    spec.region.radius = 0.5;
    spec.sizes.values = {0.06, 0.1};
    spec.shapes = {shape_of("disk", ShapeKind::disk), shape_of("ellipse", ShapeKind::ellipse)};
    spec.edges.rim = "rim";
    const Packing packing = make_packing(spec);
    CHECK(packing.reached);
    CHECK(deepest_overlap(packing.grains) < 1e-6);
    CHECK(sum_of_areas(packing.grains) / (0.25 * pi) == doctest::Approx(0.75).epsilon(1e-4));
    TurnedCorners corners;
    turn_corners(packing.grains, 1.0, corners);
    double farthest = 0.0;
    for (int i = 0; i < packing.grains.n(); ++i) {
        const double x = packing.grains.x[i] - 0.5, y = packing.grains.y[i] - 0.5;
        if (packing.grains.outline_of(i).disk)
            farthest = std::max(farthest, std::hypot(x, y) + packing.grains.reach(i));
        for (int k = corners.first[i]; k < corners.first[i] + packing.grains.outline_of(i).n(); ++k)
            farthest = std::max(farthest, std::hypot(x + corners.x[k], y + corners.y[k]));
    }
    CHECK(farthest < 0.5 + 1e-7);
    CHECK(farthest > 0.49);
}

TEST_CASE("make_packing: what cannot be reached says so and keeps the densest packing found") {
    PackSpec spec = unit_spec(EdgeRule::periodic, EdgeRule::periodic, 0.1, 0.96);
    spec.rounds = 5;
    const Packing packing = make_packing(spec);
    CHECK_FALSE(packing.reached);
    CHECK(packing.fraction > 0.75);
    CHECK(packing.fraction < 0.9069);  // of the hexagonal packing
    CHECK(overlap_of_disks(packing.grains) < 1e-6);
}

TEST_CASE("make_packing: the same bits for the same seed, others for another") {
    PackSpec spec = unit_spec(EdgeRule::open, EdgeRule::periodic, 0.1, 0.8);
    spec.sizes.values = {0.08, 0.12};
    const PackedGrains first = make_packing(spec).grains, second = make_packing(spec).grains;
    CHECK(first.x == second.x);
    CHECK(first.size == second.size);
    spec.seed = 1;
    CHECK(make_packing(spec).grains.x != first.x);
}

TEST_CASE("packing_csv: decks read it, with radii or scales, shapes and groups") {
    const TempFolder folder;
    PackSpec spec = read_spec_text(plain_spec);
    const auto deck_of = [&](const std::string& shapes) {
        const Packing packing = make_packing(spec);
        const PackingReport report{0.0, 0.0, find_groups(packing.grains, spec.edges)};
        folder.write("packing.csv", packing_csv(spec, packing, report));
        const std::string deck = replaced(
            replaced(replaced(plain_deck, "  - {shape: disk, material: glass, position: [2 mm, 2 mm]}\n",
                              "  - {file: packing.csv, material: glass}\n"),
                     "  - {shape: disk, material: glass, position: [5 mm, 2 mm]}\n", ""),
            "origin: [0, 0]\n  extent: [10 mm, 8 mm]", "origin: [0, -2 mm]\n  extent: [4 mm, 4 mm]");
        const Deck read = read_deck(
            folder.write("deck.yaml", replaced(deck, "shapes:\n", "shapes:\n" + shapes)), {"walls=[]"});
        const PackedGrains& g = packing.grains;
        REQUIRE(static_cast<int>(read.grains.size()) == g.n());
        for (int i = 0; i < g.n(); ++i) {
            CHECK(read.grains[i].position[0] == doctest::Approx(g.x[i]).epsilon(1e-9));
            CHECK(read.grains[i].shape == g.outline_of(i).name);
            CHECK(read.grains[i].group == report.groups[i]);
            CHECK(read.grains[i].scale * g.outline_of(i).reference ==
                  doctest::Approx(g.size[i]).epsilon(1e-9));
        }
    };
    const std::string round = "  round: {type: disk, radius: 1 mm, spacing: 0.1 mm}\n";
    deck_of(round);
    spec.shapes.push_back(shape_of("long", ShapeKind::ellipse));
    deck_of(round + "  long: {type: ellipse, semi_axes: [2, 1], spacing: 0.1}\n");
}
