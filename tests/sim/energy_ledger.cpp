// The energy budget closes: whatever acts on a grain, what it loses is found in one of the accounts.
#include "tests/sim/decks.hpp"

namespace quern::test {

namespace {

struct Case {
    std::string name;
    const char* sections;           ///< added to plane_deck
    double bound;                   ///< of the residual, as a part of the energy that changed hands
    double EnergyBudget::*account;  ///< where something must have been booked, if any
};

const Case cases[] = {
    {"free, spinning and shaken", R"yaml(
time: {end: 0.3}
contact: {rule: none}
loads: [{region: x > 2, acceleration: ["300*(t < 0.02)", 0]}]
grains: [{shape: disk, material: rubber, position: [2, 2], velocity: [1, 0.5], spin: 3}]
)yaml",
     1e-4, &EnergyBudget::external_work},
    {"falling", R"yaml(
time: {end: 0.3}
gravity: [0, -9.8]
grains: [{shape: disk, material: rubber, position: [2, 3], spin: 1}]
)yaml",
     2e-5, &EnergyBudget::gravity},
    {"bouncing", R"yaml(
time: {end: 0.3}
gravity: [0, -9.8]
walls: [{side: y-, friction: 0.4}]
grains: [{shape: disk, material: rubber, position: [2, 0.55], velocity: [1, -2]}]
)yaml",
     4e-4, &EnergyBudget::contact_loss},
    {"sliding", R"yaml(
time: {end: 0.3}
gravity: [0, -9.8]
walls: [{side: y-, friction: 0.4}]
grains: [{shape: disk, material: rubber, position: [1, 0.5], velocity: [4, 0]}]
)yaml",
     4e-5, &EnergyBudget::friction},
    {"mass damping", R"yaml(
time: {end: 0.3}
damping: {mass: 5}
gravity: [0, -9.8]
walls: [{side: y-}]
grains: [{shape: disk, material: rubber, position: [2, 0.6], velocity: [1, -2], spin: 2}]
)yaml",
     3e-4, &EnergyBudget::damping},
    {"bond damping", R"yaml(
time: {end: 0.3}
gravity: [0, -9.8]
walls: [{side: y-}]
grains: [{shape: disk, material: rubber, position: [2, 0.6], velocity: [1, -2], spin: 2}]
)yaml",
     4e-4, &EnergyBudget::damping},
    {"loads of force density", R"yaml(
time: {end: 0.3}
walls: [{side: y-, friction: 0.2}]
loads: [{force_density: ["1000*sin(20*t)", "-2e4*y"]}]
grains: [{shape: disk, material: rubber, position: [2, 0.6]}]
)yaml",
     3e-4, &EnergyBudget::external_work},
    {"constraints", R"yaml(
time: {end: 0.3}
gravity: [0, -9.8]
walls: [{side: y-, friction: 0.2}]
constraints: [{region: y > 0.8, velocity: ["2*sin(30*t)", -0.2]}]
grains: [{shape: disk, material: rubber, position: [2, 0.6]}]
)yaml",
     2e-4, &EnergyBudget::external_work},
    {"moving wall", R"yaml(
time: {end: 0.3}
walls: [{side: y-, friction: 0.5, velocity: ["sin(10*t)", "cos(10*t)"]}]
grains: [{shape: disk, material: rubber, position: [2, 0.55], velocity: [0, -1]}]
)yaml",
     3e-4, &EnergyBudget::external_work},
    {"two disks", R"yaml(
time: {end: 0.2}
contact: {friction: 0.3}
grains:
  - {shape: disk, material: rubber, position: [1.5, 2], velocity: [2, 0]}
  - {shape: disk, material: rubber, position: [2.6, 2.3], velocity: [-2, 0], scale: 0.8}
)yaml",
     6e-4, &EnergyBudget::contact_loss},
    {"seed + impulse", R"yaml(
time: {end: 0.2}
contact: {rule: seed, friction: 0.3}
walls: [{side: y-}]
gravity: [0, -9.8]
grains:
  - {shape: disk, material: rubber, position: [1.5, 0.6], velocity: [2, 0]}
  - {shape: disk, material: rubber, position: [2.7, 0.7], velocity: [-2, 0]}
)yaml",
     3e-5, &EnergyBudget::contact_loss},
    {"pair + flip", R"yaml(
time: {end: 0.2}
contact: {rule: pair, coupling: flip, friction: 0.3}
walls: [{side: y-}]
gravity: [0, -9.8]
damping: {mass: 1}
grains:
  - {shape: disk, material: rubber, position: [1.5, 0.6], velocity: [2, 0], spin: 2}
  - {shape: disk, material: rubber, position: [2.7, 0.7], velocity: [-2, 0]}
)yaml",
     1e-4, &EnergyBudget::transfer_loss},
    {"seed + flip", R"yaml(
time: {end: 0.2}
contact: {rule: seed, coupling: flip, friction: 0.3}
walls: [{side: y-, velocity: [0, 0.5]}]
gravity: [0, -9.8]
constraints: [{grains: [1], region: y > 0.9, velocity: [free, 0]}]
grains:
  - {shape: disk, material: rubber, position: [1.5, 0.6], velocity: [2, 0], spin: 2}
  - {shape: disk, material: rubber, position: [2.7, 0.7], velocity: [-2, 0]}
)yaml",
     1e-4, &EnergyBudget::transfer_loss},
    // A spring that begins between two steps works over the whole of the step: (omega dt)^2 of a node's
    // energy.
    {"node pairs: bouncing", R"yaml(
time: {end: 0.3, safety: 0.3}
gravity: [0, -9.8]
walls: [{side: y-, friction: 0.4, velocity: ["0.2*sin(40*t)", "0.3*cos(30*t)"]}]
contact: {method: node_pair}
grains: [{shape: disk, material: rubber, position: [2, 0.55], velocity: [1, -2]}]
)yaml",
     2e-3, &EnergyBudget::friction},
    {"node pairs: dashpots", R"yaml(
time: {end: 0.2, safety: 0.3}
walls: [{side: y-, friction: 0.4}]
gravity: [0, -9.8]
contact: {method: node_pair, friction: 0.3, node_pair: {damping: nodes, tangential_damping: 0.5}}
grains:
  - {shape: disk, material: rubber, position: [1.5, 0.6], velocity: [2, 0]}
  - {shape: disk, material: rubber, position: [2.6, 0.9], velocity: [-2, 0], scale: 0.8}
)yaml",
     2e-4, &EnergyBudget::contact_loss},
    {"node pairs: slip without springs", R"yaml(
time: {end: 0.2, safety: 0.3}
contact: {method: node_pair, friction: 0.3, node_pair: {friction_law: slip}}
grains:
  - {shape: disk, material: rubber, position: [1.5, 2], velocity: [2, 0]}
  - {shape: disk, material: rubber, position: [2.6, 2.3], velocity: [-2, 0], scale: 0.8}
)yaml",
     1.2e-3, &EnergyBudget::friction},
    {"node pairs: the published friction", R"yaml(
time: {end: 0.2, safety: 0.3}
contact: {method: node_pair, friction: 0.1, node_pair: {friction_law: published, stiffness: published}}
grains:
  - {shape: disk, material: rubber, position: [1.5, 2], velocity: [2, 0]}
  - {shape: disk, material: rubber, position: [2.6, 2.3], velocity: [-2, 0], scale: 0.8}
)yaml",
     6e-4, &EnergyBudget::friction},
    {"node pairs: a grain on held ones, dashpots between centres", R"yaml(
time: {end: 0.2, safety: 0.3}
gravity: [0, -9.8]
contact: {method: node_pair, friction: 0.3, node_pair: {damping: centres, restitution: 0.9, damping_factor: 1}}
constraints: [{grains: [0], velocity: [0, "0.2*sin(60*t)"]}, {grains: [1], velocity: [0, 0]}]
grains:
  - {shape: disk, material: rubber, position: [1.45, 1]}
  - {shape: disk, material: rubber, position: [2.55, 1], wall: true}
  - {shape: disk, material: rubber, position: [2.1, 1.95], velocity: [0, -2]}
)yaml",
     5e-4, &EnergyBudget::contact_loss},
};

}  // namespace

