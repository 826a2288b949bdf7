// Ways of contact side by side on five decks, each under refinement: one folder a deck with tables and
// charts.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "examples/comparison/summary.hpp"
#include "src/deck/tree.hpp"
#include "src/sim/report.hpp"
#include "src/study/compare.hpp"

namespace {

using namespace quern;

const std::string examples = EXAMPLE_DIR "/../";

struct Case {
    std::string name, deck, reference;  ///< "": the first variant
    std::vector<std::string> settings;
    std::string over, over_short;
    std::vector<std::string> settings_short = settings;
    int n_repeats = 3;  ///< in the full version
    /// Error of the momenta by `pair`. Held grains count a million times their mass, so six digits less.
    double linear = 1e-12, angular = 1e-10;
};

const std::vector<Case> cases = {
    {"inclined_plane",
     "inclined_plane/disk.yaml",
     EXAMPLE_DIR "/rolling.csv",
     {},
     "params.cells_per_diameter=6,12,24",
     "params.cells_per_diameter=4,8"},
    {"two_disks",
     "two_disks/collision.yaml",
     "",
     {"params.gap=0.1", "params.t_end=0.18", "params.offset=0.7", "params.angle=20"},
     "params.cells_per_radius=3,6,12",
     "params.cells_per_radius=3,6"},
    {"backspin",
     "backspin/backspin.yaml",
     EXAMPLE_DIR "/backspin.csv",
     {"params.stiffness_factor=10"},
     "params.cells_per_diameter=6,12,24",
     "params.cells_per_diameter=4,8",
     {"params.stiffness_factor=10", "params.t_end=0.3"}},
    {"blocks",
     "comparison/blocks.yaml",
     EXAMPLE_DIR "/blocks.csv",
     {},
     "params.cells_per_height=2,4,8",
     "params.cells_per_height=2,3",
     {"params.t_end=0.1", "contact.tolerance=1e-3"},
     1},
    {"corner",
     "comparison/corner.yaml",
     "",
     {},
     "params.cells_per_height=4,8,16",
     "params.cells_per_height=3,4",
     {"params.t_end=0.2"},
     1,
     1e-9,
     1e-9},
    {"settling",
     "settling/settling.yaml",
     "",
     {"params.columns=20", "params.rows=10", "params.t_end=1.5"},
     "params.cells_per_radius=1,1.5,2",
     "params.cells_per_radius=1,2",
     {"params.columns=4", "params.rows=3", "params.t_end=0.4"},
     1},
    {"two_spheres",
     "spheres/collision.yaml",
     "",
     {"params.gap=0.1", "params.t_end=0.15"},
     "params.cells_per_radius=2,3,4",
     "params.cells_per_radius=1.5,2",
     {"params.gap=0.1", "params.t_end=0.12"}}};

/// The numbers that hold for any contact that is worth comparing.
void check(const Case& c, const std::string& directory, ReportChecks& checks) {
    const Node json = read_tree(directory + "/comparison.json");
    double n_failed = 0, linear = 0, angular = 0, changed = 0;
    for (const Node& run : json.find("runs")->items) {
        n_failed += run.find("outcome")->text == "done" ? 0 : 1;
        changed += run.find("same_bits")->text == "true" ? 0 : 1;
        if (run.find("variant")->text != "pair") continue;
        linear = std::max(linear, std::stod(run.find("quantities")->find("momentum_error.linear")->text));
        angular = std::max(angular, std::stod(run.find("quantities")->find("momentum_error.angular")->text));
    }
    checks.at_most(c.name + ": runs that failed", n_failed, 0);
    checks.at_most(c.name + ": repeats with other bits", changed, 0);
    checks.at_most(c.name + ", pair: error of the linear momentum", linear, c.linear);
    checks.at_most(c.name + ", pair: error of the angular momentum", angular, c.angular);
}

int body(const ReportOptions& options) {
    ReportChecks checks;
    for (const Case& c : cases) {
        CompareOptions compare_options;
        // The program stands beside this one.
        compare_options.base.program =
            (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "quern").string();
        compare_options.base.deck = std::filesystem::path(examples + c.deck).lexically_normal().string();
        compare_options.directory = options.directory + "/" + c.name;
        compare_options.variants = {"default", "seed_flip: contact.rule=seed, contact.coupling=flip"};
        compare_options.reference = c.reference;
        compare_options.settings = options.short_mode ? c.settings_short : c.settings;
        compare_options.over = options.short_mode ? c.over_short : c.over;
        compare_options.reuse = !options.short_mode;  // a long one goes on where it was stopped
        compare_options.n_repeats = options.short_mode ? 1 : c.n_repeats;
        fmt::print("\n{}\n", c.name);
        compare(compare_options);
        check(c, compare_options.directory, checks);
    }
    write_summary(options.directory);
    return checks.verdict();
}

}  // namespace

int main(int argc, char** argv) {
    return report_main(argc, argv, "comparison", body);
}
