// A disk released on an inclined plane against the rigid disk: way, spin, height of the centre.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "examples/inclined_plane/cases.hpp"
#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"

namespace {

using namespace quern;
using namespace quern::incline;

/// Runs cases, prints a line of each, and keeps what is checked at the end.
class Report {
  public:
    explicit Report(const ReportOptions& options) : options_(options) {}

    void head(const std::string& title) const {
        fmt::print("\n{}\n{:64} {:>7} {:>9} {:>31} {:>7} {:>8}\n", title, "", "x(1 s)", "on centre",
                   "spin at 0.25, 0.5, 0.75, 1 s", "height", "energy");
        fmt::print("{:64} {:>7} {:>9} {:>31} {:>7} {:>8}\n", "", "[%]", "height[%]", "[%]", "rng [h]",
                   "residual");
    }

    Motion run(const Case& c) {
        const Motion m = move(c, options_.directory);
        fmt::print("{:64} {:+7.2f} {:>9} {:+7.2f} {:+7.2f} {:+7.2f} {:+7.2f} {:7.4f} {:8.1e}\n", c.name(),
                   m.x_error, RigidDisk(c, radius).rolls ? fmt::format("{:+.2f}", m.x_error_flattened) : "-",
                   m.spin_error[0], m.spin_error[1], m.spin_error[2], m.spin_error[3], m.height_range,
                   m.residual);
        table_.add(c.name(), {c.incline.mu, c.incline.degrees, static_cast<double>(c.setting.cells),
                              c.setting.stiffness, c.setting.loaded ? 1.0 : 0.0, c.x_start, m.x_error,
                              m.x_error_flattened, m.spin_error[0], m.spin_error[1], m.spin_error[2],
                              m.spin_error[3], m.height_range, m.residual});
        return m;
    }

    void at_most(const std::string& name, double measured, double bound) {
        checks_.at_most_later(name, measured, bound);
    }

    int verdict() {
        table_.write(options_.directory, "inclined_plane");
        fmt::print("\n");
        return checks_.verdict();
    }

    const std::string& directory() const { return options_.directory; }

