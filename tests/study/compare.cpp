// `quern compare` as it is built, on tiny decks.
#include "src/study/run_files.hpp"
#include "tests/sim/decks.hpp"
#include "tests/sim/program.hpp"

namespace quern::test {

namespace {

/// A disk falls on a floor and jumps up again.
const std::string bouncing = plane_deck + R"yaml(time: {end: 0.3}
walls: [{side: y-}]
output: {track: all, history_interval: 1 ms}
grains: [{shape: disk, material: rubber, position: [2, 0.58], velocity: [0, -1]}]
)yaml";

struct Place {
    TempFolder folder;
    std::string deck = folder.write("deck.yaml", bouncing), out = deck + ".out";
    Result run(std::vector<std::string> more, const std::string& of = {}) const {
        more.insert(more.begin(), {"compare", of.empty() ? deck : of, "-o", out});
        return quern(folder, more);
    }
    std::string report() const { return read_file(out + "/comparison.md"); }
    Node json() const { return read_tree(out + "/comparison.json"); }
};

/// A quantity of the i-th run.
double quantity(const Node& json, std::size_t i, const std::string& key) {
    const Node* value = json.find("runs")->items.at(i).find("quantities")->find(key);
    return value ? std::stod(value->text) : std::nan("");
}

const std::vector<std::string> two = {"--variant", "pair: contact.rule=pair", "--variant",
                                      "slow: contact.rule=pair, time.safety=0.3"};

}  // namespace

TEST_CASE("Compare: tables, numbers, sentences and charts of two variants") {
    const Place place;
    std::vector<std::string> arguments = two;
    arguments.insert(arguments.end(), {"--set", "params.n=4", "--repeat", "2"});
    const Result result = place.run(arguments);
    CAPTURE(result.err);
    REQUIRE(result.code == 0);
    const Node json = place.json();
    REQUIRE(json.find("runs")->items.size() == 2);
    // One bounce at the floor: the same by both, in twice as many steps; R/dx = 4 loses some 8 % of the
    // speed.
    const double e = quantity(json, 0, "contact.0.restitution");
    CHECK(e > 0.88);  // measured 0.903, bound 0.88
    CHECK(e < 0.93);
    CHECK(quantity(json, 1, "contact.0.restitution") ==
          doctest::Approx(e).epsilon(0.01));  // measured 0.002, bound 0.01
    CHECK(quantity(json, 0, "contact.0.count") == 1);
    CHECK(quantity(json, 1, "cost.steps") ==
          doctest::Approx(2.0 * quantity(json, 0, "cost.steps")).epsilon(0.02));
    CHECK(quantity(json, 1, "difference.position") > 0.0);
    CHECK(std::isnan(quantity(json, 0, "difference.position")));  // the reference
    CHECK(quantity(json, 0, "energy.lost") > 0.0);
    CHECK(json.find("runs")->items[0].find("same_bits")->text == "true");
    CHECK(json.find("runs")->items[0].find("folders")->items.size() == 2);
    const std::string report = place.report();
    for (const char* part :
         {"# Comparison: test", "| slow | `contact.rule=pair, time.safety=0.3` |", "## Energy",
          "## Where each is better", "- Cost, steps: `pair` (", "less than `slow`", "## Contact of grain 0",
          "## Final state of grain 0", "## Cost by stage", "![trajectories](trajectories.png)"})
        CHECK_MESSAGE(contains(report, part), std::string(part));
    REQUIRE(json.find("plots")->items.size() == 5);
    for (const Node& plot : json.find("plots")->items)
        CHECK(read_file(place.out + "/" + plot.text).substr(1, 3) == "PNG");
}

