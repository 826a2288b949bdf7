// A disk pressed between platens against a strip pulled apart: P = pi D sigma_t/2, and a crack along the
// diameter.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "src/results/frame_file.hpp"
#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace {

using namespace quern;

const std::string folder = EXAMPLE_DIR;
constexpr double diameter = 0.06, speed = 0.1, rise = 200e-6;  ///< of the decks [m], [m/s], [s]

/// Way of one platen or end [m].
double way(double time) {
    return speed * (time < rise ? 0.5 * time * time / rise : time - 0.5 * rise);
}

struct Test {
    double peak = 0.0;  ///< force on a platen or end, mean of both [N/m]
    double residual = 0.0;
    std::vector<double> moved, force;  ///< [m], [N/m]
};

/// Work of both ends over their way.
Test run_test(const std::string& deck, const std::vector<std::string>& overrides,
              const std::string& directory) {
    std::vector<std::string> all;
    for (const std::string& item : overrides) all.push_back("params." + item);
    const RunRecord run = run_case(folder + "/" + deck, all, directory);
    Test test;
    test.residual = run.summary.residual_relative;
    const std::vector<HistoryRow>& rows = run.history;
    for (std::size_t k = 2; k + 2 < rows.size(); ++k) {
        const double moved = way(rows[k + 2].time) - way(rows[k - 2].time);
        const double work = rows[k + 2].energy.external_work - rows[k - 2].energy.external_work;
        test.moved.push_back(way(rows[k].time));
        test.force.push_back(0.5 * work / moved);
        test.peak = std::max(test.peak, test.force.back());
    }
    return test;
}

/// Part of the damage within a sixth of the diameter from the loaded one.
double damage_on_diameter(const std::string& directory) {
    const FrameFileReader file(directory + "/results.h5");
    const Frame start = file.read(0);
    for (std::size_t f = 1; f < file.n_frames(); ++f) {
        const Frame frame = file.read(f);
        double all = 0.0, near = 0.0;
        for (std::size_t p = 0; p < frame.n(); ++p) {
            all += frame.damage[p];
            if (std::abs(start.position[2 * p]) < diameter / 6.0) near += frame.damage[p];
        }
        if (all > 0.0) return near / all;  // of the first frame with a crack
    }
    return 0.0;
}

struct Case {
    std::string label;
    double nu = 0.0;
    std::vector<std::string> overrides = {};
    bool checked = true;  ///< else shown only
};

int body(const ReportOptions& options) {
    std::vector<Case> cases = {{"nu 0"}};
    if (!options.short_mode) {
        cases.push_back({"nu 0.25", 0.25, {"nu=0.25"}, false});
        for (const double nu : {0.0, 0.25, 0.4})
            cases.push_back(
                {fmt::format("nu {}, by energy", nu), nu, {fmt::format("nu={}", nu), "by=energy"}, false});
    }
    ReportTable table({"nu", "sigma_t", "peak", "ratio", "ratio_of_strains", "on_diameter"});
    ReportChecks checks;
    Chart chart{"Force on the disk", "way of a platen [um]", "2 P/(pi D sigma_t)", {}};
    for (const Case& c : cases) {
        const std::string directory = options.directory + "/disk";
        const Test strip = run_test("strip.yaml", c.overrides, options.directory + "/strip");
        const Test disk = run_test("disk.yaml", c.overrides, directory);
        const double strength = strip.peak / 0.03;
        const double ratio = disk.peak / (0.5 * std::numbers::pi * diameter * strength);
        // In the middle of the disk sigma_y = -3 sigma_x; strains add up across.
        const double plane = c.nu / (1.0 - c.nu), expected = 1.0 / (1.0 + 3.0 * plane);
        const double on_diameter = damage_on_diameter(directory);
        fmt::print(
            "{}: sigma_t {:.2f} MPa, 2 P/(pi D sigma_t) = {:.3f}, by the largest strain {:.3f}; {:.0f} % of "
            "the "
            "first damage near the diameter\n",
            c.label, 1e-6 * strength, ratio, expected, 100.0 * on_diameter);
        table.add(c.label, {c.nu, strength, disk.peak, ratio, expected, on_diameter});
        ChartLine line{c.label, {}, {}, static_cast<int>(chart.lines.size())};
        for (std::size_t k = 0; k < disk.moved.size(); ++k) {
            line.x.push_back(1e6 * disk.moved[k]);
            line.y.push_back(disk.force[k] / (0.5 * std::numbers::pi * diameter * strength));
        }
        chart.lines.push_back(line);
        checks.at_most(c.label + ": energy residual", std::max(strip.residual, disk.residual), 1e-3);
        checks.at_least(c.label + ": first damage near the loaded diameter", on_diameter, 0.9);
        if (!c.checked) continue;
        checks.at_least(c.label + ": 2 P/(pi D sigma_t)", ratio, 0.9);
        checks.at_most(c.label + ": 2 P/(pi D sigma_t)", ratio, 1.1);
        render({directory, options.directory + "/damage.png", "damage"});
    }
    draw_charts({chart}, 1, options.directory + "/force.png");
    table.write(options.directory, "brazilian_disk");
    return checks.verdict();
}

}  // namespace

int main(int argc, char** argv) {
    return quern::report_main(argc, argv, "brazilian_disk", body);
}
