// Spheres: rolling down a plane, hitting a wall, hitting each other, and the same bits for any number of
// threads.
#include "examples/spheres/collisions.hpp"
#include "examples/spheres/rolling.hpp"
#include "examples/spheres/wall.hpp"

namespace quern::spheres {
namespace {

/// The same collision on 1, 2 and 3 threads: hashes of the final state that differ from the first.
void report_threads(Report& report) {
    const Deck deck = read_deck(folder + "/collision.yaml", {override_of("mu", 0.3)});
    std::vector<std::string> hashes;
    for (const int threads : {1, 2, 3}) {
        RunRecord record;
        RunOptions options;
        options.directory = report.options.directory + "/threads";
        options.threads = threads;
        run_deck(deck, options, &record);
        hashes.push_back(record.summary.state_hash);
    }
    fmt::print("\nState after the collision, 1, 2, 3 threads: {}\n", fmt::join(hashes, " "));
    const auto others = std::count_if(hashes.begin(), hashes.end(),
                                      [&](const std::string& hash) { return hash != hashes[0]; });
    report.checks.at_most("states that differ from that of one thread", static_cast<double>(others), 0.0);
}

int body(const ReportOptions& options) {
    Report report{options, {}};
    report_rolling(report);
    report_wall(report);
    report_collisions(report);
    report_threads(report);
    fmt::print("\nMomenta, all runs\n");
    report.checks.at_most("linear momentum, relative error", report.linear_error, 1e-12);
    report.checks.at_most("angular momentum, relative error", report.angular_error, 1e-12);
    report.checks.at_most("energy residual, all runs and rules", report.energy_residual, 1e-3);
    return report.checks.verdict();
}

}  // namespace
}  // namespace quern::spheres

int main(int argc, char** argv) {
    return quern::report_main(argc, argv, "spheres", quern::spheres::body);
}
