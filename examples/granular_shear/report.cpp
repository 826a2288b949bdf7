// Shear of 369 disks by peridynamic grains and by material points, with and without friction, by contact on
// the grid and between nodes: figures 5 to 8 of Bardenhagen, Brackbill and Sulsky (1998) and the numbers
// behind them.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <thread>

#include "examples/granular_shear/shear_numbers.hpp"
#include "grid/error.hpp"
#include "src/deck/read_deck.hpp"
#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/study/study_run.hpp"

namespace {

using namespace quern;
using granular_shear::measure_shear;
using granular_shear::ShearNumbers;

struct Variant {
    std::string name, label;
    std::vector<std::string> settings;
    bool in_short = false;
};

const std::string points = "params.model=material_points";
const std::vector<Variant> all_variants = {
    {"friction", "peridynamic, friction 0.3", {}, true},
    {"rough", "peridynamic, friction 1", {"params.mu=1"}},
    {"frictionless", "peridynamic, no friction", {"params.mu=0"}, true},
    {"elastic", "peridynamic, elastic, friction 0.3", {"params.yield=1e6 GPa"}},
    {"node_pair", "peridynamic, node pairs, friction 0.3", {"params.method=node_pair"}},
    {"points", "points, friction 0.3", {points}, true},
    {"points_no_slip", "points, no slip", {points, "params.rule=no_slip"}},
    {"points_frictionless", "points, no friction", {points, "params.mu=0"}}};

using Results = std::vector<std::pair<Variant, ShearNumbers>>;

/// Runs what is not done yet, one after the other.
void run_all(const std::vector<Variant>& variants, const std::string& deck,
             const std::vector<std::string>& more, const ReportOptions& options) {
    StudyBase base;
    // The program stands beside this one.
    base.program = (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "quern").string();
    base.deck = deck;
    base.threads =
        options.short_mode ? 1 : static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
    std::vector<StudyRun> runs;
    std::vector<ProcessJob> jobs;
    for (const Variant& variant : variants) {
        StudyRun run{variant.name, options.directory + "/" + variant.name, variant.settings, ""};
        run.overrides.insert(run.overrides.end(), more.begin(), more.end());
        run.hash = deck_hash(read_deck(deck, run.overrides));
        if (!options.short_mode && is_done(run)) continue;
        jobs.push_back(make_job(base, run));
        runs.push_back(run);
    }
    run_processes(jobs, 1, [&](std::size_t job, const ProcessEnd& end) {
        const RunEnd now = end_of(runs[job], end);
        fmt::print("{}: {} in {:.0f} s {}\n", runs[job].name, now.outcome, end.seconds, now.message);
        std::fflush(stdout);
        if (now.outcome != "done") throw SimulationError(runs[job].name + ": " + now.message);
    });
}

/// Without contacts there is no distribution of forces.
std::string number(double value) {
    return std::isnan(value) ? "-" : fmt::format("{:.2f}", value);
}

void print_rows(const Results& runs) {
    fmt::print("\n{:44} {:>20} {:>6} {:>5} {:>13} {:>13} {:>11} {:>5} {:>5} {:>11} {:>8} {:>6}\n", "",
               "work, plastic, rub", "alpha", "outer", "pressure", "traction", "band", "half", "tail",
               "turns, large", "energy", "wall");
    fmt::print("{:44} {:>20} {:>6} {:>5} {:>13} {:>13} {:>11} {:>5} {:>5} {:>11} {:>8} {:>6}\n", "case",
               "[J/m]", "> 0.1", "third", "[MPa] scatter", "[MPa] scatter", "[diameters]", "load", "slope",
               "[rad]", "residual", "[s]");
    for (const auto& [variant, n] : runs)
        fmt::print(
            "{:44} {:6.2f} {:6.2f} {:6.2f} {:6.2f} {:5.2f} {:6.1f} {:6.2f} {:6.1f} {:6.2f} {:5.1f} {:5.1f} "
            "{:5.2f} {:>5} {:5.2f} {:5.2f} {:8.1e} {:6.0f}\n",
            variant.label, n.work, n.plastic, n.friction, n.flowed, n.flowed_third, 1e-6 * n.pressure_mean,
            n.pressure_deviation, 1e-6 * n.traction_mean, n.traction_deviation, n.band, n.band_tenth,
            n.half_load, number(n.tail_slope), n.rotation, n.rotation_large, n.residual, n.wall_seconds);
}

void write_tables(const std::string& directory, const Results& runs) {
    ReportTable table({"work",
                       "plastic",
                       "friction",
                       "contact",
                       "stored",
                       "flowed",
                       "flowed_third",
                       "pressure",
                       "pressure_deviation",
                       "traction",
                       "traction_deviation",
                       "band",
                       "band_tenth",
                       "half_load",
                       "tail_slope",
                       "tail_error",
                       "coordination",
                       "rotation",
                       "rotation_large",
                       "residual",
                       "steps",
                       "wall_seconds",
                       "ns_per_particle_step"});
    ReportTable columns({"x", "at_25", "at_50", "at_75"});
    for (const auto& [variant, n] : runs) {
        table.add(variant.name, {n.work,
                                 n.plastic,
                                 n.friction,
                                 n.contact,
                                 n.stored,
                                 n.flowed,
                                 n.flowed_third,
                                 n.pressure_mean,
                                 n.pressure_deviation,
                                 n.traction_mean,
                                 n.traction_deviation,
                                 n.band,
                                 n.band_tenth,
                                 n.half_load,
                                 n.tail_slope,
                                 n.tail_error,
                                 n.coordination,
                                 n.rotation,
                                 n.rotation_large,
                                 n.residual,
                                 n.steps,
                                 n.wall_seconds,
                                 n.ns_per_particle_step});
        for (std::size_t i = 0; i < n.column.size(); ++i)
            columns.add(variant.name, {n.column[i], n.way[0][i], n.way[1][i], n.way[2][i]});
    }
    table.write(directory, "granular_shear");
    columns.write(directory, "columns");
}

/// Figure 8: displacement of columns against that of even shear.
Chart columns_chart(const Variant& variant, const ShearNumbers& n) {
    Chart chart{variant.label, "x [mm]", "mean vertical displacement [mm]", {}};
    for (std::size_t k = 0; k < n.way.size(); ++k) {
        std::vector<double> x, u;
        for (std::size_t i = 0; i < n.column.size(); ++i) {
            if (std::isnan(n.way[k][i])) continue;
            x.push_back(1e3 * n.column[i]);
            u.push_back(1e3 * n.way[k][i]);
        }
        const int color = static_cast<int>(k);
        chart.lines.push_back({fmt::format("{:.0f} %", 100 * n.shears_shown[k]), x, u, color});
        chart.lines.push_back({"", {0, 1.2}, {0, 1.2 * n.shears_shown[k]}, color, true});
    }
    return chart;
}

/// Means over a hundredth of shear: what one step has is noise of waves.
ChartLine smooth_line(const std::string& label, const std::vector<double>& shear,
                      const std::vector<double>& stress, int color) {
    std::map<int, std::array<double, 3>> bins;
    for (std::size_t i = 0; i < shear.size(); ++i) {
        std::array<double, 3>& bin = bins[static_cast<int>(shear[i] / 0.01)];
        bin[0] += 1;
        bin[1] += shear[i];
        bin[2] += 1e-6 * stress[i];
    }
    ChartLine line{label, {}, {}, color};
    for (const auto& [k, bin] : bins) {
        line.x.push_back(bin[1] / bin[0]);
        line.y.push_back(bin[2] / bin[0]);
    }
    return line;
}

/// Figures 5 to 7 of a run: grains at the start and at 75 %, principal stress difference at 63 and 71 %.
void draw_frames(const std::string& directory, const std::string& name, bool first) {
    const auto draw = [&](const char* what, RenderOptions picture, int frame) {
        picture.directory = directory + "/" + name;
        picture.file = fmt::format("{}/{}_{}_{}.png", directory, name, what, frame);
        picture.frame = std::to_string(frame);
        picture.width = 760;
        picture.height = 520;
        render(picture);
    };
    RenderOptions grains, stress;
    grains.field = "grain";
    stress.field = "principal_difference";
    stress.dark = true;
    stress.low = 0.0;
    stress.high = 0.4e9;
    if (first) draw("grains", grains, 0);
    draw("grains", grains, 75);
    for (const int frame : {63, 71}) draw("stress", stress, frame);
}

void draw_all(const std::string& directory, const Results& runs) {
    std::vector<Chart> columns;
    Chart pressure{"Pressure on the moving edge", "mean shear", "pressure [MPa]", {}};
    Chart traction{"Traction on the moving edge", "mean shear", "traction [MPa]", {}};
    for (const auto& [variant, n] : runs) {
        const int color = static_cast<int>(columns.size());
        columns.push_back(columns_chart(variant, n));
        pressure.lines.push_back(smooth_line(variant.label, n.shear, n.pressure, color));
        traction.lines.push_back(smooth_line("", n.shear, n.traction, color));
        draw_frames(directory, variant.name, color == 0);
    }
    draw_charts(columns, 3, directory + "/columns.png");
    draw_charts({pressure, traction}, 2, directory + "/edge.png");
}

/// Bounds of the energy budget, and what the paper says of friction.
int check(const Results& runs) {
    ReportChecks checks;
    std::map<std::string, ShearNumbers> by_name;
    for (const auto& [variant, n] : runs) {
        by_name[variant.name] = n;
        checks.at_most(variant.label + ": energy residual", n.residual, 2e-2);
    }
    for (const char* name : {"friction", "points"}) {
        const std::string kind = name;
        const ShearNumbers& n = by_name.at(kind);
        const auto ratio = [&](const std::string& other, const std::string& what, double bound, bool more) {
            if (!by_name.contains(other)) return;
            const double to = by_name.at(other).plastic / n.plastic;
            const std::string text = kind + ": plastic work " + what + " over this";
            if (more)
                checks.at_least(text, to, bound);
            else
                checks.at_most(text, to, bound);
        };
        ratio(kind == "points" ? "points_frictionless" : "frictionless", "without friction", 0.9, false);
        ratio("points_no_slip", "without slip", 1.5, true);
        checks.at_least(kind + ": plastic strain in the third next to the moving edge", n.flowed_third, 0.5);
        if (n.shears_shown.back() < 0.7) continue;
        checks.at_least(kind + ": band [mean diameters]", n.band_tenth, 5);
        checks.at_most(kind + ": band [mean diameters]", n.band_tenth, 10);
    }
    return checks.verdict();
}

int body(const ReportOptions& options) {
    std::vector<Variant> variants = all_variants;
    std::vector<std::string> more;
    std::string deck = EXAMPLE_DIR "/shear.yaml";
    if (options.short_mode) {
        std::erase_if(variants, [](const Variant& variant) { return !variant.in_short; });
        deck = EXAMPLE_DIR "/short.yaml";
        more = {"params.shear=0.2", "params.frames=20"};
    }
    run_all(variants, deck, more, options);
    Results runs;
    for (const Variant& variant : variants)
        runs.emplace_back(variant, measure_shear(options.directory + "/" + variant.name));
    print_rows(runs);
    write_tables(options.directory, runs);
    if (!options.short_mode) draw_all(options.directory, runs);
    return check(runs);
}

}  // namespace

int main(int argc, char** argv) {
    return report_main(argc, argv, "granular_shear", body);
}
