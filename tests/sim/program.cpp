// The program as it is built: exit codes, messages, files, signals.
#include <chrono>
#include <csignal>
#include <thread>

#include "tests/sim/decks.hpp"
#include "tests/sim/program.hpp"

namespace quern::test {

namespace {

const std::string falling = plane_deck + R"yaml(time: {end: 0.05}
gravity: [0, -9.8]
walls: [{side: y-}]
output: {track: all}
grains: [{shape: disk, material: rubber, position: [2, 0.55]}]
)yaml";

}  // namespace

TEST_CASE("Program: run writes its results and says where") {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", falling);
    const std::string out = deck + ".out/new/nested folder";
    const Result result = quern(folder, {"run", deck, "-o", out, "--threads", "1"});
    CHECK(result.code == 0);
    CHECK(result.err == "");
    CHECK(contains(result.out, "1 grains"));
    CHECK(contains(result.out, out));
    for (const char* name : {"results.h5", "results.xdmf", "history.csv", "grains.csv", "reactions.csv",
                             "summary.json", "run.log", "deck.resolved.yaml"})
        CHECK_MESSAGE(std::filesystem::exists(out + "/" + name), name);
    const std::string summary = read_file(out + "/summary.json");
    for (const char* key : {"\"state_hash\"", "\"n_grains\": 1", "\"n_particles\"", "\"n_bonds\"",
                            "\"steps\"", "\"wall_seconds\"", "\"writer_seconds\"", "\"ns_per_particle_step\"",
                            "\"stages\"", "\"energy\"", "\"residual_relative\"", "\"momentum_error\"",
                            "\"linear\"", "\"angular\"", "\"outcome\": \"done\"", "\"threads\": 1"})
        CHECK_MESSAGE(contains(summary, key), key);

    // The resolved deck is a deck of the same run.
    const std::string again = deck + ".again";
    CHECK(quern(folder, {"run", out + "/deck.resolved.yaml", "-o", again, "--threads", "2"}).code == 0);
    const auto hash = [](const std::string& text) { return text.substr(text.find("\"state_hash\""), 32); };
    CHECK(hash(read_file(again + "/summary.json")) == hash(summary));

    CHECK_FALSE(contains(result.out, "ns/particle"));
    const Result profiled = quern(folder, {"run", deck, "--profile", "-o", again});
    CHECK(profiled.code == 0);
    for (const char* line :
         {"internal_forces", "writer", "contact nodes", "contact searches", "kB a particle"})
        CHECK_MESSAGE(contains(profiled.out, line), line);

    // --set reaches the run.
    const std::string other = deck + ".other";
    CHECK(quern(folder, {"run", deck, "--set", "gravity=[0, -5]", "-o", other}).code == 0);
    CHECK(hash(read_file(other + "/summary.json")) != hash(summary));
    CHECK(contains(read_file(other + "/deck.resolved.yaml"), "-5"));
}

TEST_CASE("Program: bad input ends with 2 and one line") {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", falling);
    check_failure(quern(folder, {}), 2, "a command is required");
    check_failure(quern(folder, {"rum", deck}), 2, "rum");
    check_failure(quern(folder, {"run"}), 2, "deck");
    check_failure(quern(folder, {"run", deck, "--threads", "0"}), 2, "--threads");
    check_failure(quern(folder, {"run", deck, "--colour"}), 2, "--colour");
    check_failure(quern(folder, {"run", deck + ".none"}), 2, "deck.yaml.none");
    check_failure(quern(folder, {"check", folder.write("a.yaml", replaced(falling, "radius", "radios"))}), 2,
                  "radius");
    check_failure(quern(folder, {"check", deck, "--set", "gravty=3"}), 2, "gravity");
    check_failure(quern(folder, {"run", deck, "--set", "grains.0.position=[2, 0.1]", "-o", deck + ".out"}), 2,
                  "wall 'y-'");
    check_failure(quern(folder, {"render", deck + ".none", "-o", deck + ".png"}), 2, "none");
    check_failure(quern(folder, {"import", "peridem", deck + ".none", "-o", deck + ".new"}), 2,
                  "no such file");
    check_failure(quern(folder, {"import", "peridem", deck, "-o", deck + ".new"}), 2,
                  "title: got an unknown key");
    check_failure(quern(folder, {"import", "peridem", deck}), 2, "--output is required");
    check_failure(quern(folder, {"import", "peridm", deck}), 2, "peridm");
    check_failure(quern(folder, {"import"}), 2, "a format is required: peridem");
    check_failure(quern(folder, {"import", "peridem", deck, "-o", "x", "--horizon", "fixed"}), 2, "absolute");
}