TEST_CASE("Energy: the budget closes whatever acts") {
    for (const Case& c : cases) {
        CAPTURE(c.name);
        std::vector<std::string> overrides;
        if (c.name == "bond damping") overrides = {"materials.rubber.bond_damping=0.2 ms"};
        const RunRecord record = run_text(plane_deck + c.sections, overrides);
        const double residual = record.summary.residual_relative;
        CHECK(residual < c.bound);  // measured: a third to a half of the bound
        CHECK(std::abs(record.summary.energy.*c.account) > 1e-4 * record.summary.energy.throughput);
        CHECK(record.history.size() > 50);
    }
}

TEST_CASE("Energy: bonds of the second law, and space") {
    const std::string bounce = R"yaml(
time: {end: 0.2}
gravity: [0, -9.8]
walls: [{side: y-, friction: 0.4}]
grains: [{shape: disk, material: rubber, position: [2, 0.55], velocity: [1, -2]}]
)yaml";
    const RunRecord plane = run_text(
        replaced(plane_deck, "shear_modulus: 2.5 MPa", "shear_modulus: 6 MPa, model: bond_based") + bounce);
    CHECK(plane.summary.residual_relative < 4e-4);  // measured 1.2e-4, bound 4e-4
    const RunRecord space = run_text(space_deck + R"yaml(
time: {end: 0.2, safety: 0.3}
gravity: [0, 0, -9.8]
walls: [{side: z-, friction: 0.4}]
contact: {friction: 0.2}
grains:
  - {shape: ball, material: rubber, position: [1.5, 2, 0.6], velocity: [1, 0, -2], spin: [1, 2, 3]}
  - {shape: ball, material: rubber, position: [2.6, 2.2, 0.7], velocity: [-1, 0, -2]}
)yaml");
    CHECK(space.summary.residual_relative < 1e-3);  // measured 3.4e-4, bound 1e-3
    CHECK(space.summary.energy.contact_loss > 0.0);
}

