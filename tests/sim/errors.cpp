// Scenes that cannot be run, and runs that go wrong: one message that names the place.
#include "grid/error.hpp"
#include "tests/sim/decks.hpp"

namespace quern::test {

namespace {

const std::string two_disks = plane_deck + R"yaml(time: {end: 0.05}
walls: [{side: y-}, {name: slope, point: [0, 3], normal: [1, -4]}]
constraints: [{grains: [0], region: x < 9, velocity: [0, free]}]
grains:
  - {shape: disk, material: rubber, position: [1, 1]}
  - {shape: disk, material: rubber, position: [3, 1]}
)yaml";

std::string input_error(const std::string& from, const std::string& to) {
    return message_of<InputError>(replaced(two_disks, from, to));
}

}  // namespace

TEST_CASE("Errors: grains that overlap") {
    const std::string message = input_error("position: [3, 1]", "position: [1.9, 1]");
    CHECK(contains(message, "deck.yaml:14: grains.1"));
    CHECK(contains(message, "grain 1 overlapping grain 0"));
    // Just touching is no overlap.
    CHECK_NOTHROW(run_text(replaced(two_disks, "position: [3, 1]", "position: [2.0, 1]")));
}

TEST_CASE("Errors: grains with particles on their surface may touch, not overlap") {
    const std::string deck = replaced(
        replaced(two_disks, "time: {end: 0.05}", "time: {end: 1e-4}\ncontact: {rule: none}"), "shapes:",
        "shapes:\n  hexagon: {type: regular_polygon, filling: mesh, sides: 6, radius: 0.5, spacing: 0.08}");
    const auto set = [&](const char* shape, double x, double angle) {
        const std::string first = "grains.0.shape=hexagon", second = std::string("grains.1.shape=") + shape;
        return std::vector<std::string>{first,
                                        second,
                                        "shapes.disk.filling=mesh",
                                        "constraints.0.velocity=[0, 0]",
                                        "grains.1.position=[" + std::to_string(x) + ", 1]",
                                        "grains.1.angle=" + std::to_string(angle)};
    };
    for (int k = 0; k < 8; ++k) {
        const double angle = 0.3 + 0.13 * k;
        CAPTURE(angle);
        CHECK_NOTHROW(run_text(deck, set("disk", 2.0, angle)));  // at a corner of the hexagon
        for (const double x : {1.0, 1.02, 1.2, 1.5, 1.9})
            CHECK(
                contains(message_of<InputError>(deck, set("disk", x, angle)), "grain 1 overlapping grain 0"));
    }
    const double pi = 3.14159265;
    CHECK_NOTHROW(run_text(deck, set("hexagon", 2.0, 0.0)));                               // corner on corner
    CHECK_NOTHROW(run_text(deck, set("hexagon", 1.5 + 0.5 * std::sqrt(0.75), pi / 6.0)));  // corner on face
    CHECK(contains(message_of<InputError>(deck, set("hexagon", 1.0, 0.0)), "overlapping"));
    CHECK(contains(message_of<InputError>(deck, set("hexagon", 1.75, pi / 6.0)), "overlapping"));
}

TEST_CASE("Errors: grains that stand for walls may overlap each other, not other grains") {
    const std::string walls =
        replaced(replaced(two_disks, "position: [1, 1]", "position: [1, 1], wall: true"), "position: [3, 1]",
                 "position: [1.9, 1], wall: true");
    CHECK_NOTHROW(
        run_text(replaced(walls, "time: {end: 0.05}", "time: {end: 0.001}\ncontact: {rule: none}")));
    CHECK(contains(message_of<InputError>(replaced(walls, "[1.9, 1], wall: true", "[1.9, 1]")),
                   "grain 1 overlapping grain 0"));
}

TEST_CASE("Errors: a grain behind a wall") {
    const std::string message = input_error("position: [3, 1]", "position: [3, 0.3]");
    CHECK(contains(message, "deck.yaml:14: grains.1"));
    CHECK(contains(message, "wall 'y-'"));
    CHECK(contains(input_error("position: [3, 1]", "position: [3, 3.4]"), "wall 'slope'"));
}

TEST_CASE("Errors: a grain outside the grid") {
    const std::string message = input_error("position: [3, 1]", "position: [5.99, 1]");
    CHECK(contains(message, "deck.yaml:14: grains.1"));
    CHECK(contains(message, "outside the grid"));
}

TEST_CASE("Errors: a region without particles") {
    const std::string message = input_error("x < 9", "x > 9");
    CHECK(contains(message, "deck.yaml:11: constraints.0"));
    CHECK(contains(message, "region without particles"));
}

TEST_CASE("Errors: too few cells on a periodic axis") {
    const std::string message = message_of<InputError>(
        replaced(plane_deck, "spacing: \"${1/n}\"", "spacing: 2, periodic: [x]") +
        "time: {end: 0.05}\ngrains: [{shape: disk, material: rubber, position: [1, 1]}]\n");
    CHECK(contains(message, "3 cells on a periodic axis"));
}

TEST_CASE("Errors: an unstable step ends the run and names who blew up") {
    const RunRecord stable = run_text(two_disks);
    const std::string shaken = replaced(two_disks, "time: {end: 0.05}", "time: {end: 2}");
    const std::string step = fmt::format("{}", 3.0 * stable.summary.stable_step);
    const std::string message = message_of<SimulationError>(
        replaced(shaken, "position: [3, 1]", "position: [3, 1], velocity: [0, -2], spin: 3"),
        {"time.step=" + step});
    CHECK(contains(message, "grain "));
    CHECK(contains(message, "particle "));
    CHECK(contains(message, "step "));
}

TEST_CASE("Errors: a particle that leaves the grid") {
    const std::string message = message_of<SimulationError>(
        replaced(two_disks, "position: [3, 1]", "position: [3, 1], velocity: [100, 0]"));
    CHECK(contains(message, "grain 1, particle "));
    CHECK(contains(message, "has left the grid"));
}

TEST_CASE("Errors: a failed run leaves its results") {
    const TempFolder folder;
    const std::string file = folder.write(
        "deck.yaml", replaced(two_disks, "position: [3, 1]", "position: [3, 1], velocity: [100, 0]"));
    RunOptions options;
    options.directory = file + ".out";
    options.threads = 1;
    RunRecord record;
    CHECK_THROWS_AS(run_deck(read_deck(file), options, &record), SimulationError);
    CHECK(contains(record.summary.outcome, "failed: grain 1"));
    for (const char* name : {"summary.json", "history.csv", "results.h5", "run.log"})
        CHECK(std::filesystem::file_size(options.directory + "/" + name) > 0);
}

}  // namespace quern::test
