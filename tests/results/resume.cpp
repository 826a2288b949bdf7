#include <doctest/doctest.h>

#include <filesystem>
#include <optional>

#include "grid/error.hpp"
#include "src/results/frame_file.hpp"
#include "src/results/writer.hpp"
#include "tests/results/samples.hpp"

using namespace quern;

namespace {

void add(ResultWriter& writer, int dimension, int first, int last) {
    for (int i = first; i < last; ++i) {
        HistoryRow row;
        row.time = 0.1 * i;
        writer.add_history(row);
        GrainRow grain;
        grain.time = 0.1 * i;
        writer.add_grain(grain);
        writer.add_reaction({.time = 0.1 * i, .name = "wall"});
        writer.add_frame(make_sample_frame(dimension, i));
    }
}

WriterOptions options(const std::string& directory, int dimension) {
    return {.directory = directory, .dimension = dimension, .vtp = true};
}

constexpr int n_frames = 6;

void require_equal(const std::string& resumed, const std::string& whole, int dimension) {
    for (const char* name : {"history.csv", "grains.csv", "reactions.csv", "results.xdmf", "results.pvd"})
        CHECK(read_text(resumed + "/" + name) == read_text(whole + "/" + name));
    const FrameFileReader a(resumed + "/results.h5"), b(whole + "/results.h5");
    REQUIRE(a.n_frames() == n_frames);
    for (std::size_t i = 0; i < n_frames; ++i) {
        CHECK(a.read(i).position == b.read(i).position);
        CHECK(a.read(i).stress == b.read(i).stress);
        CHECK(a.read(i).step == make_sample_frame(dimension, static_cast<int>(i)).step);
    }
    CHECK(a.title() == b.title());
    std::size_t n_vtp = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(resumed + "/frames"))
        ++n_vtp;
    CHECK(n_vtp == n_frames);
}

}  // namespace

TEST_CASE("ResultWriter: a run that goes on leaves the files of one that was never stopped") {
    for (const int dimension : {2, 3})
        for (const int kept : {0, 1, 3, n_frames}) {
            CAPTURE(dimension);
            CAPTURE(kept);
            const ScratchDirectory whole, resumed;
            {
                ResultWriter writer(options(whole.path(), dimension));
                add(writer, dimension, 0, n_frames);
                writer.finish({});
            }
            std::optional<ResultPosition> position;
            {
                ResultWriter writer(options(resumed.path(), dimension));
                add(writer, dimension, 0, kept);
                position = writer.position();
                add(writer, dimension, kept, n_frames + 2);  // what a killed run did after its checkpoint
            }
            WriterOptions again = options(resumed.path(), dimension);
            again.resumed = position;
            ResultWriter writer(again);
            writer.log("goes on");
            add(writer, dimension, kept, n_frames);
            writer.finish({});
            require_equal(resumed.path(), whole.path(), dimension);
            CHECK(read_text(resumed.path("run.log")) == "goes on\n");
        }
}

TEST_CASE("ResultWriter: files shorter than at the checkpoint are refused by name") {
    const ScratchDirectory scratch;
    WriterOptions again = options(scratch.path(), 2);
    {
        ResultWriter writer(again);
        add(writer, 2, 0, 2);
        again.resumed = writer.position();
    }
    again.resumed->n_frames = 3;
    CHECK_THROWS_WITH_AS(ResultWriter{again}, doctest::Contains("results.h5: got 2 frames in 2D"),
                         InputError);
    again.resumed->n_frames = 2;
    again.resumed->history_bytes += 1;
    CHECK_THROWS_WITH_AS(ResultWriter{again}, doctest::Contains("history.csv: got "), InputError);
}
