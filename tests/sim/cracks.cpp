// Cracks of the start, zones without failure and scattered strength, in runs and in every force path.
#include "src/sim/cracks.hpp"

#include "particles/weibull.hpp"
#include "tests/sim/program.hpp"
#include "tests/sim/scenes.hpp"

namespace quern::test {

namespace {

/// A bar that is pulled apart at its ends, in the plane.
const std::string bar = R"yaml(title: bar
params: {shift: 0, turn: 0}
materials:
  rubber: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa, critical_stretch: 0.02}
shapes:
  bar: {type: rectangle, size: [1, 0.3], spacing: 0.05}
grid: {origin: [0, 0], extent: [4, 4], spacing: 0.5}
contact: {rule: none}
time: {end: 2 ms}
grains:
  - {shape: bar, material: rubber, position: ["${2 + shift}", 2], angle: "${turn}"}
)yaml";

const std::string space_bar = R"yaml(title: bar
dimension: 3
materials:
  rubber: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa, critical_stretch: 0.02}
shapes:
  bar: {type: box, size: [0.6, 0.3, 0.3], spacing: 0.05}
grid: {origin: [0, 0, 0], extent: [4, 4, 4], spacing: 0.5}
contact: {rule: none}
time: {end: 1 ms}
grains:
  - {shape: bar, material: rubber, position: [2, 2, 2]}
)yaml";

/// Bonds that run from one side of x = middle to the other, as placed.
std::int64_t n_across(const Scene<2>& scene, double middle) {
    std::int64_t n = 0;
    std::visit(
        [&](const auto& model) {
            const Bonds<2>& bonds = model.bonds();
            for (int i = 0; i < bonds.n_nodes(); ++i)
                for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b)
                    n += (scene.x_start[i][0] < middle) != (scene.x_start[bonds.partner[b]][0] < middle);
        },
        scene.groups[0].model);
    return n;
}

const std::string across = "cracks: [{from: [2, 1], to: [2, 3]}]\n";

}  // namespace

TEST_CASE("Cracks: cut what crosses them, in the frame of the world or of the shape, turned and moved") {
    const auto world = scene_of<2>(bar + across);
    CHECK(world->n_cut == n_across(*world, 2.0));
    CHECK(world->n_cut > 50);
    const std::string in_shape = "cracks: [{frame: shape, from: [0, -1], to: [0, 1]}]\n";
    const auto shape = scene_of<2>(bar + in_shape);
    CHECK(shape->alive == world->alive);
    const auto turned =
        scene_of<2>(bar + in_shape, {"params.turn=0.7", "params.shift=0.4", "grains.0.scale=1.3"});
    CHECK(turned->alive == world->alive);
    const auto half = scene_of<2>(bar + "cracks: [{from: [2, 1], to: [2, 2]}]\n");
    CHECK(half->n_cut > world->n_cut / 3);
    CHECK(half->n_cut < 2 * world->n_cut / 3);
}

TEST_CASE("Cracks: in space") {
    const auto whole =
        scene_of<3>(space_bar + "cracks: [{from: [2, 1, 1], to: [2, 3, 1], edge: [0, 0, 3]}]\n");
    const auto half =
        scene_of<3>(space_bar + "cracks: [{from: [2, 1, 1], to: [2, 3, 1], edge: [0, 0, 1]}]\n");
    CHECK(whole->n_cut > 1000);
    CHECK(half->n_cut > whole->n_cut / 3);
    CHECK(half->n_cut < 2 * whole->n_cut / 3);
}

TEST_CASE("Cracks: a grain cut in two flies apart without a force, a loss or damage") {
    for (const std::string breaking : {"0.02", ".inf"}) {
        CAPTURE(breaking);
        const RunRecord run = run_text(bar + across + "loads: [{region: x > 2, acceleration: [1000, 0]}]\n",
                                       {"time.end=20 ms", "materials.rubber.critical_stretch=" + breaking});
        const EnergyBudget& energy = run.summary.energy;
        CHECK(energy.fracture == 0.0);
        // Half of the bar under g for the time t: m (g t)^2/2.
        const double kinetic = 0.5 * 3000.0 * 0.15 * 20.0 * 20.0;
        CHECK(std::abs(energy.kinetic / kinetic - 1.0) < 2e-3);  // measured 4e-4, (steps)^-2/4; bound 2e-3
        CHECK(std::abs(energy.kinetic / energy.external_work - 1.0) < 1e-9);  // measured 1e-15, bound 1e-9
        CHECK(energy.elastic < 1e-12 * kinetic);  // measured 1e-24 J, bound 1e-12 of 0.9 kJ
    }
    auto scene = scene_of<2>(bar + across);
    const Outcome outcome = advance(*scene, 3);
    CHECK(*std::max_element(outcome.frame.damage.begin(), outcome.frame.damage.end()) == 0.0f);
    CHECK(*std::max_element(outcome.frame.damage_z.begin(), outcome.frame.damage_z.end()) < 1e-9f);
}

