// Walls that press as hard as asked.
#include "src/sim/servo.hpp"

#include <fmt/format.h>

#include "grid/error.hpp"
#include "src/sim/scene.hpp"
#include "tests/sim/decks.hpp"

namespace quern::test {

namespace {

/// Twelve disks in a box of 3 m, under a lid that presses; `turned`: by a right angle.
std::string packing(const std::string& method, const std::string& servo, bool turned = false) {
    const auto pair = [](double x, double y) { return fmt::format("[{}, {}]", x, y); };
    const auto place = [&](double x, double y) { return turned ? pair(5.0 - y, x) : pair(x, y); };
    const auto direction = [&](double x, double y) { return turned ? pair(-y, x) : pair(x, y); };
    std::string text = replaced(plane_deck, "extent: [6, 4]", "extent: [6, 6]") +
                       "time: {end: 0.6, safety: 0.5}\ndamping: {mass: 20}\ncontact: {method: " + method +
                       ", friction: 0.3, node_pair: {damping: nodes, restitution: 0.5}}\nwalls:\n";
    const auto wall = [&](const char* name, double x, double y, double nx, double ny,
                          const std::string& more) {
        text += fmt::format("  - {{name: {}, point: {}, normal: {}{}}}\n", name, place(x, y),
                            direction(nx, ny), more);
    };
    wall("left", 0.0, 0.0, 1.0, 0.0, "");
    wall("right", 3.0, 0.0, -1.0, 0.0, "");
    wall("floor", 0.0, 0.0, 0.0, 1.0, "");
    wall("lid", 0.0, 4.005, 0.0, -1.0, ", servo: " + servo);
    text += "grains:\n";
    for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 3; ++i)
            text += fmt::format("  - {{shape: disk, material: rubber, position: {}, angle: {} deg}}\n",
                                place(0.5 + i, 0.5 + j), turned ? 90 : 0);
    return text;
}

std::vector<ReactionRow> lid_rows(const RunRecord& record) {
    std::vector<ReactionRow> rows;
    for (const ReactionRow& row : record.reactions)
        if (row.name == "lid") rows.push_back(row);
    return rows;
}

}  // namespace

TEST_CASE("Servo: a plate against a spring goes to rest where the spring holds the force") {
    Servo servo{Expression("2e4*min(t/0.1, 1)", "test"), 2.0, 50.0, 60.0, 1e9};
    const double k = 1e6, dt = 1e-4;
    double x = 0.0, lag = 0.0;
    for (int n = 0; n < 20000; ++n) {
        servo.pressed = lag;
        servo.steer(n * dt, n == 0 ? 0.5 * dt : dt);
        lag = k * x;
        x += dt * servo.speed;
        if (n == 500) CHECK(k * x > 0.4 * 4e4 * 0.5);
    }
    CHECK(k * x == doctest::Approx(4e4).epsilon(1e-9));  // measured 2e-13, bound 1e-9
    servo.max_speed = 1e-3;
    servo.pressed = 0.0;
    for (int n = 0; n < 100; ++n) servo.steer(1.0, dt);
    CHECK(servo.speed == 1e-3);
}

TEST_CASE("Servo: a packing comes under the force asked for, and the budget closes") {
    for (const char* method : {"grid", "node_pair"}) {
        CAPTURE(method);
        // Between nodes the disks stand less well on each other: the packing gives way before it holds.
        const std::string end = method == std::string("grid") ? "time.end=1" : "time.end=1.5";
        const RunRecord record =
            run_text(packing(method, "{force: \"3e4*min(t/0.05, 1)\", mass: 2000, damping: 20}"), {end});
        const std::vector<ReactionRow> rows = lid_rows(record);
        double sum = 0.0, largest = 0.0, n = 0.0;
        for (const ReactionRow& row : rows) {
            if (row.time < 0.8 * rows.back().time) continue;
            sum += row.force[1];
            largest = std::max(largest, row.force[1]);
            n += 1.0;
        }
        CHECK(sum / n == doctest::Approx(3e4).epsilon(2e-4));  // measured 4e-5, bound 2e-4
        CHECK(largest < 1.05 * 3e4);                           // measured 1.014, bound 1.05
        CHECK(record.summary.residual_relative < 3e-4);        // measured 7e-5, bound 3e-4
        CHECK(record.summary.momentum_error_linear < 1e-12);   // measured 3e-15, bound 1e-12
        CHECK(rows.back().work > 0.0);
        // The lid creeps no more: it holds.
        CHECK(rows.back().displacement[1] < -0.01);
        const ReactionRow& before = rows[rows.size() - rows.size() / 10];
        CHECK(std::abs(rows.back().displacement[1] - before.displacement[1]) < 5e-5);  // measured 6e-6 [m]
    }
}

TEST_CASE("Servo: turned scenes, stress over an area, and threads") {
    const std::string servo = "{stress: 20 kPa, area: 3, mass: 2000, damping: 20, max_speed: 5}";
    for (const char* method : {"grid", "node_pair"}) {
        CAPTURE(method);
        const RunRecord up = run_text(packing(method, servo), {"time.end=0.15"});
        const RunRecord aside = run_text(packing(method, servo, true), {"time.end=0.15"}, 2);
        const std::vector<ReactionRow> a = lid_rows(up), b = lid_rows(aside);
        REQUIRE(a.size() == b.size());
        double worst = 0.0;
        for (std::size_t i = 0; i < a.size(); ++i)
            worst = std::max(worst, std::abs(a[i].displacement[1] + b[i].displacement[0]));
        CHECK(worst < 1e-6);
        CHECK(a.back().displacement[1] < -0.01);
        CHECK(run_text(packing(method, servo), {"time.end=0.15"}, 2).summary.state_hash ==
              up.summary.state_hash);
    }
}

TEST_CASE("Servo: by default the plate is as heavy as the grains") {
    const std::unique_ptr<Scene<2>> scene = make_scene<2>(read_text(packing("grid", "{force: 1}")));
    REQUIRE(scene->servos.size() == 4);
    REQUIRE(scene->servos[3].has_value());
    CHECK_FALSE(scene->servos[0].has_value());
    double mass = 0.0;
    for (const Grain<2>& grain : scene->grains) mass += grain.mass;
    CHECK(scene->servos[3]->mass == mass);
    const double sound = std::sqrt((10e6 + 2.5e6 / 3.0 + 2.5e6) / 3000.0);
    CHECK(scene->servos[3]->damping == doctest::Approx(2.0 * sound / 4.0).epsilon(0.05));
}

TEST_CASE("Servo: what cannot be meant is refused") {
    const auto error = [](const std::string& servo) {
        return message_of<InputError>(packing("grid", servo));
    };
    CHECK(contains(error("{}"), "walls.3.servo: got neither force nor stress, expected one of them"));
    CHECK(contains(error("{force: 1, stress: 1, area: 1}"), "got force and stress, expected one of them"));
    CHECK(contains(error("{stress: 1}"), "got stress without area, expected stress with area, or force"));
    CHECK(contains(error("{force: 1, area: 2}"), "got area without stress"));
    CHECK(contains(error("{forces: 1}"), "did you mean force"));
    CHECK(contains(error("{force: 1 N}"), "walls.3.servo.force"));
    CHECK(contains(error("{force: 1 kN/m, mass: -1}"), "walls.3.servo.mass"));
    CHECK(contains(error("{force: x}"), "expected a formula of t"));
    CHECK(contains(message_of<InputError>(packing("grid", "{force: 1}"), {"contact.rule=none"}),
                   "a servo without contact"));
}

}  // namespace quern::test
