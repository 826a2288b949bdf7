#include "src/results/checkpoint_file.hpp"

#include <doctest/doctest.h>

#include <filesystem>

#include "grid/vec.hpp"
#include "tests/results/samples.hpp"

using namespace quern;

namespace {

struct State {
    std::vector<double> x;
    std::vector<Vec<2>> v;
    std::vector<std::uint8_t> alive, none;
    std::int64_t step = 0;
    double time = 0.0;

    void pass(Checkpoint& checkpoint) {
        checkpoint.vector("x", x);
        checkpoint.vector("v", v);
        checkpoint.vector("alive", alive);
        checkpoint.vector("none", none);
        checkpoint.value("step", step);
        checkpoint.value("time", time);
    }
};

State sample(double time) {
    return {{1.0, -0.0, 3e-310, 1.0 / 3.0}, {{1.0, 2.0}, {-3.0, 0.1}}, {255, 0, 7}, {}, -12, time};
}

void save(const std::string& directory, double time) {
    Checkpoint checkpoint;
    State state = sample(time);
    state.pass(checkpoint);
    write_checkpoint(directory, checkpoint);
}

State load(const std::string& directory, std::string& refused) {
    Checkpoint checkpoint = read_checkpoint(directory, refused);
    State state;
    state.pass(checkpoint);
    return state;
}

std::string refusal(const std::string& directory) {
    std::string refused;
    try {
        load(directory, refused);
    } catch (const InputError& error) {
        return error.what();
    }
    return {};
}

}  // namespace

TEST_SUITE("CheckpointFile") {
    TEST_CASE("Checkpoint: all bits come back") {
        const ScratchDirectory scratch;
        save(scratch.path(), 0.1);
        std::string refused;
        const State state = load(scratch.path(), refused), expected = sample(0.1);
        CHECK(refused.empty());
        CHECK(state.x == expected.x);
        CHECK(std::signbit(state.x[1]));
        CHECK(state.v == expected.v);
        CHECK(state.alive == expected.alive);
        CHECK(state.none.empty());
        CHECK(state.step == -12);
        CHECK(state.time == 0.1);
    }

    TEST_CASE("Checkpoint: the one before is kept, and used when the last cannot be read") {
        const ScratchDirectory scratch;
        save(scratch.path(), 1.0);
        save(scratch.path(), 2.0);
        save(scratch.path(), 3.0);
        std::string refused;
        CHECK(load(scratch.path(), refused).time == 3.0);
        CHECK(!std::filesystem::exists(scratch.path("checkpoint.h5.part")));

        // Cut off anywhere, and any byte altered: never read as something else.
        const std::string file = scratch.path("checkpoint.h5"), whole = read_text(file);
        int n_refused = 0;
        for (std::size_t at = 0; at < whole.size(); at += 97) {
            for (const bool cut : {true, false}) {
                std::string bad = cut ? whole.substr(0, at) : whole;
                if (!cut) bad[at] = static_cast<char>(bad[at] ^ 0x10);
                std::ofstream(file, std::ios::binary) << bad;
                const double time = load(scratch.path(), refused).time;
                // A byte of padding between the arrays changes nothing.
                CHECK((refused.empty() ? time == 3.0 && !cut : time == 2.0));
                if (!refused.empty()) ++n_refused;
            }
        }
        CHECK(n_refused > 20);
        std::filesystem::remove(scratch.path("checkpoint.previous.h5"));
        std::ofstream(file, std::ios::binary) << whole.substr(0, whole.size() / 2);
        CHECK(refusal(scratch.path()).find("checkpoint.h5: got a file that is cut off") != std::string::npos);
        std::filesystem::remove(file);
        CHECK(refusal(scratch.path()).find("no such file") != std::string::npos);
    }

    TEST_CASE("Checkpoint: arrays of another state are refused") {
        const ScratchDirectory scratch;
        save(scratch.path(), 1.0);
        std::string refused;
        std::vector<double> x(3);
        std::vector<std::int64_t> n;
        Checkpoint other = read_checkpoint(scratch.path(), refused);
        CHECK_THROWS_WITH_AS(other.vector("y", x), doctest::Contains("got an array x, expected an array y"),
                             InputError);
        CHECK_THROWS_WITH_AS(other.array("x", std::span(x)),
                             doctest::Contains("got 32 bytes in x, expected 24"), InputError);
        Checkpoint again = read_checkpoint(scratch.path(), refused);
        CHECK_THROWS_AS(again.vector("x", n), InputError);
    }
}
