// Motions known in closed form, prescribed ones, and the prepare phase.
#include "src/sim/step.hpp"

#include <cmath>

#include "src/results/json.hpp"
#include "tests/sim/decks.hpp"

namespace quern::test {

TEST_CASE("Motion: free flight is exact and spin does not drift") {
    for (const char* rule : {"none", "pair"}) {
        CAPTURE(rule);
        const RunRecord record = run_text(plane_deck + R"yaml(
time: {end: 1}
output: {track: all}
contact: {rule: pair}
grains: [{shape: disk, material: rubber, position: [1, 1.5], velocity: [3, 1], spin: 2}]
)yaml",
                                          {std::string("contact.rule=") + rule});
        REQUIRE(record.grains.size() > 100);
        double worst = 0.0, spin = 0.0;
        for (const GrainRow& row : record.grains) {
            worst = std::max(
                worst, std::hypot(row.position[0] - 1.0 - 3.0 * row.time, row.position[1] - 1.5 - row.time));
            spin = std::max(spin, std::abs(row.omega - 2.0));
        }
        CHECK(worst < 1e-13);  // measured 6.7e-15, bound 1e-13 [m]
        CHECK(spin < 1e-3);    // measured 3.2e-4 (it widens as it spins), bound 1e-3 [rad/s]
        CHECK(record.grains.back().angle == doctest::Approx(2.0).epsilon(1e-3));
        CHECK(record.summary.momentum_error_linear < 1e-13);   // measured 1.2e-15, bound 1e-13
        CHECK(record.summary.momentum_error_angular < 1e-13);  // measured 4.7e-16, bound 1e-13
    }
}

TEST_CASE("Motion: free fall is exact") {
    const RunRecord record = run_text(plane_deck + R"yaml(
time: {end: 0.5}
gravity: [1, -9.8]
output: {track: [0]}
grains: [{shape: disk, material: rubber, position: [1, 3], velocity: [0.5, 1]}]
)yaml");
    double position = 0.0, velocity = 0.0;
    for (const GrainRow& row : record.grains) {
        const double t = row.time;
        position = std::max(position, std::hypot(row.position[0] - 1.0 - 0.5 * t - 0.5 * t * t,
                                                 row.position[1] - 3.0 - t + 4.9 * t * t));
        velocity = std::max(velocity, std::hypot(row.velocity[0] - 0.5 - t, row.velocity[1] - 1.0 + 9.8 * t));
    }
    CHECK(position < 1e-13);  // measured 4.9e-15, bound 1e-13 [m]
    CHECK(velocity < 1e-13);  // measured 5.3e-15, bound 1e-13 [m/s]
    CHECK(record.grains.back().time == 0.5);
}

TEST_CASE("Motion: a ball spins about its axis and keeps its angular momentum") {
    const RunRecord record = run_text(space_deck + R"yaml(
time: {end: 0.5}
output: {track: all}
grains: [{shape: ball, material: rubber, position: [2, 2, 2], velocity: [1, -0.5, 0.2], spin: [0, 0, 4]}]
)yaml");
    CHECK(record.grains.back().angle == doctest::Approx(2.0).epsilon(5e-3));
    CHECK(record.summary.momentum_error_linear < 1e-13);   // measured 1.2e-15, bound 1e-13
    CHECK(record.summary.momentum_error_angular < 1e-13);  // measured 4.7e-16, bound 1e-13
    CHECK(record.grains.back().position[2] == doctest::Approx(2.1).epsilon(1e-12));
}

TEST_CASE("Motion: prescribed velocities hold on their axes and only there") {
    const Deck deck = read_text(plane_deck + R"yaml(
time: {end: 0.1}
gravity: [0, -9.8]
constraints: [{region: x > 2, velocity: ["0.3 + t", free]}]
grains: [{shape: disk, material: rubber, position: [2, 2]}]
)yaml");
    const std::unique_ptr<Scene<2>> scene = make_scene<2>(deck);
    set_initial_velocities(deck, *scene);
    StepContext<2> now = make_context(*scene, 0.5 * scene->stable_step());
    const std::vector<Vec<2>> start = scene->particles.x;
    for (int i = 0; i < 20; ++i) {
        kick(*scene, now);
        int held = 0, others = 0;
        double mean = 0.0;
        for (int p = 0; p < scene->particles.size(); ++p) {
            const bool inside = start[p][0] > 2.0;
            const double prescribed = 0.3 + (now.time + 0.5 * now.dt);
            if (inside) CHECK(scene->particles.v[p][0] == prescribed);
            held += inside;
            others += !inside && scene->particles.v[p][0] != prescribed;
            mean += scene->particles.mass[p] * scene->particles.v[p][1] / scene->grains[0].mass;
        }
        CHECK(held == static_cast<int>(scene->constraints[0].particles.size()));
        CHECK(others > 40);
        // The free axis falls; v is half a step behind x at the first kick.
        CHECK(mean == doctest::Approx(-9.8 * (now.time + 0.5 * now.dt)).epsilon(1e-12));
        drift(*scene, now);
    }
    CHECK(now.step == 20);
}

