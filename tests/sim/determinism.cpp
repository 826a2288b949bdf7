// The same bits for any number of threads and any number of runs.
#include <cmath>

#include "grid/parallel.hpp"
#include "tests/sim/decks.hpp"

namespace quern::test {

namespace {

const std::string packing = R"yaml(title: packing
materials:
  rubber: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa, bond_damping: 0.1 ms}
  light: {density: 1000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa, critical_stretch: 0.02}
shapes:
  disk: {type: disk, filling: rings, radius: 0.5, spacing: 0.125}
  block: {type: rectangle, size: [0.8, 0.6], spacing: 0.1}
grid: {origin: [0, 0], extent: [7, 7], spacing: 0.25}
gravity: [0, -9.8]
walls: [{side: y-, friction: 0.3}, {side: x-}, {side: x+}]
contact: {friction: 0.3}
time: {end: 0.15}
output: {interval: 0.1, history_interval: 0.01}
grains:
  - {shape: disk, material: rubber, array: {counts: [6, 3], origin: [0.6, 0.55], step: [1.1, 1.04], jitter: 0.02,
     scale: [0.9, 1], seed: 3}, velocity: [0, -3]}
  - {shape: block, material: light, array: {counts: [6, 2], origin: [0.6, 3.6], step: [1.1, 1.04]},
     velocity: [0, -3], angle: 0.2}
)yaml";

void check_threads(const std::string& deck, const std::vector<std::string>& overrides, int n_grains) {
    std::string hash;
    double energy = 0.0;
    for (const int threads : {1, 2, 3, 1}) {
        CAPTURE(threads);
        const RunRecord record = run_text(deck, overrides, threads);
        CHECK(record.summary.threads == threads);
        CHECK(record.summary.n_grains == n_grains);
        CHECK(record.summary.energy.contact_loss > 0.0);
        if (hash.empty()) {
            hash = record.summary.state_hash;
            energy = record.summary.energy.residual;
        }
        CHECK(record.summary.state_hash == hash);
        CHECK(record.summary.energy.residual == energy);
    }
    CHECK(hash.size() == 16);
    parallel::set_threads(1);
}

const std::string mixed = R"yaml(title: polygons and disks
params: {seed: 1}
materials:
  rubber: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa, bond_damping: 0.1 ms}
shapes:
  disk: {type: disk, filling: rings, radius: 0.5, spacing: "${1/12}"}
  lat: {type: disk, filling: lattice, radius: 0.5, spacing: "${1/12}"}
  hex: {type: regular_polygon, filling: lattice, sides: 6, radius: 0.5, spacing: "${1/12}"}
  tri: {type: regular_polygon, filling: lattice, sides: 3, radius: 0.55, spacing: "${1/12}"}
grid: {origin: [0, 0], extent: [8, 16], spacing: "${1/6}"}
gravity: [0, -9.8]
walls: [{side: y-, friction: 0.3}, {side: x-}, {side: x+}]
contact: {friction: 0.3}
time: {end: 0.6}
output: {interval: 1, history_interval: 0.1}
grains:
  - {shape: hex, material: rubber, velocity: [0, -3], angle: 0.3,
     array: {counts: [6, 3], origin: [0.7, 0.6], step: [1.2, 1.1], jitter: 0.03, scale: [0.8, 1], seed: "${seed}"}}
  - {shape: disk, material: rubber, velocity: [0, -3],
     array: {counts: [6, 3], origin: [0.7, 4.1], step: [1.2, 1.1], jitter: 0.03, scale: [0.8, 1], seed: "${seed}"}}
  - {shape: tri, material: rubber, velocity: [0, -3], angle: 0.7,
     array: {counts: [6, 3], origin: [0.7, 7.6], step: [1.2, 1.1], jitter: 0.03, scale: [0.8, 1], seed: "${seed}"}}
  - {shape: lat, material: rubber, velocity: [0, -3],
     array: {counts: [6, 3], origin: [0.7, 11.1], step: [1.2, 1.1], jitter: 0.03, scale: [0.8, 1], seed: "${seed}"}}
)yaml";

}  // namespace

TEST_CASE("Determinism: thirty grains in the plane, every method") {
    check_threads(packing, {}, 30);
    check_threads(packing, {"contact.coupling=flip"}, 30);
    check_threads(packing, {"contact.rule=seed"}, 30);
    check_threads(packing, {"contact.method=node_pair", "contact.node_pair={damping: nodes}"}, 30);
    check_threads(packing, {"contact.rule=surface"}, 30);
    check_threads(packing, {"contact.walls=exact"}, 30);
}