TEST_CASE("Compare: over a resolution, with slopes, from a table, without running again") {
    const Place place;
    // Free flight towards the floor, seen from 0.1 m aside.
    std::string table = "time,x,y\n";
    for (int i = 0; i <= 30; ++i) table += fmt::format("{},2.1,{}\n", 0.01 * i, 0.58 - 0.01 * i);
    std::vector<std::string> arguments = two;
    arguments.insert(arguments.end(), {"--over", "params.n=3,6", "--set", "time.end=0.03", "--reference",
                                       place.folder.write("exact.csv", table)});
    REQUIRE(place.run(arguments).code == 0);
    const Node json = place.json();
    REQUIRE(json.find("runs")->items.size() == 4);
    for (std::size_t i = 0; i < 4; ++i) {
        CHECK(quantity(json, i, "difference.trajectory") == doctest::Approx(0.1).epsilon(1e-12));
        CHECK(quantity(json, i, "difference.position") == doctest::Approx(0.1).epsilon(1e-12));
    }
    CHECK(quantity(json, 2, "cost.n_particles") > quantity(json, 0, "cost.n_particles"));
    const std::string report = place.report();
    for (const char* part : {"## Slopes over `params.n`", "at `n=6`", "; at n=3", "exact.csv",
                             "![levels](levels.png)", "Difference to the reference, positions over time"})
        CHECK_MESSAGE(contains(report, part), std::string(part));
    arguments.push_back("--reuse");
    const Result again = place.run(arguments);
    CHECK(again.code == 0);
    CHECK(contains(again.out, "0 runs"));
    CHECK(place.report() == report);
}

TEST_CASE("Compare: a run that fails is told, the others are compared") {
    const Place place;
    const Result result = place.run({"--variant", "good", "--variant", "bad: grains.0.velocity=[200, 0]",
                                     "--variant", "other: time.safety=0.5"});
    CHECK(result.code == 3);
    CHECK(contains(place.report(), "| bad | failed | grain 0"));
    CHECK(contains(place.report(), "- Cost, steps: `good` ("));
    CHECK(place.json().find("runs")->items[1].find("outcome")->text == "failed");
}

TEST_CASE("Compare: in space, and without tracked grains, energies and costs are left") {
    const Place place;
    const std::string ball = place.folder.write("ball.yaml", space_deck + R"yaml(time: {end: 0.02}
walls: [{side: z-}]
grains: [{shape: ball, material: rubber, position: [2, 2, 0.51], velocity: [0, 0, -1]}]
)yaml");
    REQUIRE(place.run(two, ball).code == 0);
    CHECK(contains(place.report(), "| lost, all accounts | J |"));
    CHECK_FALSE(contains(place.report(), "## Contact of grain"));
    CHECK_FALSE(contains(place.report(), "trajectories.png"));
    CHECK(contains(place.report(), "## Cost"));
    std::vector<std::string> tracked = two;
    tracked.insert(tracked.end(), {"--set", "output.track=all"});
    REQUIRE(place.run(tracked, ball).code == 0);
    CHECK(contains(place.report(), "| peak force | N |"));
    CHECK(contains(place.report(), "| z | m |"));
}

TEST_CASE("Compare: bad input ends with 2 and one line before anything is run") {
    const Place place;
    const auto fails = [&](const std::vector<std::string>& more, const std::string& word) {
        check_failure(place.run(more), 2, word);
        CHECK_FALSE(std::filesystem::exists(place.out));
    };
    fails({"--variant", "a: contact.fricton=1"}, "did you mean friction?");
    fails({"--variant", "a", "--variant", "a: contact.friction=1"}, "the name 'a' twice");
    fails({"--variant", "a:"}, "--variant");
    fails({"--variant", "a", "--set", "contact.fricton=1"}, "did you mean friction?");
    fails({"--variant", "a", "--over", "params.n="}, "no value");
    fails({"--variant", "a", "--over", "params.nn=1,2"}, "did you mean n?");
    fails({"--variant", "alpha", "--reference", "alpa"}, "did you mean alpha?");
    fails({"--variant", "a", "--reference", place.folder.write("r.csv", "t,x\n0,1\n1,2\n")}, "also 'time'");
    fails({"--variant", "a", "--repeat", "0"}, "--repeat");
    check_failure(quern(place.folder, {"compare", place.deck, "--variant", "a", "-o", place.deck}), 4,
                  "cannot create the directory");
}

}  // namespace quern::test
