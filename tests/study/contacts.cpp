// Contacts from forces, restitution from motion: histories whose numbers are known.
#include "src/study/contacts.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "src/study/encounter.hpp"
#include "src/study/measure.hpp"
#include "tests/deck/deck_files.hpp"

using namespace quern;
using doctest::Approx;

namespace {

constexpr int n_rows = 1001;

/// Times from 0 to 1 s, and the mean of a force since the row before.
struct History {
    std::vector<double> time, force;
    explicit History(const std::function<double(double)>& force_at) {
        for (int i = 0; i < n_rows; ++i) {
            time.push_back(1e-3 * i);
            double sum = 0.0;
            for (int k = 0; i > 0 && k < 20; ++k) sum += force_at(1e-3 * (i - (k + 0.5) / 20));
            force.push_back(sum / 20);
        }
    }
};

/// A push of one half period of a sine.
double push(double t, double start, double duration) {
    return t > start && t < start + duration ? std::sin(std::numbers::pi * (t - start) / duration) : 0.0;
}

}  // namespace

TEST_CASE("Contacts: one smooth push has its duration, its peak, its mean and no chatter") {
    for (const double start : {0.2, 0.2003, 0.2007}) {
        const History history([&](double t) { return 5.0 * push(t, start, 0.3); });
        const ForceMeasures force = measure_force(history.time, history.force);
        REQUIRE(force.contacts.size() == 1);
        CHECK(force.peak == Approx(5.0).epsilon(1e-4));    // measured 2e-5, bound 1e-4
        CHECK(std::abs(force.in_contact - 0.3) < 1.1e-3);  // measured 1e-3, bound 1.1e-3
        CHECK(force.contacts[0].duration == force.in_contact);
        CHECK(force.mean == Approx(10.0 / std::numbers::pi).epsilon(1e-5));  // measured 2.5e-6, bound 1e-5
        CHECK(force.chatter == Approx(1.0).epsilon(1e-12));                  // measured 3e-16, bound 1e-12
        CHECK(force.contacts[0].starts_inside);
        CHECK(force.contacts[0].ends_inside);
    }
}

TEST_CASE("Contacts: a force that chatters is one contact, bounces are several") {
    // Ten pushes of 20 ms with 5 ms between them.
    const History comb([](double t) {
        double sum = 0.0;
        for (int i = 0; i < 10; ++i) sum += push(t, 0.1 + 0.025 * i, 0.02);
        return sum;
    });
    const ForceMeasures chattering = measure_force(comb.time, comb.force);
    REQUIRE(chattering.contacts.size() == 1);
    CHECK(std::abs(chattering.in_contact - 0.245) < 1.1e-3);   // measured 1e-3, bound 1.1e-3
    CHECK(chattering.chatter == Approx(10.0).epsilon(1e-12));  // measured 4e-16, bound 1e-12

    const History bounces(
        [](double t) { return push(t, 0.1, 0.05) + 0.5 * push(t, 0.4, 0.04) + push(t, 0.9, 0.2); });
    const ForceMeasures bouncing = measure_force(bounces.time, bounces.force);
    REQUIRE(bouncing.contacts.size() == 3);
    CHECK(std::abs(bouncing.contacts[0].duration - 0.05) < 1.1e-3);
    CHECK(std::abs(bouncing.contacts[1].duration - 0.04) < 1.1e-3);
    CHECK_FALSE(bouncing.contacts[2].ends_inside);
    CHECK(std::abs(bouncing.contacts[2].duration - 0.1) < 1.1e-3);
    CHECK(bouncing.chatter == Approx(2.5 / 3.0).epsilon(1e-3));  // peaks 1, 0.5, 1; measured 4e-4, bound 1e-3
}

TEST_CASE("Contacts: a load that stays is one contact without chatter, no force is none") {
    const History load([](double) { return 3.0; });
    const ForceMeasures resting = measure_force(load.time, load.force);
    REQUIRE(resting.contacts.size() == 1);
    CHECK(resting.chatter == Approx(1.0));
    CHECK(resting.mean == Approx(3.0));
    CHECK(resting.in_contact == Approx(1.0).epsilon(1e-3));
    CHECK_FALSE(resting.contacts[0].ends_inside);
    const History nothing([](double) { return 0.0; });
    const ForceMeasures none = measure_force(nothing.time, nothing.force);
    CHECK(none.contacts.empty());
    CHECK(none.peak == 0.0);
}

