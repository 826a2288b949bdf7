// Bonds that break by energy, in runs and in every force path.
#include <cstring>

#include "src/sim/step.hpp"
#include "tests/sim/decks.hpp"
#include "tests/sim/program.hpp"

namespace quern::test {
namespace {

std::unique_ptr<Scene<2>> scene_of(const std::string& text, const std::vector<std::string>& overrides) {
    const TempFolder folder;
    const Deck deck = read_deck(folder.write("deck.yaml", text), overrides);
    std::unique_ptr<Scene<2>> scene = make_scene<2>(deck);
    set_initial_velocities(deck, *scene);
    return scene;
}

struct Outcome {
    std::int64_t newly_broken = 0;
    double fracture = 0.0, elastic = 0.0;
};

Outcome advance(Scene<2>& scene, int steps) {
    StepContext<2> now = make_context(scene, 0.3 * scene.stable_step());
    for (int k = 0; k < steps; ++k) {
        kick(scene, now);
        drift(scene, now);
    }
    return {now.newly_broken, now.ledger.past.fracture, scene.elastic_energy()};
}

}  // namespace

TEST_CASE("Bond energy: unions, batches and single grains do the same, springs as by the stretch") {
    const std::string deck =
        replaced(unequal_deck, "critical_stretch: 0.03", "fracture_energy: 6000, breaks_by: energy");
    const auto together = scene_of(deck, {}), single = scene_of(deck, {"compute.kernel=single"});
    CHECK(together->unions.size() == 2);
    const Outcome a = advance(*together, 150), b = advance(*single, 150);
    CHECK(b.newly_broken > 50);
    CHECK(a.newly_broken == b.newly_broken);
    CHECK(std::abs(a.fracture / b.fracture - 1.0) < 1e-9);  // measured 4e-15, bound 1e-9
    CHECK(std::abs(a.elastic / b.elastic - 1.0) < 1e-9);    // measured 4e-15, bound 1e-9

    const std::string springs = replaced(deck, "shear_modulus: 2.5 MPa", "shear_modulus: 6 MPa");
    const auto by_energy = scene_of(springs, {}),
               by_stretch = scene_of(springs, {"materials.rubber.breaks_by=stretch"});
    const Outcome c = advance(*by_energy, 150), d = advance(*by_stretch, 150);
    CHECK(d.newly_broken > 50);
    CHECK(std::abs(c.newly_broken - d.newly_broken) <= 2);  // the trapezoids of W; measured 0, bound 2
}

TEST_CASE("Bond energy: a run that is resumed ends with the same bits") {
    const TempFolder folder;
    const std::string text = R"yaml(title: bar
materials:
  rubber: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa, fracture_energy: 1000, breaks_by: energy}
shapes:
  bar: {type: rectangle, size: [1, 0.3], spacing: 0.05}
grid: {origin: [0, 0], extent: [4, 4], spacing: 0.5}
contact: {rule: none}
time: {end: 20 ms}
output: {checkpoint: {every: 10}}
constraints: [{region: x < 1.6, velocity: [-4, 0]}, {region: x > 2.4, velocity: [4, 0]}]
grains:
  - {shape: bar, material: rubber, position: [2, 2]}
)yaml";
    const std::string deck = folder.write("deck.yaml", text), out = deck + ".out";
    REQUIRE(quern(folder, {"run", deck, "-o", out}).code == 0);
    const std::string before = read_file(out + "/history.csv");
    REQUIRE(quern(folder, {"run", "--resume", out}).code == 0);
    CHECK(contains(read_file(out + "/run.log"), "goes on from step"));
    CHECK(read_file(out + "/history.csv") == before);
}

}  // namespace quern::test
