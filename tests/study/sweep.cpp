// `quern sweep` as it is built: tables, failed runs, interruption, resumption.
#include <chrono>
#include <csignal>
#include <thread>

#include "src/study/run_files.hpp"
#include "tests/sim/decks.hpp"
#include "tests/sim/program.hpp"

namespace quern::test {

namespace {

const std::string falling = plane_deck + R"yaml(time: {end: 0.02}
gravity: [0, -9.8]
walls: [{side: y-}]
output: {track: all}
grains: [{shape: disk, material: rubber, position: [2, 0.55]}]
)yaml";

/// A folder with a deck and a place for results.
struct Place {
    TempFolder folder;
    std::string deck = folder.write("deck.yaml", falling), out = deck + ".out";
    std::vector<std::string> command(std::vector<std::string> more) const {
        more.insert(more.begin(), {"sweep", deck, "-o", out});
        return more;
    }
    std::string table() const { return read_file(out + "/sweep.csv"); }
    std::string outcome(const std::string& run) const {
        return RunSummary(out + "/runs/" + run).text("outcome");
    }
    auto time_of(const std::string& run) const {
        return std::filesystem::last_write_time(out + "/runs/" + run + "/summary.json");
    }
};

std::size_t count(const std::string& text, const std::string& part) {
    std::size_t n = 0;
    for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
    return n;
}

template <class Condition>
void wait_until(Condition&& condition) {
    for (int i = 0; i < 1000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
    REQUIRE(condition());
}

/// The first process that this one has started; 0 if none lives.
pid_t child_of(pid_t parent) {
    std::istringstream list(read_file(fmt::format("/proc/{0}/task/{0}/children", parent)));
    pid_t child = 0;
    list >> child;
    return child;
}

bool is_running(const Place& place, const std::string& run) {
    return contains(read_file(place.out + "/runs/" + run + "/run.log"), "steps");
}

}  // namespace

TEST_CASE("Sweep: a row a run, values by name, and nothing is run twice") {
    const Place place;
    const auto command =
        place.command({"--set", "gravity=[0, -5],[0, -9.8]", "--set", "params.n=3,4", "--set",
                       "contact.friction=0.1", "-j", "2", "--value", "fall = grains.0.vy.last"});
    const Result first = quern(place.folder, command);
    CAPTURE(first.err);
    REQUIRE(first.code == 0);
    CHECK(contains(first.out, "4 runs, 0 of them done before"));
    const std::string table = place.table();
    CHECK(count(table, "\n") == 5);
    CHECK(table.rfind("run,gravity,params.n,contact.friction,outcome,message,steps,", 0) == 0);
    CHECK(contains(table, ",fall\n"));
    CHECK(contains(table, "\"gravity=_0,_-5_,n=3\",\"[0, -5]\",3,0.1,done,,"));
    // The same fall under the same gravity: 5 m/s^2 for 0.02 s before the disk meets the floor.
    CHECK(count(table, ",-0.1") >= 2);
    const std::string hash = RunSummary(place.out + "/runs/gravity=_0,_-5_,n=4").text("state_hash");
    CHECK(hash.size() == 16);
    CHECK(contains(table, hash));
    CHECK(contains(read_file(place.out + "/sweep.json"), "\"state_hash\": \"" + hash + "\""));

    const Result again = quern(place.folder, command);
    CHECK(again.code == 0);
    CHECK(again.err == "");
    CHECK(contains(again.out, "4 runs, 4 of them done before"));
    CHECK(place.table() == table);

    // Another deck under the same name is another run.
    auto other = command;
    other[9] = "contact.friction=0.2";
    REQUIRE(contains(command[9], "0.1"));
    CHECK(contains(quern(place.folder, other).out, "4 runs, 0 of them done before"));
    CHECK(contains(place.table(), hash));  // friction is not met in free fall
}

TEST_CASE("Sweep: the memory of a run is its own, however large the process that starts it") {
    const Place place;
    const std::vector<std::string> command = {"run", place.deck, "-o", place.out, "--threads", "1"};
    const auto peak = [&] {
        REQUIRE(quern(place.folder, command).code == 0);
        return RunSummary(place.out).number("peak_memory_bytes");
    };
    const double alone = peak();
    const std::vector<char> ballast(300'000'000, 'x');
    CHECK(ballast[alone > 0.0 ? 7 : 8] == 'x');
    CHECK(peak() == doctest::Approx(alone).epsilon(0.05));  // measured 0.01, bound 0.05
}

TEST_CASE("Sweep: a run that fails is told in the table and stops no other") {
    const Place place;
    const auto command =
        place.command({"--set", "grains.0.velocity=[0, 0],[200, 0],[1, 0]", "--set", "time.end=0.1"});
    const Result result = quern(place.folder, command);
    CHECK(result.code == 3);
    CHECK(contains(result.out, "done 2, failed 1, left 0"));
    CHECK(contains(result.err, "has left the grid"));
    CHECK(count(place.table(), ",done,,") == 2);
    CHECK(count(place.table(), ",failed,\"grain 0") == 1);
    CHECK(contains(quern(place.folder, command).out, "3 runs, 2 of them done before"));
}

TEST_CASE("Sweep: after an interrupt the same command runs what is missing") {
    const Place place;
    // Each of these takes a second or so.
    const auto command = place.command({"--set", "params.n=6,7,8", "--set", "time.end=3"});
    const Program program(place.folder, command);
    wait_until([&] { return place.outcome("n=6") == "done" && is_running(place, "n=7"); });
    program.signal(SIGINT);
    const Result result = program.wait();
    CHECK(result.code == 130);
    CHECK(contains(result.out, "the same command runs what is left"));
    CHECK(place.outcome("n=7") == "interrupted");
    CHECK(count(place.table(), ",done,,") == 1);
    CHECK(count(place.table(), ",interrupted,,") == 1);
    CHECK(count(place.table(), ",missing,,") == 1);
    const auto before = place.time_of("n=6");
    const Result again = quern(place.folder, command);
    CHECK(again.code == 0);
    CHECK(contains(again.out, "3 runs, 1 of them done before"));
    CHECK(place.time_of("n=6") == before);
    CHECK(count(place.table(), ",done,,") == 3);
}

TEST_CASE("Sweep: a run that is killed fails, and is run again") {
    const Place place;
    const auto command = place.command({"--set", "params.n=6,4", "--set", "time.end=3"});
    const Program program(place.folder, command);
    wait_until([&] { return is_running(place, "n=6"); });
    const pid_t child = child_of(program.id());
    REQUIRE(child > 0);
    kill(child, SIGKILL);
    CHECK(program.wait().code == 3);
    CHECK(contains(place.table(), "n=6,6,3,failed,ended by signal 9"));
    CHECK(count(place.table(), ",done,,") == 1);
    const Result again = quern(place.folder, command);
    CHECK(again.code == 0);
    CHECK(contains(again.out, "2 runs, 1 of them done before"));
}

TEST_CASE("Sweep: runs end with a sweep that is killed, and their folder can be used again") {
    const Place place;
    const Program program(place.folder, place.command({"--set", "params.n=6", "--set", "time.end=1000"}));
    wait_until([&] { return is_running(place, "run"); });
    const pid_t child = child_of(program.id());
    program.signal(SIGKILL);
    CHECK(program.wait().code == -1);
    wait_until([&] { return place.outcome("run") == "interrupted" || kill(child, 0) != 0; });
    const Result again =
        quern(place.folder, place.command({"--set", "params.n=6", "--set", "time.end=0.01"}));
    CHECK(again.code == 0);
    CHECK(place.outcome("run") == "done");
}

TEST_CASE("Sweep: bad input ends with 2 and one line before anything is run") {
    const Place place;
    const auto fails = [&](const std::vector<std::string>& more, const std::string& word) {
        check_failure(quern(place.folder, place.command(more)), 2, word);
        CHECK_FALSE(std::filesystem::exists(place.out));
    };
    fails({"--set", "params.nn=1,2"}, "did you mean n?");
    fails({"--set", "contact.fricton=1,2"}, "did you mean friction?");
    fails({"--set", "contact.friction=1,-2"}, "-2");
    fails({"--set", "params.n="}, "no value");
    fails({"--set", "params.n=3", "--value", "grains.0.y.lst"}, "did you mean last?");
    fails({"--set", "params.n=3", "-j", "0"}, "--jobs");
    check_failure(quern(place.folder, {"sweep", place.deck, "--set", "params.n=3"}), 2, "--output");
    check_failure(quern(place.folder, {"sweep", place.deck, "--set", "params.n=3", "-o", place.deck}), 4,
                  "cannot create the directory");
}

}  // namespace quern::test