TEST_CASE("Motion: prepare gives gravity, friction, damping and walls back") {
    const std::string run = plane_deck + R"yaml(
time: {end: 0.2}
gravity: [1, -9.8]
damping: {mass: 0.5}
contact: {friction: 0.3}
walls: [{side: y-, friction: 0.4, velocity: [0, "0.3*t"]}]
output: {track: all}
grains:
  - {shape: disk, material: rubber, position: [1, 0.51], velocity: [2, 0]}
  - {shape: disk, material: rubber, position: [2.02, 0.51], velocity: [0.5, 0]}
)yaml";
    const RunRecord plain = run_text(run);
    // Nothing acts while it is prepared, so that nothing but a forgotten setting can make a difference.
    const RunRecord prepared =
        run_text(run + "prepare: {duration: 0.05, gravity: [0, 0], mass_damping: 7, friction: 0.9}\n");
    REQUIRE(plain.grains.size() == prepared.grains.size());
    double worst = 0.0;
    for (std::size_t i = 0; i < plain.grains.size(); ++i)
        for (int a = 0; a < 2; ++a)
            worst = std::max(worst, std::abs(plain.grains[i].position[a] - prepared.grains[i].position[a]));
    CHECK(worst < 1e-12);  // measured 1.8e-15, bound 1e-12 [m]
    CHECK(plain.summary.steps == prepared.summary.steps);
    // And it does act: a grain that settles under gravity lies deeper than one that was just put there.
    const RunRecord settled = run_text(run + "prepare: {duration: 0.5, mass_damping: 50}\n");
    CHECK(settled.grains[0].position[1] < plain.grains[0].position[1] - 1e-3);
}

TEST_CASE("Motion: a collision across a periodic seam is that in the middle") {
    const std::string run = plane_deck + R"yaml(
time: {end: 0.1}
contact: {friction: 0.2}
output: {track: all}
params: {n: 6, x_0: 2.4, x_1: 3.5}
grains:
  - {shape: disk, material: rubber, position: ["${x_0}", 2], velocity: [2, 0]}
  - {shape: disk, material: rubber, position: ["${x_1}", 2.2], velocity: [-2, 0]}
)yaml";
    const std::string deck =
        replaced(replaced(run, "params: {n: 6}\n", ""), "extent: [6, 4], spacing: \"${1/n}\"",
                 "extent: [6, 4], spacing: \"${1/n}\", periodic: [x]");
    const RunRecord middle = run_text(deck), seam = run_text(deck, {"params.x_0=5.4", "params.x_1=0.5"});
    CHECK(middle.summary.energy.contact_loss > 0.0);
    double worst = 0.0;
    for (std::size_t i = 0; i < middle.grains.size(); ++i) {
        const double shift = middle.grains[i].grain == 0 ? -3.0 : 3.0;
        worst = std::max(worst, std::abs(middle.grains[i].position[0] - seam.grains[i].position[0] - shift));
        worst = std::max(worst, std::abs(middle.grains[i].position[1] - seam.grains[i].position[1]));
    }
    CHECK(worst < 1e-12);                               // measured 6.7e-15, bound 1e-12 [m]
    CHECK(seam.summary.momentum_error_linear < 1e-12);  // measured 4.9e-16, bound 1e-12
    CHECK(std::isnan(seam.summary.momentum_error_angular));
    CHECK(contains(make_summary_json(seam.summary), "\"angular\": null"));
}

TEST_CASE("Motion: corners that meet in single particles keep the angular momentum") {
    const std::string deck = R"yaml(title: corners
params: {offset: 0}
materials:
  rubber: {density: 3000, bulk_modulus: 10 MPa, shear_modulus: 2.5 MPa}
shapes:
  wedge: {type: polygon, vertices: [[0, 0], [0.5, -0.25], [0.5, 0.25]], spacing: 0.05}
grid: {origin: [0, 0], extent: [6, 4], spacing: 0.05}
contact: {friction: 0.5}
time: {end: 0.1}
grains:
  - {shape: wedge, material: rubber, position: [2.4, "${2 + offset}"], angle: "${pi}", velocity: [2, 0.3]}
  - {shape: wedge, material: rubber, position: [3.3, 2], velocity: [-2, 0]}
)yaml";
    for (const std::string offset : {"0", "0.01"}) {
        CAPTURE(offset);
        const RunRecord run = run_text(deck, {"params.offset=" + offset});
        CHECK(run.summary.energy.contact_loss > 1.0);
        // measured 3.5e-16 (with friction, or along the normal of the surfaces: 7e-5), bound 1e-13
        CHECK(run.summary.momentum_error_angular < 1e-13);
    }
}

}  // namespace quern::test