  private:
    ReportOptions options_;
    ReportTable table_{{"mu", "degrees", "cells_per_diameter", "stiffness_factor", "loaded", "x_start_m",
                        "x_error_percent", "x_error_on_centre_height_percent", "spin_error_0.25s_percent",
                        "spin_error_0.5s_percent", "spin_error_0.75s_percent", "spin_error_1s_percent",
                        "height_range_h", "energy_residual"}};
    ReportChecks checks_;
};

/// Largest errors of several runs.
struct Worst {
    double x = 0, x_flattened = 0, spin = 0, height_range = 0, residual = 0;
    void add(const Motion& m) {
        x = std::max(x, std::abs(m.x_error));
        x_flattened = std::max(x_flattened, std::abs(m.x_error_flattened));
        spin = std::max(spin, std::abs(m.worst_spin()));
        height_range = std::max(height_range, m.height_range);
        residual = std::max(residual, m.residual);
    }
};

/// Largest errors that are accepted; x is that on the centre height.
struct Bounds {
    double x, spin, height_range;
};

/// What was wanted of the worst of the four inclines [%]; the height range, at any stiffness, 0.05 h.
struct Target {
    double x = std::nan(""), spin = std::nan("");
};
const std::map<std::pair<int, double>, Target> targets = {
    {{6, 1}, {1.0, 4.0}}, {{12, 1}, {0.6, 3.5}}, {{12, 10}, {0.3, 1.5}}};

/// Runs that share one set of bounds.
struct Group {
    Setting setting;
    std::string label;
    Worst worst;
    Bounds bounds;
    std::string name() const { return setting.name() + label; }
};

void print_targets(const std::vector<Group>& groups) {
    const auto text = [](double number) { return std::isfinite(number) ? fmt::format("{}", number) : "-"; };
    fmt::print("\nWorst of the four inclines against the targets\n");
    fmt::print("{:54} {:>18} {:>14} {:>18} {:>18}\n", "", "|x error|, target", "on centre hgt",
               "|spin|, target", "height rng, target");
    fmt::print("{:54} {:>18} {:>14} {:>18} {:>18}\n", "", "[%]", "[%]", "[%]", "[h]");
    for (const Group& group : groups) {
        const Worst& w = group.worst;
        const auto found = targets.find({group.setting.cells, group.setting.stiffness});
        const Target target = found != targets.end() ? found->second : Target{};
        fmt::print("{:54} {:10.2f} {:>7} {:14.2f} {:10.2f} {:>7} {:10.4f} {:>7}\n", group.name(), w.x,
                   text(target.x), w.x_flattened, w.spin, text(target.spin), w.height_range, "0.05");
    }
}

void check(Report& report, const Group& group) {
    report.at_most(group.name() + ": |x| [%]", group.worst.x_flattened, group.bounds.x);
    report.at_most(group.name() + ": |spin| [%]", group.worst.spin, group.bounds.spin);
    report.at_most(group.name() + ": height [h]", group.worst.height_range, group.bounds.height_range);
    report.at_most(group.name() + ": energy", group.worst.residual, 1e-4);  // measured 7.8e-5, bound 1e-4
}

using Motions = std::map<Setting, std::vector<Motion>>;  ///< [inclines]

void run_inclines(Report& report, const Setting& setting, Motions& motions) {
    for (const Incline& incline : inclines) motions[setting].push_back(report.run({incline, setting}));
}

Worst worst_of(const Motions& motions, const Setting& setting) {
    Worst worst;
    for (const Motion& m : motions.at(setting)) worst.add(m);
    return worst;
}

/// The four inclines from other places between the nodes.
Worst run_shifted(Report& report, const Setting& s) {
    Worst worst;
    for (const Incline& incline : inclines)
        for (const double shift : {0.25, 0.5, 0.75}) {  // [h]
            Case c{incline, s, fmt::format("start + {} h", shift)};
            c.x_start += shift * c.h();
            worst.add(report.run(c));
        }
    return worst;
}

/// The four inclines with bond damping, which ends the vibrations.
Worst run_damped(Report& report, const Setting& s) {
    Worst worst;
    const std::string time = fmt::format("{} ms", 3.0 / s.stiffness);
    for (const Incline& incline : inclines)
        worst.add(
            report.run({incline, s, "bond damping " + time, {"materials.rubber.bond_damping=" + time}}));
    return worst;
}

void run_ablation(Report& report) {
    report.head("What each ingredient of the pair rule is for");
    for (const double stiffness : {1.0, 10.0})
        for (const Incline& incline : {rolling_gentle, slipping}) {
            report.run({incline, {8, stiffness}, "all on"});
            for (const std::string key : {"tile", "curvature", "rotation", "gap_test", "exact_mass"})
                report.run({incline, {8, stiffness}, "no " + key, {"contact." + key + "=false"}});
        }
}

struct Method {
    std::string rule, coupling;
    std::string name() const { return rule + " + " + coupling; }
    std::vector<std::string> overrides() const {
        return {"params.rule=" + rule, "params.coupling=" + coupling};
    }
};
const std::array methods = {Method{"pair", "impulse"}, Method{"pair", "flip"}, Method{"seed", "impulse"},
                            Method{"seed", "flip"}};

/// Rigid solution of one number over the time of a run.
ChartLine rigid_line(const Case& c, double (*value)(const RigidDisk&, double t)) {
    ChartLine line{"rigid", {}, {}, 7, true, false, true};
    const RigidDisk rigid(c, radius);
    for (int i = 0; i <= 40; ++i) {
        line.x.push_back(i / 40.0);
        line.y.push_back(value(rigid, line.x.back()));
    }
    return line;
}
double rigid_way(const RigidDisk& rigid, double t) {
    return 0.5 * rigid.a * t * t;
}
double rigid_spin(const RigidDisk& rigid, double t) {
    return rigid.alpha * t;
}

ChartLine curve(const std::string& label, const Motion& m, const std::vector<double>& y, int color) {
    return {label, m.time, y, color, false, false, true};
}

/// Way and spin with every rule and coupling, on a gentle slope where the disk rolls and a steep one where it
/// slips.
void run_methods(Report& report) {
    report.head("Rules and couplings");
    std::vector<Chart> charts;
    for (const Incline& incline : {rolling_gentle, slipping}) {
        Chart way{incline.name() + ", 8 cells", "time [s]", "x - x(0) [m]", {}, false, false, true};
        Chart spin{incline.name() + ", 8 cells", "time [s]", "spin [rad/s]", {}, false, false, true};
        int color = 0;
        for (const Method& method : methods) {
            const Case c{incline, {8}, method.name(), method.overrides()};
            const Motion m = report.run(c);
            way.lines.push_back(curve(method.name(), m, m.way, color));
            spin.lines.push_back(curve(method.name(), m, m.spin, color++));
        }
        way.lines.push_back(rigid_line({incline, {8}}, rigid_way));
        spin.lines.push_back(rigid_line({incline, {8}}, rigid_spin));
        charts.push_back(way);
        charts.push_back(spin);
    }
    draw_charts(charts, 2, report.directory() + "/rules.png");
}

/// As Figs 2-4 of the paper: pressed start, three resolutions, one chart an incline.
void draw_inclines(const Report& report, const Motions& motions) {
    std::vector<Chart> ways, spins;
    for (std::size_t i = 0; i < inclines.size(); ++i) {
        Chart way{inclines[i].name(), "time [s]", "x - x(0) [m]", {}, false, false, true};
        Chart spin{inclines[i].name(), "time [s]", "spin [rad/s]", {}, false, false, true};
        int color = 0;
        for (const int cells : {4, 8, 16}) {
            const Motion& m = motions.at({cells, 1, false})[i];
            way.lines.push_back(curve(fmt::format("{} cells", cells), m, m.way, color));
            spin.lines.push_back(curve(fmt::format("{} cells", cells), m, m.spin, color++));
        }
        way.lines.push_back(rigid_line({inclines[i], {16}}, rigid_way));
        spin.lines.push_back(rigid_line({inclines[i], {16}}, rigid_spin));
        ways.push_back(way);
        spins.push_back(spin);
    }
    draw_charts(ways, 2, report.directory() + "/x_of_t.png");
    draw_charts(spins, 2, report.directory() + "/spin.png");
}

void draw_heights(const Report& report, const Motions& motions) {
    std::vector<Chart> charts;
    for (const int cells : {6, 12})
        for (const std::size_t i : {std::size_t{1}, std::size_t{3}}) {
            Chart chart{fmt::format("{}, {} cells", inclines[i].name(), cells),
                        "time [s]",
                        "height of the centre, (y - R)/h",
                        {},
                        false,
                        false,
                        true};
            int color = 0;
            for (const double stiffness : {1.0, 10.0, 100.0}) {
                const Motion& m = motions.at({cells, stiffness, false})[i];
                chart.lines.push_back(curve(fmt::format("stiffness {}", stiffness), m, m.height, color++));
            }
            charts.push_back(chart);
        }
    draw_charts(charts, 2, report.directory() + "/height.png");
}

using BoundsOf = std::vector<std::pair<Setting, Bounds>>;

/// Bounds of the worst of the four inclines: x on the centre height [%], spin [%], height range [h].
const BoundsOf bounds = {
    {{4, 1, false}, {0.80, 4.7, 0.024}},     // measured 0.69, 4.12, 0.0211
    {{6, 1, false}, {0.90, 4.3, 0.023}},     // measured 0.76, 3.83, 0.0205
    {{8, 1, false}, {0.90, 5.4, 0.013}},     // measured 0.80, 4.81, 0.0116
    {{12, 1, false}, {1.00, 6.2, 0.013}},    // measured 0.89, 5.51, 0.0113
    {{16, 1, false}, {1.05, 6.3, 0.026}},    // measured 0.92, 5.62, 0.0226
    {{6, 10, false}, {0.30, 2.2, 0.004}},    // measured 0.24, 1.95, 0.0032
    {{12, 10, false}, {0.35, 2.6, 0.011}},   // measured 0.29, 2.28, 0.0091
    {{6, 100, false}, {0.15, 1.0, 0.002}},   // measured 0.09, 0.89, 0.0015
    {{12, 100, false}, {0.15, 0.7, 0.002}},  // measured 0.09, 0.58, 0.0017
    {{4, 1, true}, {0.55, 3.4, 0.022}},      // measured 0.47, 3.03, 0.0195
    {{6, 1, true}, {0.55, 3.7, 0.020}},      // measured 0.45, 3.24, 0.0174
    {{8, 1, true}, {0.30, 3.6, 0.016}},      // measured 0.23, 3.13, 0.0137
    {{12, 1, true}, {0.15, 2.2, 0.014}},     // measured 0.09, 1.92, 0.0119
    {{16, 1, true}, {0.35, 1.6, 0.018}},     // measured 0.31, 1.36, 0.0158
    {{6, 10, true}, {0.20, 1.3, 0.004}},     // measured 0.14, 1.11, 0.0032
    {{12, 10, true}, {0.15, 1.2, 0.011}},    // measured 0.09, 1.04, 0.0098
    {{6, 100, true}, {0.10, 1.1, 0.002}},    // measured 0.08, 0.91, 0.0012
    {{12, 100, true}, {0.10, 1.1, 0.002}},   // measured 0.07, 0.95, 0.0014
};
const BoundsOf shifted_bounds = {
    {{6, 1, true}, {1.00, 8.9, 0.024}},    // measured 0.89, 7.90, 0.0208
    {{12, 1, true}, {0.50, 4.6, 0.021}},   // measured 0.43, 4.10, 0.0182
    {{12, 10, true}, {0.30, 2.5, 0.012}},  // measured 0.23, 2.20, 0.0102
};
const BoundsOf damped_bounds = {
    {{6, 1, true}, {0.20, 1.6, 0.010}},    // measured 0.17, 1.42, 0.0081
    {{12, 1, true}, {0.60, 2.2, 0.012}},   // measured 0.53, 1.90, 0.0105
    {{12, 10, true}, {0.10, 0.9, 0.008}},  // measured 0.05, 0.77, 0.0066
};

int full_report(Report& report) {
    Motions motions;
    std::vector<Group> groups;
    for (const bool loaded : {false, true}) {
        report.head(loaded ? "Loaded start: friction and shear are in place at t = 0"
                           : "Pressed start (the paper's): friction builds up after t = 0");
        for (const auto& [setting, bound] : bounds)
            if (setting.loaded == loaded) {
                run_inclines(report, setting, motions);
                groups.push_back({setting, "", worst_of(motions, setting), bound});
            }
    }
    draw_inclines(report, motions);
    draw_heights(report, motions);
    report.head("Loaded start at other places between the nodes");
    for (const auto& [setting, bound] : shifted_bounds)
        groups.push_back({setting, ", other starts", run_shifted(report, setting), bound});
    report.head("Loaded start with bond damping, which ends the vibrations");
    for (const auto& [setting, bound] : damped_bounds)
        groups.push_back({setting, ", damped", run_damped(report, setting), bound});
    run_methods(report);
    run_ablation(report);
    print_targets(groups);
    for (const Group& group : groups) check(report, group);
    return report.verdict();
}

/// Both starts, the stiff disk that must not hop, and the seed rule that must be told apart.
int short_report(Report& report) {
    report.head("Short version");
    Motions motions;
    for (const auto& [setting, bound] : bounds)
        if (setting.cells == 6 && setting.stiffness != 10.0) {
            run_inclines(report, setting, motions);
            check(report, {setting, "", worst_of(motions, setting), bound});
        }
    const Method seed{"seed", "impulse"};
    const Motion m = report.run({rolling_gentle, {6}, seed.name(), seed.overrides()});
    report.at_most("seed + impulse loses rolling: x error [%]", m.x_error, -50.0);  // measured -55, bound -50
    return report.verdict();
}

int body(const ReportOptions& options) {
    Report report(options);
    return options.short_mode ? short_report(report) : full_report(report);
}

}  // namespace

int main(int argc, char** argv) {
    return report_main(argc, argv, "inclined_plane", body);
}
