// Order, bound and failures of the thread that writes.
#include "src/results/background_writer.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <future>
#include <string>

#include "grid/error.hpp"
#include "src/results/frame_file.hpp"
#include "src/results/writer.hpp"
#include "tests/results/samples.hpp"

using namespace quern;

namespace {

Packet make_packet(int number) {
    Packet packet;
    packet.frame = make_sample_frame(2, number);
    packet.has_frame = true;
    HistoryRow row;
    row.time = number;
    packet.history.push_back(row);
    return packet;
}

std::size_t n_lines(const std::string& text) {
    return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

}  // namespace

TEST_CASE("BackgroundWriter: packets are written once each, in order, and whole") {
    std::vector<double> times;
    bool whole = true;
    BackgroundWriter writer([&](const Packet& packet) {
        times.push_back(packet.history.at(0).time);
        whole = whole && packet.frame.position ==
                             make_sample_frame(2, static_cast<int>(packet.history[0].time)).position;
    });
    std::vector<double> expected;
    for (int i = 0; i < 200; ++i) {
        Packet packet = make_packet(i);
        writer.hand_over(packet);
        expected.push_back(i);
    }
    writer.wait();
    CHECK(times == expected);
    CHECK(whole);
    CHECK(writer.busy_seconds() > 0.0);
}

TEST_CASE("BackgroundWriter: two packets at most, whose memory goes round") {
    std::promise<void> go;
    std::atomic<int> n_written = 0, n_handed_over = 0;
    BackgroundWriter writer([&, gate = go.get_future().share()](const Packet&) {
        gate.wait();
        ++n_written;
    });
    Packet packet = make_packet(0);
    const double* const first = packet.frame.position.data();
    writer.hand_over(packet);
    ++n_handed_over;
    std::thread second([&] {
        packet = make_packet(1);
        writer.hand_over(packet);  // waits: the first is not written yet
        ++n_handed_over;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    CHECK(n_handed_over == 1);
    CHECK(n_written == 0);
    go.set_value();
    second.join();
    CHECK(n_written >= 1);
    CHECK(packet.frame.position.data() == first);
}

TEST_CASE("BackgroundWriter: a failure reaches every later call, and nothing more is written") {
    int n_calls = 0;
    BackgroundWriter writer([&](const Packet& packet) {
        ++n_calls;
        if (packet.history[0].time == 1.0) throw OutputError("disk: cannot write: full");
    });
    Packet packet = make_packet(0);
    writer.hand_over(packet);
    packet = make_packet(1);
    writer.hand_over(packet);
    for (int i = 2; i < 4; ++i) {
        packet = make_packet(i);
        CHECK_THROWS_WITH_AS(writer.hand_over(packet), "disk: cannot write: full", OutputError);
    }
    CHECK_THROWS_AS(writer.wait(), OutputError);
    CHECK(n_calls == 2);
}

TEST_CASE("BackgroundWriter: what was handed over is written before the writer is gone") {
    int n_written = 0;
    {
        BackgroundWriter writer([&](const Packet&) {
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
            ++n_written;
        });
        for (int i = 0; i < 2; ++i) {
            Packet packet = make_packet(i);
            writer.hand_over(packet);
        }
    }
    CHECK(n_written == 2);
}

TEST_CASE("ResultWriter: frames and rows that were added are on disk when it is gone without a finish") {
    const ScratchDirectory scratch;
    constexpr int n_frames = 5, n_rows = 10000;
    {
        ResultWriter writer({.directory = scratch.path("run")});
        Frame frame;
        for (int i = 0; i < n_frames; ++i) {
            for (int k = 0; k < n_rows / n_frames; ++k) writer.add_grain({.time = 1.0 * i, .grain = k});
            frame = make_sample_frame(2, i);
            frame = writer.add_frame(std::move(frame));
        }
        writer.add_history({});
    }
    const FrameFileReader reader(scratch.path("run/results.h5"));
    REQUIRE(reader.n_frames() == n_frames);
    for (std::size_t i = 0; i < n_frames; ++i)
        CHECK(reader.read(i).stress == make_sample_frame(2, static_cast<int>(i)).stress);
    CHECK(n_lines(read_text(scratch.path("run/grains.csv"))) == n_rows + 1);
    CHECK(n_lines(read_text(scratch.path("run/history.csv"))) == 2);
    CHECK(read_text(scratch.path("run/grains.csv")).ends_with("\n4,1999,0,0,0,0,0,0,0,0\n"));
}
