// `quern plot` as it is built: pictures of an observed run, and what it says of others.
#include "src/study/plot.hpp"

#include "src/study/observed.hpp"
#include "tests/sim/decks.hpp"
#include "tests/sim/program.hpp"

namespace quern::test {

namespace {

/// Four disks on a floor, under gravity, on a periodic axis.
const std::string pile = replaced(plane_deck, "extent: [6, 4]", "extent: [2, 4], periodic: [x]") + R"yaml(
time: {end: 0.1}
gravity: [0, -9.8]
walls: [{side: y-}]
output: {interval: 0.05}
grains: [{shape: disk, material: rubber, array: {counts: [2, 2], origin: [0.5, 0.499], step: [1, 0.999]}}]
)yaml";
const std::string seen =
    "observe: {profiles: {height: {axis: y, bins: 4}}, regions: {low: {from: [0, 0], to: [2, 1]}}}\n";

struct Place {
    explicit Place(const std::string& text) : deck(folder.write("deck.yaml", text)), out(deck + ".out") {
        REQUIRE(quern(folder, {"run", deck, "-o", out, "--threads", "1"}).code == 0);
    }
    Result plot(std::vector<std::string> more = {}) const {
        more.insert(more.begin(), {"plot", out});
        return quern(folder, more);
    }
    TempFolder folder;
    std::string deck, out;
};

}  // namespace

TEST_CASE("Plot: an observed run gives every picture, or those that are asked for") {
    const Place run(pile + seen);
    const Result all = run.plot();
    CAPTURE(all.err);
    CHECK(all.code == 0);
    CHECK_FALSE(contains(all.out, "left out"));
    for (const std::pair<std::string, std::string>& plot : plot_names()) {
        const std::string name = plot.first;
        const std::string file = run.out + "/plots/" + name + ".png";
        CHECK_MESSAGE(read_file(file).starts_with("\x89PNG"), name);
        CHECK(contains(all.out, file));
    }
    const std::string folder = run.out + "/else";
    CHECK(run.plot({"stress", "profiles", "--region", "low", "--frame", "0,last", "-o", folder}).code == 0);
    CHECK(std::filesystem::exists(folder + "/stress.png"));
    CHECK(std::filesystem::exists(folder + "/profiles.png"));
    CHECK_FALSE(std::filesystem::exists(folder + "/energy.png"));
    CHECK(contains(quern(run.folder, {"plot", "--list"}).out, "network"));
}

TEST_CASE("Plot: what cannot be drawn is named") {
    const Place run(pile + seen), blind(pile);
    const auto refused = [](const Result& result, const std::string& words) {
        CAPTURE(result.err);
        CHECK(result.code == 2);
        CHECK(contains(result.err, words));
    };
    refused(run.plot({"netwrok"}), "did you mean network?");
    refused(run.plot({"profiles", "--frame", "3"}),
            "--frame: got '3', expected last, or a number from 0 to 2");
    refused(run.plot({"stress", "--region", "lwo"}), "did you mean low?");
    refused(blind.plot({"network"}), "run again with observe in the deck");
    refused(quern(run.folder, {"plot", run.out + "/nowhere"}), "a folder with history.csv");
    const Result part = blind.plot();
    CHECK(part.code == 0);
    CHECK(contains(part.out, "energy.png"));
    CHECK(contains(part.out, "left out         network: no contacts.csv"));
    CHECK(contains(part.out, "with observe in the deck"));
}

TEST_CASE("Plot: tables of observers are read back by frame and name") {
    const Place run(pile + seen);
    const ObservedTable regions(run.out, "regions"), contacts(run.out, "contacts");
    CHECK(regions.names() == std::vector<std::string>{"all", "low"});
    CHECK(regions.times().size() == 3);
    CHECK(regions.rows_of("low").size() == 3);
    const double last = regions.times().back();
    REQUIRE(regions.rows(last, "low").size() == 1);
    CHECK(regions.pick("grains", regions.rows(last, "low"))[0] == 2.0);
    CHECK(regions.pick("grains", regions.rows(last))[0] == 4.0);
    // Each disk touches its neighbour on both sides, once across the periodic face.
    int across = 0;
    for (const std::size_t i : contacts.rows(last))
        across += contacts.column("first")[i] == 0.0 && contacts.column("second")[i] == 1.0;
    CHECK(across == 2);
}

}  // namespace quern::test