TEST_CASE("Cracks, no_fail, strength: unions, batches and single grains do the same") {
    const std::string start = R"yaml(cracks:
  - {frame: shape, from: [-0.2, 0.02], to: [0.3, 0.04]}
  - {grains: [0, 5, 17], from: [0, 0.6], to: [6, 0.6]}
  - {shape: bar, frame: shape, from: [0.31, -1], to: [0.31, 0]}
no_fail: [{region: x < 1.5}, {shape: e, frame: shape, region: y > 0}]
)yaml";
    const std::string deck = replaced(unequal_deck, "critical_stretch: 0.03",
                                      "critical_stretch: 0.03, strength: {weibull_modulus: 4, seed: 2}") +
                             start;
    for (const std::string model : {"lps", "peridem"}) {
        CAPTURE(model);
        const std::string law = "materials.rubber.model=" + model;
        const auto together = scene_of<2>(deck, {law}),
                   single = scene_of<2>(deck, {law, "compute.kernel=single"});
        const auto printed = scene_of<2>(deck, {law, "compute.kernel=reference"});
        CHECK(together->unions.size() == 2);
        const Outcome a = advance(*together, 150), b = advance(*single, 150), c = advance(*printed, 150);
        CHECK(together->n_cut == single->n_cut);
        CHECK(single->n_cut > 500);
        CHECK(a.newly_broken == b.newly_broken);
        CHECK(c.newly_broken == b.newly_broken);
        CHECK(b.newly_broken > 50);
        CHECK(std::abs(a.fracture / b.fracture - 1.0) < 1e-9);  // measured 1e-12, bound 1e-9
        CHECK(std::abs(a.elastic / b.elastic - 1.0) < 1e-9);    // measured 1e-12, bound 1e-9
        CHECK(a.frame.damage == b.frame.damage);
        for (std::size_t g = 0; g < single->grains.size(); ++g) {
            CHECK(single->grains[g].strength == weibull_factor(4.0, 2, single->grains[g].id));
            const GrainView<2> view = together->view(static_cast<int>(g));
            CHECK(view.strength == single->grains[g].strength);
        }
    }
}

TEST_CASE("No-fail: bonds with an end in the region hold, the others break") {
    const std::string pull =
        "constraints: [{region: x < 1.6, velocity: [-4, 0]}, {region: x > 2.4, velocity: [4, 0]}]\n";
    const auto free = scene_of<2>(bar + pull),
               held = scene_of<2>(bar + pull + "no_fail: [{region: x < 2}]\n");
    const auto safe = scene_of<2>(bar + pull + "no_fail: [{region: y < 9}]\n");
    const Outcome broken = advance(*free, 400), partly = advance(*held, 400), never = advance(*safe, 400);
    CHECK(broken.newly_broken > 50);
    CHECK(partly.newly_broken > 50);
    CHECK(never.newly_broken == 0);
    const auto worst = [](const Scene<2>& scene, const Frame& frame, bool left) {
        float most = 0.0f;
        for (std::size_t p = 0; p < frame.damage.size(); ++p)
            if ((scene.x_start[p][0] < 2.0 - 0.16) == left) most = std::max(most, frame.damage[p]);
        return most;
    };
    CHECK(worst(*free, broken.frame, true) > 0.1f);
    CHECK(worst(*held, partly.frame, true) == 0.0f);
    CHECK(worst(*held, partly.frame, false) > 0.1f);
}

TEST_CASE("Cracks: node pairs on their two sides repel") {
    const std::string press =
        "loads: [{region: x < 2, acceleration: [3000, 0]}, {region: x > 2, acceleration: [-3000, 0]}]\n";
    for (const std::string method : {"grid", "node_pair"}) {
        const RunRecord run = run_text(
            replaced(bar, "contact: {rule: none}", "contact: {method: " + method + "}") + across + press,
            {"time.end=10 ms", "materials.rubber.critical_stretch=.inf"});
        CHECK(run.summary.energy.fracture == 0.0);
        CHECK((run.summary.energy.contact_elastic > 0.0) == (method == "node_pair"));
        CHECK(run.summary.residual_relative < 1e-2);  // measured 1e-3, bound 1e-2
    }
}

TEST_CASE("Cracks and strength: a run that is resumed ends with the same bits; strength.csv says what was") {
    const TempFolder folder;
    const std::string text =
        replaced(bar, "critical_stretch: 0.02", "critical_stretch: 0.02, strength: {weibull_modulus: 4}") +
        "cracks: [{from: [2, 1], to: [2, 2]}]\nno_fail: [{region: x < 1.8}]\n"
        "output: {checkpoint: {every: 10}}\n"
        "constraints: [{region: x < 1.6, velocity: [-4, 0]}, {region: x > 2.4, velocity: "
        "[4, 0]}]\n";
    const std::string deck = folder.write("deck.yaml", text), out = deck + ".out";
    REQUIRE(quern(folder, {"run", deck, "-o", out, "--set", "time.end=20 ms"}).code == 0);
    const std::string before = read_file(out + "/history.csv");
    CHECK(contains(read_file(out + "/run.log"), "cracks cut"));
    CHECK(read_file(out + "/strength.csv") == fmt::format("grain,strength,critical_stretch\n0,{},{}\n",
                                                          weibull_factor(4.0, 0, 0),
                                                          0.02 * weibull_factor(4.0, 0, 0)));
    REQUIRE(quern(folder, {"run", "--resume", out}).code == 0);
    CHECK(contains(read_file(out + "/run.log"), "goes on from step"));
    CHECK(read_file(out + "/history.csv") == before);
}

TEST_CASE("Cracks, no_fail: what meets nothing is refused") {
    const std::string message = message_of<InputError>(bar + "cracks: [{from: [1, 3], to: [3, 3]}]\n");
    CHECK(contains(message, "deck.yaml:12: cracks.0"));
    CHECK(contains(message, "a crack that crosses no bond"));
    const std::string zone = message_of<InputError>(bar + "no_fail: [{region: x > 3}]\n");
    CHECK(contains(zone, "deck.yaml:12: no_fail.0"));
    CHECK(contains(zone, "a region without particles"));
}

}  // namespace quern::test
