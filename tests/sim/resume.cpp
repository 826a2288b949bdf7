// A run that is stopped anywhere and goes on ends with the bits of one that never stopped.
#include <chrono>
#include <csignal>
#include <thread>

#include "src/results/hdf5_handle.hpp"
#include "tests/sim/decks.hpp"
#include "tests/sim/program.hpp"

namespace quern::test {

namespace {

void sleep_ms(int milliseconds) {
    std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
}

std::string hash_in(const std::string& directory) {
    const std::string text = read_file(directory + "/summary.json");
    const std::size_t at = text.find("\"state_hash\"");
    return at == std::string::npos ? "none" : text.substr(at, 32);
}

/// Spheres that fall on a plate that moves up; the motion passes through the grid.
const std::string flip = space_deck + R"yaml(time: {end: 2}
gravity: [0, 0, -9.8]
walls: [{name: plate, point: [0, 0, 0.1], normal: [0, 0, 1], velocity: [0, 0, "0.5*sin(100*t)"], friction: 0.2}]
contact: {coupling: flip, friction: 0.3}
output: {track: all, checkpoint: {every: 5}, history_interval: 0.01, interval: 0.1}
damping: {mass: 1}
grains:
  - {shape: ball, material: rubber, array: {counts: [2, 2, 2], origin: [0.7, 0.7, 0.7], step: [1.1, 1.1, 1.02]},
     velocity: [0, 0, -3]}
)yaml";

/// Grains that break under a lid.
const std::string lid =
    replaced(unequal_deck, "{side: x+}]",
             "{side: x+}, {name: lid, point: [3, 5.9], normal: [0, -1], servo: {force: 9e4}}]");

/// Numbers of a table in results.h5 by their bits; none if it is not there.
std::vector<std::uint64_t> observed(const std::string& directory, const std::string& name) {
    const Hdf5Handle file(H5Fopen((directory + "/results.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT),
                          H5Fclose);
    if (H5Lexists(file, "observed", H5P_DEFAULT) <= 0) return {};
    const Hdf5Handle rows(H5Dopen2(file, ("observed/" + name).c_str(), H5P_DEFAULT), H5Dclose);
    const Hdf5Handle space(H5Dget_space(rows), H5Sclose);
    std::vector<std::uint64_t> values(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    H5Dread(rows, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    return values;
}

struct Case {
    std::string deck;
    std::vector<std::string> overrides;
    int threads;
};

std::vector<std::string> command(const std::string& deck, const Case& c, const std::string& out) {
    std::vector<std::string> arguments = {"run", deck, "-o", out, "--threads", std::to_string(c.threads)};
    for (const std::string& value : c.overrides) {
        arguments.emplace_back("--set");
        arguments.push_back(value);
    }
    return arguments;
}

/// Lets it run a while, kills it, goes on, as often as `kills` says; the last time until it ends.
void check_killed(const Case& c, int signal, const std::vector<int>& kills) {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", c.deck), whole = deck + ".whole", out = deck + ".out";
    REQUIRE(quern(folder, command(deck, c, whole)).code == 0);
    int n_resumed = 0;
    std::vector<std::string> arguments = command(deck, c, out);
    for (const int milliseconds : kills) {
        const Program program(folder, arguments);
        // Something to go on from: a checkpoint, or what an interrupt will leave once the clock runs.
        const auto begun = [&] {
            return signal == SIGKILL ? std::filesystem::exists(out + "/checkpoint.h5")
                                     : std::filesystem::exists(out + "/history.csv") &&
                                           read_file(out + "/history.csv").size() > 1000;
        };
        for (int k = 0; k < 4000 && !begun(); ++k) sleep_ms(1);
        sleep_ms(milliseconds);
        program.signal(signal);
        // One that had ended before an interrupt came has left no checkpoint: tried again.
        if (program.wait().code == 0 && signal != SIGKILL) continue;
        arguments = {"run", "--resume", out, "--threads", std::to_string(c.threads)};
        ++n_resumed;
    }
    const Result result = quern(folder, arguments);
    CAPTURE(result.err);
    CHECK(result.code == 0);
    CHECK(n_resumed > 0);
    CHECK(contains(read_file(out + "/run.log"), "goes on from step"));
    CHECK(hash_in(out) == hash_in(whole));
    for (const char* name : {"history.csv", "grains.csv", "reactions.csv", "fragments.csv", "results.xdmf",
                             "contacts.csv", "grain_stress.csv", "regions.csv", "profiles.csv", "forces.csv"})
        CHECK_MESSAGE(read_file(out + "/" + name) == read_file(whole + "/" + name), name);
    for (const char* name : {"contacts", "contacts_end", "regions", "profiles"})
        CHECK_MESSAGE(observed(out, name) == observed(whole, name), name);
}

const std::vector<std::string> often = {"output.checkpoint.every=20", "output.track=all"};

}  // namespace

TEST_CASE("Resume: killed runs end with the same bits and files, breaking grains and unions included") {
    check_killed({unequal_deck, often, 1}, SIGKILL, {0, 60, 30});
    check_killed({unequal_deck, often, 2}, SIGKILL, {10, 45});
}

TEST_CASE("Resume: grains that yield") {
    const std::string plastic = replaced(unequal_deck, "bond_damping: 0.1 ms, critical_stretch: 0.03",
                                         "model: correspondence, yield_stress: 20 kPa");
    check_killed({plastic, often, 1}, SIGKILL, {0, 60});
    check_killed({plastic, often, 2}, SIGKILL, {30});
}

TEST_CASE("Resume: contact between nodes, sticking, slipping and through cracks") {
    std::vector<std::string> pairs = often;
    pairs.emplace_back("contact.method=node_pair");
    check_killed({unequal_deck, pairs, 1}, SIGKILL, {0, 60, 30});
    check_killed({unequal_deck, pairs, 2}, SIGKILL, {45});
    check_killed({flip, {"contact.method=node_pair", "time.end=0.5"}, 1}, SIGKILL, {3, 20});
}

TEST_CASE("Resume: in space, through the grid, with moving walls") {
    check_killed({flip, {}, 1}, SIGKILL, {3, 20});
}

TEST_CASE("Resume: material points, in space, with moving walls") {
    const std::string points = replaced(flip, "rubber: {density", "rubber: {model: material_points, density");
    check_killed({points, {"contact.coupling=impulse", "time.end=0.5"}, 1}, SIGKILL, {3, 20});
}

TEST_CASE("Resume: from each of some checkpoints, with debris that rubs") {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", lid);
    for (const int every : {20, 30, 40, 50, 60, 70}) {
        CAPTURE(every);
        const std::string out = deck + std::to_string(every);
        const std::string setting = "output.checkpoint.every=" + std::to_string(every);
        REQUIRE(quern(folder, {"run", deck, "-o", out, "--threads", "1", "--set", setting}).code == 0);
        const std::string hash = hash_in(out);
        REQUIRE(quern(folder, {"run", "--resume", out, "--threads", "1"}).code == 0);
        CHECK(hash_in(out) == hash);
    }
}

TEST_CASE("Resume: a wall that presses as hard as asked") {
    check_killed({lid, often, 1}, SIGKILL, {0, 60});
    check_killed({lid, often, 2}, SIGKILL, {45});
}

TEST_CASE("Resume: observed contacts, stress and profiles") {
    const std::string seen =
        "observe: {profiles: {up: {axis: y, bins: 7}}, regions: {low: {from: [0, 0], to: [6, 2]}}}\n";
    std::vector<std::string> frames = often;
    frames.emplace_back("output.interval=0.002");
    check_killed({unequal_deck + seen, frames, 1}, SIGKILL, {0, 60, 30});
    frames.emplace_back("contact.method=node_pair");
    check_killed({unequal_deck + seen, frames, 2}, SIGKILL, {45});
}

TEST_CASE("Resume: an interrupt leaves a checkpoint without being asked to") {
    check_killed({flip, {"output.checkpoint.every=0"}, 1}, SIGTERM, {5, 1, 1, 1});
    check_killed({unequal_deck, {}, 2}, SIGINT, {5, 20, 1, 1});
}

TEST_CASE("Resume: what does not fit is refused, a damaged checkpoint gives way to the one before") {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", flip), out = deck + ".out";
    const auto refused = [&](const std::string& words) {
        const Result result = quern(folder, {"run", "--resume", out});
        CAPTURE(result.err);
        CHECK(result.code == 2);
        CHECK(contains(result.err, words));
    };
    refused("checkpoint.h5: got no such file");
    CHECK(contains(quern(folder, {"run", "--resume", out, deck}).err, "--resume"));
    CHECK(contains(quern(folder, {"run", "--resume", out, "--set", "time.end=1"}).err, "--set"));
    REQUIRE(quern(folder, {"run", deck, "-o", out, "--threads", "1"}).code == 0);
    const std::string hash = hash_in(out);

    const std::string resolved = read_file(out + "/deck.resolved.yaml");
    std::ofstream(out + "/deck.resolved.yaml") << replaced(resolved, "3000", "3001");
    refused("deck.resolved.yaml: got a deck that was changed");
    std::ofstream(out + "/deck.resolved.yaml") << resolved;

    std::filesystem::resize_file(out + "/checkpoint.h5", 5000);
    const Result result = quern(folder, {"run", "--resume", out, "--threads", "2"});
    CHECK(result.code == 0);
    CHECK(contains(result.out, "the checkpoint before is used"));
    CHECK(hash_in(out) == hash);
    std::filesystem::resize_file(out + "/checkpoint.h5", 5000);
    std::filesystem::resize_file(out + "/checkpoint.previous.h5", 5000);
    refused("checkpoint.previous.h5: got a file that is cut off or altered");

    // A new run in the same folder has no checkpoints of the old one.
    REQUIRE(quern(folder, {"run", deck, "-o", out, "--set", "output.checkpoint.every=0"}).code == 0);
    refused("no such file");
}

}  // namespace quern::test