TEST_CASE("Energy: a grain that is pulled apart pays for its cracks") {
    const RunRecord record = run_text(R"yaml(
title: test
materials:
  brittle: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa, critical_stretch: 0.05}
shapes:
  bar: {type: rectangle, size: [2, 0.5], spacing: 0.1}
grid: {origin: [0, 0], extent: [6, 2], spacing: 0.2}
time: {end: 0.2, safety: 0.3}
constraints:
  - {region: x < 2.2, velocity: ["-min(10*t, 1)", 0]}
  - {region: x > 3.8, velocity: ["min(10*t, 1)", 0]}
grains: [{shape: bar, material: brittle, position: [3, 1]}]
)yaml");
    const EnergyBudget& energy = record.summary.energy;
    CHECK(energy.fracture > 0.1 * energy.throughput);
    CHECK(energy.external_work > 0.0);
    CHECK(record.summary.residual_relative < 1e-3);  // measured 3.1e-4, bound 1e-3
    // Nothing breaks before the stretch is reached.
    CHECK(record.history[10].energy.fracture == 0.0);
    for (std::size_t i = 1; i < record.history.size(); ++i)
        CHECK(record.history[i].energy.fracture >= record.history[i - 1].energy.fracture);
}

TEST_CASE("Energy: a grain that is pressed together pays for the bonds that break in compression") {
    const std::string pressed = R"yaml(
title: test
materials:
  brittle: {model: peridem, density: 3000, bulk_modulus: 10 MPa, shear_modulus: 6 MPa, horizon: 0.3, fracture_energy: 4 kJ/m^2}
shapes:
  bar: {type: rectangle, size: [2, 0.5], spacing: 0.1}
grid: {origin: [0, 0], extent: [6, 2], spacing: 0.2}
time: {end: 0.08, safety: 0.3}
contact: {rule: none}
constraints:
  - {region: x < 2.2, velocity: ["min(10*t, 1)", 0]}
  - {region: x > 3.8, velocity: ["-min(10*t, 1)", 0]}
grains: [{shape: bar, material: brittle, position: [3, 1]}]
)yaml";
    const RunRecord both = run_text(pressed);
    CHECK(both.summary.energy.fracture > 0.1 * both.summary.energy.throughput);
    CHECK(both.summary.residual_relative < 1e-3);  // measured 1.0e-4, bound 1e-3
    CHECK(both.history[10].energy.fracture == 0.0);
    const RunRecord tension = run_text(pressed, {"materials.brittle.breaks_in=tension"});
    CHECK(tension.summary.energy.fracture == 0.0);
}