TEST_CASE("Program: a run that goes wrong ends with 3 and keeps its results") {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", falling);
    const Result result =
        quern(folder, {"run", deck, "--set", "grains.0.velocity=[200, 0]", "-o", deck + ".out"});
    check_failure(result, 3, "has left the grid");
    CHECK(contains(read_file(deck + ".out/summary.json"), "\"outcome\": \"failed: grain 0"));
}

TEST_CASE("Program: output that cannot be written ends with 4") {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", falling);
    const std::string file = folder.write("file", "");
    check_failure(quern(folder, {"run", deck, "-o", file}), 4, file);
    check_failure(quern(folder, {"run", deck, "-o", file + "/below"}), 4, file);
    check_failure(quern(folder, {"check", deck}, "/dev/full"), 4, "standard output");
    check_failure(quern(folder, {"schema"}, "/dev/full"), 4, "standard output");
    std::filesystem::create_directories(deck + ".full");
    std::filesystem::create_symlink("/dev/full", deck + ".full/history.csv");
    check_failure(quern(folder, {"run", deck, "-o", deck + ".full"}), 4, "history.csv");
}

TEST_CASE("Program: results that are deleted during the run end it with 4") {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", falling);
    const std::string out = deck + ".out";
    const Program program(folder, {"run", deck, "--set", "time.end=1000", "--set", "output.interval=0.01",
                                   "--set", "output.history_interval=0.01", "--threads", "2", "-o", out});
    while (!std::filesystem::exists(out + "/results.xdmf") ||
           !contains(read_file(out + "/results.xdmf"), "frame 3"))
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    std::filesystem::remove_all(out);
    check_failure(program.wait(), 4, "cannot write: the file was deleted during the run");
}

TEST_CASE("Program: an interrupt ends the run cleanly") {
    for (const int number : {SIGINT, SIGTERM}) {
        const TempFolder folder;
        const std::string deck = folder.write("deck.yaml", falling);
        const std::string out = deck + ".out";
        const Program program(folder, {"run", deck, "--set", "time.end=1000", "--set",
                                       "output.history_interval=0.01", "--threads", "1", "-o", out});
        // Steps are under way once rows have come out.
        while (!std::filesystem::exists(out + "/run.log") || !contains(read_file(out + "/run.log"), "steps"))
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        std::this_thread::sleep_for(std::chrono::milliseconds(200));
        program.signal(number);
        const Result result = program.wait();
        CHECK(result.code == 130);
        CHECK(result.err == "");
        CHECK(contains(result.out, "interrupted"));
        CHECK(contains(read_file(out + "/summary.json"), "\"outcome\": \"interrupted\""));
        CHECK(contains(read_file(out + "/summary.json"), "\"state_hash\""));
        CHECK(std::filesystem::file_size(out + "/results.h5") > 0);
    }
}

TEST_CASE("Program: check, schema, help and version") {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", falling);
    const Result checked = quern(folder, {"check", deck, "--set", "params.n=3"});
    CHECK(checked.code == 0);
    CHECK(checked.err == "");
    CHECK(quern(folder, {"check", folder.write("resolved.yaml", checked.out)}).out == checked.out);
    const Result schema = quern(folder, {"schema"});
    CHECK(schema.code == 0);
    CHECK(schema.out.front() == '{');
    CHECK(contains(schema.out, "\"$schema\""));
    const Result reference = quern(folder, {"schema", "--markdown"});
    CHECK(reference.code == 0);
    CHECK(contains(read_file(QUERN_SOURCE_DIR "/docs/deck.md"), reference.out.substr(0, 2000)));
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"--help"}, {"run", "--help"}, {"render", "--help"}}) {
        const Result help = quern(folder, arguments);
        CHECK(help.code == 0);
        CHECK(help.err == "");
        CHECK(contains(help.out, "quern"));
    }
    const Result version = quern(folder, {"--version"});
    CHECK(version.code == 0);
    CHECK(version.out.rfind("quern ", 0) == 0);
    CHECK(is_one_line(version.out));
}

TEST_CASE("Program: render draws a frame") {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", falling);
    REQUIRE(quern(folder, {"run", deck, "-o", deck + ".out"}).code == 0);
    const std::string picture = deck + ".png";
    const Result result = quern(folder, {"render", deck + ".out", "-o", picture, "--field", "von_mises"});
    CHECK(result.code == 0);
    CHECK(contains(result.out, picture));
    CHECK(read_file(picture).substr(1, 3) == "PNG");
    check_failure(quern(folder, {"render", deck + ".out", "-o", picture, "--field", "spede"}), 2, "speed");
    check_failure(quern(folder, {"render", deck + ".out", "-o", picture, "--frame", "5000"}), 2, "5000");
}

}  // namespace quern::test
