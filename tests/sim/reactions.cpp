// What walls and held bodies bear and do: weight, work, momentum, and where they go.
#include <numbers>

#include "tests/sim/decks.hpp"

namespace quern::test {

namespace {

constexpr double weight = 9.8 * 3000.0 * std::numbers::pi * 0.25;  // of the disk of plane_deck [N/m]

std::vector<ReactionRow> rows_named(const RunRecord& record, const std::string& name) {
    std::vector<ReactionRow> rows;
    for (const ReactionRow& row : record.reactions)
        if (row.name == name) rows.push_back(row);
    REQUIRE(rows.size() > 10);
    return rows;
}

/// Mean over all rows but the first, which has no time before it.
template <class Value>
double mean(const std::vector<ReactionRow>& rows, Value value) {
    double sum = 0.0;
    for (std::size_t i = 1; i < rows.size(); ++i) sum += value(rows[i]);
    return sum / static_cast<double>(rows.size() - 1);
}

const char* const resting = R"yaml(
time: {end: 0.3}
gravity: [0, -9.8]
damping: {mass: 20}
walls: [{side: y-}]
constraints: [{grains: [0], velocity: [0, 0]}]
prepare: {duration: 1, mass_damping: 60}
output: {history_interval: 0.01, track: all}
grains:
  - {shape: disk, material: rubber, position: [2, 2], wall: true}
  - {shape: disk, material: rubber, position: [2, 3]}
  - {shape: disk, material: rubber, position: [4, 0.5]}
)yaml";

}  // namespace

TEST_CASE("Reactions: a grain at rest weighs on a wall and on a held grain, which weighs itself") {
    for (const char* method : {"grid", "node_pair"}) {
        CAPTURE(method);
        const RunRecord record = run_text(plane_deck + resting, {std::string("contact.method=") + method});
        const auto fy = [](const ReactionRow& row) { return row.force[1]; };
        const auto mz = [](const ReactionRow& row) { return row.moment[2]; };
        const double floor = mean(rows_named(record, "y-"), fy) / weight;
        CHECK(floor == doctest::Approx(-1.0).epsilon(1e-3));  // measured 3.7e-4, bound 1e-3
        // Under the centres; between nodes they still rock: measured 2.0e-3 (grid 1.6e-4), bound 5e-3.
        const auto place = [&](std::size_t grain) { return record.grains[record.grains.size() - 3 + grain]; };
        const double turn = mean(rows_named(record, "y-"), mz);
        CHECK(turn == doctest::Approx(-place(2).position[0] * weight).epsilon(5e-3));
        const double held = mean(rows_named(record, "constraints[0]"), fy) / weight;
        CHECK(held == doctest::Approx(-2.0).epsilon(1e-3));  // measured 9e-6, bound 1e-3
        const double turn_held = mean(rows_named(record, "constraints[0]"), mz);
        CHECK(turn_held ==
              doctest::Approx(-(place(0).position[0] + place(1).position[0]) * weight).epsilon(5e-3));
        CHECK(mean(rows_named(record, "grains[0]"), fy) == held * weight);
        CHECK(record.summary.reactions.size() == 3);
        CHECK(std::abs(record.summary.reactions[1].work) < 1e-6 * weight);
    }
}

TEST_CASE("Reactions: works of all holders sum to the external work, forces to the change of momentum") {
    for (const char* contact :
         {"{rule: pair}", "{rule: pair, coupling: flip}", "{rule: surface}", "{method: node_pair}"}) {
        CAPTURE(contact);
        const RunRecord record = run_text(plane_deck + R"yaml(
time: {end: 0.3, safety: 0.3}
gravity: [0, -9.8]
walls:
  - {side: y-, friction: 0.4, velocity: ["0.2*sin(40*t)", 0]}
  - {name: "lid, flat", point: [0, 1.1], normal: [0, -1], velocity: [0, "-0.5*sin(30*t)"]}
constraints: [{grains: [1], region: x > 4, velocity: ["sin(20*t)", free]}]
grains:
  - {shape: disk, material: rubber, position: [2, 0.5]}
  - {shape: disk, material: rubber, position: [4, 0.5], velocity: [0.3, 0]}
)yaml" + "contact: " + contact);
        REQUIRE(record.reactions.size() == 3 * record.history.size());
        double worst_work = 0.0, impulse[2] = {0.0, 0.0}, turn = 0.0;
        for (std::size_t i = 0; i < record.history.size(); ++i) {
            double work = 0.0;
            const double elapsed = i > 0 ? record.history[i].time - record.history[i - 1].time : 0.0;
            for (std::size_t w = 3 * i; w < 3 * i + 3; ++w) {
                work += record.reactions[w].work;
                for (int a = 0; a < 2; ++a) impulse[a] -= elapsed * record.reactions[w].force[a];
                turn -= elapsed * record.reactions[w].moment[2];
            }
            worst_work = std::max(worst_work, std::abs(work - record.history[i].energy.external_work));
        }
        const HistoryRow &first = record.history.front(), &last = record.history.back();
        CHECK(worst_work < 1e-11 * last.energy.throughput);  // measured 2e-15, bound 1e-11
        CHECK(last.energy.external_work > 0.1 * last.energy.throughput);
        // Momenta of a row are those after its kick; the reactions of the first are of half a kick.
        const double momentum = last.momentum[0] - first.momentum[0];
        CHECK(impulse[0] == doctest::Approx(momentum).epsilon(1e-10));  // measured 3e-14, bound 1e-10
        const double weights = -2.0 * weight * last.time;
        CHECK(impulse[1] + weights ==
              doctest::Approx(last.momentum[1] - first.momentum[1]).epsilon(1e-10).scale(weight));
        CHECK(std::abs(turn) > weight * last.time);
    }
}

TEST_CASE("Reactions: what is prescribed moves as its formula says, on planes and on held bodies") {
    const RunRecord record = run_text(plane_deck + R"yaml(
time: {end: 0.3}
prepare: {duration: 0.05}
walls: [{name: plate, point: [0, 0.2], normal: [0, 1], velocity: ["0.4 + t", "3*cos(20*t)"]}]
constraints:
  - {grains: [0], velocity: ["0.4 + t", "3*cos(20*t)"]}
  - {grains: [1], velocity: ["-5*(y - 3)", "5*(x - 4.6)"]}
grains:
  - {shape: disk, material: rubber, position: [2, 2]}
  - {shape: disk, material: rubber, position: [4.6, 3]}
)yaml");
    double linear = 0.0, wave = 0.0;
    for (const char* name : {"plate", "constraints[0]"})
        for (const ReactionRow& row : rows_named(record, name)) {
            const double t = row.time;
            linear = std::max(linear, std::abs(row.displacement[0] - 0.4 * t - 0.5 * t * t));
            wave = std::max(wave, std::abs(row.displacement[1] - 0.15 * std::sin(20.0 * t)));
        }
    CHECK(linear < 1e-13);  // measured 1.2e-15, bound 1e-13 [m]
    const double dt = record.summary.time_step;
    CHECK(wave < 60.0 * dt * dt / 12.0);  // measured: half of it, dt^2 (a(t) - a(0))/24 [m]
    CHECK(wave > 1e-3 * dt * dt);
    const std::vector<ReactionRow> plate = rows_named(record, "plate");
    CHECK(plate.back().position[1] == doctest::Approx(0.2 + plate.back().displacement[1]).epsilon(1e-15));
}

}  // namespace quern::test