TEST_CASE("Energy: node pairs in space, and grains that break and meet again") {
    const RunRecord space = run_text(space_deck + R"yaml(
time: {end: 0.2, safety: 0.3}
gravity: [0, 0, -9.8]
walls: [{side: z-, friction: 0.4}]
contact: {method: node_pair, friction: 0.2}
grains:
  - {shape: ball, material: rubber, position: [1.5, 2, 0.6], velocity: [1, 0, -2], spin: [1, 2, 3]}
  - {shape: ball, material: rubber, position: [2.6, 2.2, 0.7], velocity: [-1, 0, -2]}
)yaml");
    CHECK(space.summary.residual_relative < 1e-3);  // measured 3.4e-4, bound 1e-3
    CHECK(space.summary.energy.friction > 0.0);
    CHECK(space.summary.momentum_error_angular < 1e-12);  // measured 1.3e-15, bound 1e-12
    const RunRecord broken =
        run_text(unequal_deck, {"contact.method=node_pair", "time.safety=0.3", "time.end=0.2"});
    CHECK(broken.summary.energy.fracture > 0.0);
    CHECK(broken.summary.residual_relative < 6e-3);  // measured 2.0e-3, bound 6e-3
}

TEST_CASE("Energy: the faces of a crack carry load again when they are pressed together") {
    const std::string bar = R"yaml(
title: test
materials:
  brittle: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa, critical_stretch: 0.05, bond_damping: 0.1 ms}
shapes:
  bar: {type: rectangle, size: [2, 0.5], spacing: 0.1}
grid: {origin: [0, 0], extent: [6, 2], spacing: 0.2}
time: {end: 0.5, safety: 0.3}
contact: {method: node_pair, node_pair: {self_contact: true}}
constraints:
  - {region: x < 2.2, velocity: ["if(t < 0.2, -1, 1)", 0]}
  - {region: x > 3.8, velocity: ["if(t < 0.2, 1, -1)", 0]}
grains: [{shape: bar, material: brittle, position: [3, 1]}]
)yaml";
    const RunRecord with = run_text(bar);
    const RunRecord without = run_text(replaced(bar, "self_contact: true", "self_contact: false"));
    CHECK(with.summary.energy.fracture > 0.0);
    CHECK(with.summary.residual_relative < 4e-3);  // measured 1.2e-3, bound 4e-3
    CHECK(with.summary.energy.contact_elastic > 0.0);
    CHECK(without.summary.energy.contact_elastic == 0.0);
    // The ends have come 0.2 m nearer to each other than they began: work that only faces in contact can
    // take.
    CHECK(with.summary.energy.elastic > 3.0 * without.summary.energy.elastic);
}

}  // namespace quern::test