TEST_CASE("Determinism: lattice grains of unlike size, which share unions and break") {
    check_threads(unequal_deck, {}, 21);
    CHECK(run_text(unequal_deck).summary.energy.fracture > 0.0);
}

TEST_CASE("Determinism: a small packing in space") {
    check_threads(space_deck + R"yaml(
time: {end: 0.05}
gravity: [0, 0, -9.8]
walls: [{side: z-, friction: 0.3}]
contact: {friction: 0.3}
output: {interval: 0.1, history_interval: 0.01}
grains:
  - {shape: ball, material: rubber, array: {counts: [3, 2, 2], origin: [0.7, 0.7, 0.52], step: [1.02, 1.02, 1.02]},
     velocity: [0, 0.3, -2]}
)yaml",
                  {}, 12);
}

TEST_CASE("Determinism: results do not depend on how long a search for contact nodes lasts") {
    // Breaking blocks, rolling disks and walls; polygons and disks that fall on each other with steps longer
    // than the shortest skin: a node that slept when it was needed would change the bits.
    const auto check = [](const std::string& deck, const std::vector<std::string>& overrides) {
        const auto with = [&](const std::string& skin) {
            std::vector<std::string> all = overrides;
            all.push_back("contact.skin=" + skin);
            return run_text(deck, all).summary.state_hash;
        };
        const std::string every_step = with("0");
        for (const std::string skin : {"0.02", "0.1", "0.2", "0.25"}) {
            CAPTURE(skin);
            CHECK(with(skin) == every_step);
        }
    };
    check(packing, {"time.end=0.3"});
    check(packing, {"time.end=0.2", "contact.rule=surface"});
    for (const std::string seed : {"2", "4"}) check(mixed, {"params.seed=" + seed});
    check(mixed, {"params.seed=2", "contact.rule=surface", "time.end=0.4"});
}

TEST_CASE("Determinism: results do not depend on how long a list of node pairs serves") {
    for (const std::string law : {"history", "slip"}) {
        const auto run = [&](const std::string& skin) {
            return run_text(packing, {"contact.method=node_pair",
                                      "contact.node_pair={friction_law: " + law + ", skin: " + skin + "}",
                                      "materials.light.critical_stretch=0.001", "time.end=0.25"})
                .summary;
        };
        const Summary every_step = run("0"), kept = run("0.3");
        CHECK(kept.state_hash == every_step.state_hash);
        CHECK(run("1").state_hash == every_step.state_hash);
        CHECK(kept.contact_per_step[3].second < 0.5 * every_step.contact_per_step[3].second);
        CHECK(every_step.energy.fracture != 0.0);
    }
}

TEST_CASE("Determinism: every kernel and instruction set agrees to round-off, breaking included") {
    const auto run_with = [](const std::string& choice) {
        return run_text(packing, {"materials.light.critical_stretch=0.003", "compute." + choice}).summary;
    };
    const Summary printed = run_with("kernel=reference");
    CHECK(printed.energy.fracture < 0.0);
    CHECK(printed.residual_relative < 5e-4);  // measured 2.1e-4, bound 5e-4
    std::vector<std::string> choices = {"kernel=single", "kernel=auto", "instructions=plain"};
    if (has_instructions(Instructions::avx2)) choices.push_back("instructions=avx2");
    if (has_instructions(Instructions::avx512)) choices.push_back("instructions=avx512");
    for (const std::string& choice : choices) {
        CAPTURE(choice);
        const Summary summary = run_with(choice);
        if (choice.rfind("instructions=", 0) == 0) CHECK("instructions=" + summary.instructions == choice);
        CHECK(summary.state_hash != printed.state_hash);  // the choice was taken
        const EnergyBudget &energy = summary.energy, &expected = printed.energy;
        CHECK(std::abs(energy.fracture / expected.fracture - 1.0) < 1e-9);
        CHECK(std::abs(energy.kinetic / expected.kinetic - 1.0) < 1e-12);
    }
}

TEST_CASE("Determinism: the hash sees every change of the deck that moves a particle") {
    const std::string one = run_text(packing, {"time.end=0.01"}).summary.state_hash;
    CHECK(run_text(packing, {"time.end=0.01"}).summary.state_hash == one);
    CHECK(run_text(packing, {"time.end=0.01", "gravity=[0, -9.80000001]"}).summary.state_hash != one);
}

}  // namespace quern::test
