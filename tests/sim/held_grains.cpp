// What is held does not give way: grains that meet a constrained grain bounce as from a body of infinite
// mass.
#include <cmath>

#include "tests/sim/decks.hpp"

namespace quern::test {

namespace {

const std::string on_held = plane_deck + R"yaml(
time: {end: 0.14, safety: 0.3}
output: {track: all}
contact: {friction: 0.2}
constraints: [{grains: [0], velocity: ["${along}", "${up}"]}]
grains:
  - {shape: disk, material: rubber, position: [3, 1], velocity: ["${along}", "${up}"]}
  - {shape: disk, material: rubber, position: [3.03, 2.04], velocity: ["${along}", "${up - 2}"]}
)yaml";

struct Method {
    std::string name;
    std::vector<std::string> settings;
    double least;    ///< of the speed up after the bounce over the speed down before
    double moved;    ///< largest change in a moving frame: the grid lies elsewhere [m/s, rad/s]
    double angular;  ///< bound of the error of momentum
    double residual;
};

const Method methods[] = {
    {"pair", {}, 0.9, 0.1, 1e-12, 2e-4},                                // measured 0.933, 0.062, 1e-15, 7e-5
    {"surface", {"contact.rule=surface"}, 0.94, 1e-9, 1e-12, 2e-4},     // measured 0.955, 7e-12, 1e-15, 6e-5
    {"pair + flip", {"contact.coupling=flip"}, 0.78, 0.1, 1e-2, 6e-5},  // measured 0.831, 0.046, 3e-3, 2e-5
    {"seed + flip", {"contact.rule=seed", "contact.coupling=flip"}, 0.83, 0.1, 0.2, 6e-5},  // 0.883, 0.050,
                                                                                            // 0.08
    {"node pairs", {"contact.method=node_pair"}, 0.8, 1e-9, 1e-12, 6e-4},  // measured 0.862, 4e-12, 3e-15,
                                                                           // 2e-4
};

RunRecord bounce(const Method& method, const char* frame) {
    return run_text(replaced(on_held, "params: {n: 6}", frame), method.settings);
}

}  // namespace

TEST_CASE("Held grains: what falls on them bounces, in any frame") {
    for (const Method& method : methods) {
        CAPTURE(method.name);
        const RunRecord rest = bounce(method, "params: {n: 6, along: 0, up: 0}");
        const GrainRow& last = rest.grains.back();
        CHECK(last.velocity[1] > 2.0 * method.least);
        CHECK(rest.summary.residual_relative < method.residual);
        CHECK(rest.summary.momentum_error_angular < method.angular);
        const RunRecord moved = bounce(method, "params: {n: 6, along: 0.7, up: 0.4}");
        const GrainRow& there = moved.grains.back();
        CHECK(std::abs(there.velocity[0] - 0.7 - last.velocity[0]) < method.moved);
        CHECK(std::abs(there.velocity[1] - 0.4 - last.velocity[1]) < method.moved);
        CHECK(std::abs(there.omega - last.omega) < method.moved);
        // The held disk is where it was led to.
        const GrainRow& held = moved.grains[moved.grains.size() - 2];
        CHECK(held.position[0] == doctest::Approx(3.0 + 0.7 * held.time).epsilon(1e-12));
        CHECK(held.position[1] == doctest::Approx(1.0 + 0.4 * held.time).epsilon(1e-12));
    }
}

TEST_CASE("Held grains: one that is held along one axis slides along the other") {
    const std::string pushed = replaced(on_held, R"(["${along}", "${up}"]}])", R"([free, 0]}])");
    const RunRecord record = run_text(replaced(pushed, "params: {n: 6}", "params: {n: 6, along: 0, up: 0}"));
    const GrainRow& held = record.grains[record.grains.size() - 2];
    REQUIRE(record.summary.warnings.size() == 1);
    CHECK(contains(record.summary.warnings[0].first, "particles are held along some axes only"));
    CHECK(held.velocity[0] < -0.05);
    CHECK(held.position[1] == doctest::Approx(1.0).epsilon(1e-13));
    CHECK(record.summary.momentum_error_linear < 1e-12);  // measured 1.3e-15, bound 1e-12
    CHECK(record.summary.residual_relative < 3e-4);       // measured 1e-4, bound 3e-4
}

}  // namespace quern::test