TEST_CASE("Restitution: ratio of the speeds around a contact, only where it begins and ends in free flight") {
    const std::vector<double> approach = {2, 2, 1, -1, -1.6, -1.6};
    CHECK(restitution({2, 5, true, true, 0}, approach) == Approx(0.8));
    CHECK(std::isnan(restitution({2, 5, true, false, 0}, approach)));
    CHECK(std::isnan(restitution({0, 5, false, true, 0}, approach)));
    CHECK(std::isnan(restitution({2, 5, true, true, 0}, {0, 0, 1, -1, -1, -1})));  // no approach before
}

namespace {

/// Rows of a grain that moves with `before` until row 3 and with `after` from row 5 on, under `force` in
/// between.
Columns motion(double x, double y, std::array<double, 2> before, std::array<double, 2> after,
               std::array<double, 2> force) {
    Columns rows{{"time", "x", "y", "vx", "vy", "fx", "fy"}, std::vector<std::vector<double>>(7)};
    for (int i = 0; i < 8; ++i) {
        const auto& v = i < 4 ? before : after;
        const double f = i == 4 || i == 5 ? 1.0 : 0.0;
        const double cells[] = {0.1 * i, x, y, v[0], v[1], f * force[0], f * force[1]};
        for (std::size_t c = 0; c < 7; ++c) rows.values[c].push_back(cells[c]);
    }
    return rows;
}

double restitution_of(const Deck& deck, const std::map<int, Columns>& grains, int grain = 0) {
    RunFiles run;
    run.grains = grains;
    const Columns& rows = run.grains.at(grain);
    const ForceMeasures force = measure_force(*rows.find("time"), force_size(rows, 2));
    return first_restitution(deck, run, grain, force.contacts);
}

}  // namespace

TEST_CASE("Restitution: of two disks along the line of centres, whatever friction does") {
    const Deck deck = read_text(plain_deck);
    // Centres along x; friction turns the impulse, and changes vy.
    const Columns first = motion(0, 0, {1, 0.3}, {-0.7, 0.1}, {-4, -1}),
                  second = motion(1, 0, {-1, 0}, {0.9, 0.2}, {4, 1});
    CHECK(restitution_of(deck, {{0, first}, {1, second}}) == Approx(0.8));
    CHECK(restitution_of(deck, {{0, first}, {1, second}}, 1) == Approx(0.8));
    // The other one was pushed by something else: no partner.
    CHECK(std::isnan(restitution_of(deck, {{0, first}, {1, motion(1, 0, {-1, 0}, {1, 0}, {3, 0})}})));
    CHECK(std::isnan(restitution_of(deck, {{0, first}})));
}

TEST_CASE("Restitution: at a wall along its normal, against the velocity of the wall") {
    const Columns falling = motion(0, 1, {2, -3}, {1.8, 1.5}, {-1, 4});
    CHECK(restitution_of(read_text(plain_deck), {{0, falling}}) == Approx(0.5));
    const Deck rising = read_text(plain_deck, {"walls.0.velocity=[0, 1]"});
    CHECK(restitution_of(rising, {{0, falling}}) == Approx(0.5 / 4.0));
    // Steeper than friction lets a wall push.
    CHECK(std::isnan(restitution_of(read_text(plain_deck), {{0, motion(0, 1, {2, -3}, {1, 1}, {-4, 4})}})));
}

TEST_CASE("Measure: values between rows, medians and noise of repeats") {
    const Columns rows{{"time", "x"}, {{0, 1, 3}, {0, 2, 0}}};
    CHECK(value_at(rows, "x", 0.5) == Approx(1.0));
    CHECK(value_at(rows, "x", 2.0) == Approx(1.0));
    CHECK(value_at(rows, "x", 0.0) == 0.0);
    CHECK(value_at(rows, "x", 3.0) == 0.0);
    CHECK(std::isnan(value_at(rows, "x", 3.1)));
    CHECK(std::isnan(value_at(rows, "y", 1.0)));
    const TempFolder folder;
    std::vector<RunSummary> repeats;
    for (const double seconds : {1.0, 1.5, 1.1}) {
        const std::string file =
            folder.write("summary.json",
                         fmt::format("{{\"wall_seconds\": {}, \"stages\": {{\"kick\": {}, \"output\": 0.5}}, "
                                     "\"ns_per_particle_step\": 7, \"peak_memory_bytes\": 3}}",
                                     seconds + 0.5, seconds));
        repeats.emplace_back(std::filesystem::path(file).parent_path().string());
    }
    const RunCost cost = median_cost(repeats);
    CHECK(cost.step_seconds == Approx(1.1));
    CHECK(cost.noise == Approx(0.25 / 1.1));
    CHECK(cost.stages[0] == std::pair<std::string, double>{"kick", 1.1});
    CHECK(median_cost({repeats[0]}).noise == unknown_noise);
    CHECK(median_cost({repeats[0], repeats[0]}).noise == least_noise);
}
