#include "src/pack/pack.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cstdio>
#include <filesystem>

#include "grid/error.hpp"
#include "src/pack/measure.hpp"
#include "src/pack/packing_files.hpp"
#include "src/results/output_file.hpp"
#include "src/results/progress.hpp"

namespace quern {
namespace {

/// A line on standard error: on a terminal rewritten five times a second, else one in ten seconds.
class ProgressLine {
  public:
    explicit ProgressLine(bool terminal) : terminal_(terminal) {}

    void update(double done, double fraction, double deepest) {
        const double now = seconds();
        if (now - shown_ < (terminal_ ? 0.2 : 10.0)) return;
        shown_ = now;
        // The rounds that are left are an upper bound: most packings need few of them.
        const double left = done > 0.0 ? now * (1.0 - done) / done : -1.0;
        const std::string line =
            fmt::format("{:5.1f} %  grains of {:.4f} of the region  deepest overlap {:.1e}  at most {} left",
                        100.0 * done, fraction, deepest, make_duration(left));
        if (terminal_)
            fmt::print(stderr, "\r{}\x1b[K", line);
        else
            fmt::print(stderr, "{}\n", line);
        std::fflush(stderr);
        any_ = true;
    }
    void finish() const {
        if (terminal_ && any_) fmt::print(stderr, "\n");
    }

  private:
    using Clock = std::chrono::steady_clock;
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

    bool terminal_, any_ = false;
    double shown_ = 0.0;
    Clock::time_point start_ = Clock::now();
};

std::string beside(const std::string& file, const char* extension) {
    return std::filesystem::path(file).replace_extension(extension).string();
}

}  // namespace

PackReport pack(const PackOptions& options) {
    const PackSpec spec = read_pack_spec(options.spec, options.overrides);
    if (std::filesystem::path(options.output).extension() != ".csv")
        throw InputError("-o", "'" + options.output + "'", "a name that ends in .csv");
    ProgressLine line(options.terminal);
    const Packing packing = make_packing(
        spec, [&](double done, double fraction, double deepest) { line.update(done, fraction, deepest); });
    line.finish();
    const PackingReport found{deepest_overlap(packing.grains), coordination(packing.grains),
                              find_groups(packing.grains, spec.edges)};
    PackReport report{
        .n_grains = packing.grains.n(),
        .rounds = packing.rounds,
        .fraction = packing.fraction,
        .deepest = found.deepest,
        .coordination = found.coordination,
        .size_factor = packing.size_factor,
        .files = {options.output, beside(options.output, ".json"), beside(options.output, ".png")}};
    const std::string folder = std::filesystem::path(options.output).parent_path().string();
    if (!folder.empty()) create_directory(folder);
    write_whole_file(report.files[0], packing_csv(spec, packing, found));
    write_whole_file(report.files[1], packing_json(spec, packing, found));
    draw_packing(spec, packing, found, report.files[2]);
    if (!packing.reached)
        throw SimulationError(fmt::format(
            "solid fraction {:.4f} reached, {:.4f} asked for, after {} rounds; the packing of {:.4f} "
            "is kept in {} (more rounds, wider sizes or a lower solid_fraction)",
            packing.fraction, packing.asked, packing.rounds, packing.fraction, options.output));
    return report;
}

}  // namespace quern
