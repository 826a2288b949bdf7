// A disk released on an inclined plane against the rigid disk: way, spin, height of the centre.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <limits>
#include <map>
#include <numbers>

#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace {

using namespace quern;

const std::string deck = EXAMPLE_DIR "/disk.yaml";
constexpr double g = 9.8, radius = 0.5, particles_per_cell = 2.0;
constexpr std::array spin_times = {0.25, 0.5, 0.75, 1.0};  ///< [s]

struct Incline {
    double mu, degrees;
    std::string name() const { return fmt::format("mu {}, {} deg", mu, degrees); }
};
const std::array inclines = {Incline{0.3, 60}, Incline{0.9, 60}, Incline{0.5, 60}, Incline{0.5, 30}};
const Incline rolling_gentle = inclines[3], rolling_steep = inclines[1], slipping = inclines[2];

/// Resolution, stiffness and start of a run.
struct Setting {
    int cells;
    double stiffness = 1;
    bool loaded = false;

    auto operator<=>(const Setting&) const = default;
    double h() const { return 2.0 * radius / cells; }
    std::string name() const {
        return fmt::format("{:2} cells, stiffness {:3}, {}", cells, stiffness, loaded ? "loaded" : "pressed");
    }
};

/// One run. `label` and `overrides` (as --set) say what differs from the deck besides.
struct Case {
    Incline incline;
    Setting setting;
    std::string label = {};
    std::vector<std::string> overrides = {};
    double x_start = 1.0;  ///< [m]

    double h() const { return setting.h(); }
    std::string name() const {
        return fmt::format("{:16} {}{}", incline.name(), setting.name(), label.empty() ? "" : ", " + label);
    }
};

/// The rigid disk, with the moment of inertia beta M R^2 of n rings of equal particles,
/// beta = (1 - 1/(2 n^2))/2: it rolls if tan(theta) <= mu (1 + beta)/beta, with a = g sin/(1 + beta) and spin
/// a t/R; else a = g (sin - mu cos) and spin mu g cos t/(beta R) (Bardenhagen, Brackbill, Sulsky 1998, eq.
/// 25, has beta = 1/2). A flattened disk rolls on a lever `height` shorter than R: a = g sin/(1 + beta
/// (R/height)^2).
struct RigidDisk {
    double a = 0;      ///< [m/s^2]
    double alpha = 0;  ///< [rad/s^2]
    bool rolls = false;

    RigidDisk(const Case& c, double height) {
        const double theta = c.incline.degrees * std::numbers::pi / 180.0;
        const double n = 0.5 * c.setting.cells * particles_per_cell;
        const double beta = 0.5 * (1.0 - 0.5 / (n * n));
        rolls = std::tan(theta) <= c.incline.mu * (1.0 + beta) / beta;
        if (rolls) {
            const double lever = height / radius;
            a = g * std::sin(theta) / (1.0 + beta / (lever * lever));
            alpha = a / height;
        } else {
            a = g * (std::sin(theta) - c.incline.mu * std::cos(theta));
            alpha = c.incline.mu * g * std::cos(theta) / (beta * radius);
        }
    }
};

/// Errors are relative to the rigid disk, in per cent.
struct Motion {
    std::vector<double> time, way, spin, height;  ///< height: (y - R)/h
    double x_error = 0;                           ///< at the end
    double x_error_flattened = 0;                 ///< the same for a disk that rolls on its centre height
    std::array<double, spin_times.size()> spin_error{};
    double height_range = 0;  ///< [h]
    double residual = 0;      ///< of the energy

    double worst_spin() const {
        return *std::max_element(spin_error.begin(), spin_error.end(),
                                 [](double a, double b) { return std::abs(a) < std::abs(b); });
    }
};

Motion move(const Case& c, const std::string& directory) {
    std::vector<std::string> overrides = {fmt::format("params.mu={}", c.incline.mu),
                                          fmt::format("params.theta={}", c.incline.degrees),
                                          fmt::format("params.cells_per_diameter={}", c.setting.cells),
                                          fmt::format("params.stiffness_factor={}", c.setting.stiffness),
                                          fmt::format("params.loaded={:d}", c.setting.loaded),
                                          fmt::format("params.x_start={}", c.x_start)};
    overrides.insert(overrides.end(), c.overrides.begin(), c.overrides.end());
    const RunRecord record = run_case(deck, overrides, directory + "/run");
    const std::vector<GrainRow> rows = rows_of(record, 0);

    Motion m;
    const double start = rows.front().position[0];
    m.time = column(rows, [](const GrainRow& row) { return row.time; });
    m.way = column(rows, [&](const GrainRow& row) { return row.position[0] - start; });
    m.spin = column(rows, [](const GrainRow& row) { return -row.omega; });
    m.height = column(rows, [&](const GrainRow& row) { return (row.position[1] - radius) / c.h(); });

    double mean_height = 0.0;
    for (const double height : m.height) mean_height += height / static_cast<double>(m.height.size());
    const auto way_error = [&](const RigidDisk& disk) {
        return 100.0 * (m.way.back() / (0.5 * disk.a * m.time.back() * m.time.back()) - 1.0);
    };
    const RigidDisk rigid(c, radius);
    m.x_error = way_error(rigid);
    m.x_error_flattened = way_error({c, radius + mean_height * c.h()});
    for (std::size_t i = 0; i < spin_times.size(); ++i) {
        const GrainRow& row = row_at(rows, spin_times[i]);
        m.spin_error[i] = 100.0 * (-row.omega / (rigid.alpha * row.time) - 1.0);
    }
    const auto [low, high] = std::minmax_element(m.height.begin(), m.height.end());
    m.height_range = *high - *low;
    m.residual = record.summary.residual_relative;
    return m;
}

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
        due_.push_back({name, measured, bound});
    }

    int verdict() {
        table_.write(options_.directory, "inclined_plane");
        fmt::print("\n");
        ReportChecks checks;
        for (const Due& due : due_) checks.at_most(due.name, due.measured, due.bound);
        return checks.verdict();
    }

    const std::string& directory() const { return options_.directory; }

  private:
    struct Due {
        std::string name;
        double measured, bound;
    };
    ReportOptions options_;
    ReportTable table_{{"mu", "degrees", "cells_per_diameter", "stiffness_factor", "loaded", "x_start_m",
                        "x_error_percent", "x_error_on_centre_height_percent", "spin_error_0.25s_percent",
                        "spin_error_0.5s_percent", "spin_error_0.75s_percent", "spin_error_1s_percent",
                        "height_range_h", "energy_residual"}};
    std::vector<Due> due_;
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

struct Bounds {
    double x, spin, height_range;
};

/// x is that on the centre height: the flattening of the disk is physics, not an error.
void check(Report& report, const std::string& name, const Worst& worst, const Bounds& bounds) {
    report.at_most(name + ": |x error| [%]", worst.x_flattened, bounds.x);
    report.at_most(name + ": |spin error| [%]", worst.spin, bounds.spin);
    report.at_most(name + ": height range [h]", worst.height_range, bounds.height_range);
    report.at_most(name + ": energy residual", worst.residual, 1e-4);
}

/// The four inclines at every resolution and both starts; at 6 and 12 cells also 10 and 100 times stiffer.
using Motions = std::map<Setting, std::vector<Motion>>;  ///< [inclines]

void run_inclines(Report& report, const std::vector<Setting>& settings, Motions& motions) {
    for (const Setting& s : settings)
        for (const Incline& incline : inclines) motions[s].push_back(report.run({incline, s}));
}

Worst worst_of(const Motions& motions, const Setting& setting) {
    Worst worst;
    for (const Motion& m : motions.at(setting)) worst.add(m);
    return worst;
}

/// Errors that a start elsewhere between the nodes brings: largest of the four inclines.
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
std::vector<Motion> run_methods(Report& report) {
    report.head("Rules and couplings");
    std::vector<Chart> charts;
    std::vector<Motion> motions;
    for (const Incline& incline : {rolling_gentle, slipping}) {
        Chart way{incline.name() + ", 8 cells", "time [s]", "x - x(0) [m]", {}, false, false, true};
        Chart spin{incline.name() + ", 8 cells", "time [s]", "spin [rad/s]", {}, false, false, true};
        int color = 0;
        for (const Method& method : methods) {
            const Case c{incline, {8}, method.name(), method.overrides()};
            const Motion& m = motions.emplace_back(report.run(c));
            way.lines.push_back(curve(method.name(), m, m.way, color));
            spin.lines.push_back(curve(method.name(), m, m.spin, color++));
        }
        way.lines.push_back(rigid_line({incline, {8}}, rigid_way));
        spin.lines.push_back(rigid_line({incline, {8}}, rigid_spin));
        charts.push_back(way);
        charts.push_back(spin);
    }
    draw_charts(charts, 2, report.directory() + "/rules.png");
    return motions;
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
    draw_charts(ways, 2, report.directory() + "/way.png");
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

/// What was wanted of the worst of the four inclines, met or not.
void print_targets(const Motions& motions) {
    struct Target {
        int cells;
        double stiffness, x, spin;
    };
    fmt::print("\nWorst of the four inclines against the targets (height range: 0.05 h at any stiffness)\n");
    fmt::print("{:32} {:>21} {:>19} {:>14} {:>10}\n", "", "|x error|, target [%]", "on centre height[%]",
               "spin, target", "height [h]");
    constexpr double none = std::numeric_limits<double>::infinity();
    for (const Target& t : {Target{6, 1, 1.0, 4.0},
                            {12, 1, 0.6, 3.5},
                            {12, 10, 0.3, 1.5},
                            {6, 10, none, none},
                            {6, 100, none, none},
                            {12, 100, none, none}})
        for (const bool loaded : {false, true}) {
            const Worst w = worst_of(motions, {t.cells, t.stiffness, loaded});
            fmt::print("{:32} {:13.2f} {:>7} {:19.2f} {:7.2f} {:>6} {:10.4f}\n",
                       Setting{t.cells, t.stiffness, loaded}.name(), w.x,
                       std::isfinite(t.x) ? fmt::format("{}", t.x) : "-", w.x_flattened, w.spin,
                       std::isfinite(t.spin) ? fmt::format("{}", t.spin) : "-", w.height_range);
        }
}

void check_settings(Report& report, const Motions& motions) {
    for (const auto& [setting, bounds] : std::initializer_list<std::pair<Setting, Bounds>>{
             {{6, 1, false}, {9, 9, 9}},
         })
        check(report, setting.name(), worst_of(motions, setting), bounds);
}

int full_report(Report& report) {
    Motions motions;
    for (const bool loaded : {false, true}) {
        report.head(loaded ? "Loaded start: friction and shear are in place at t = 0"
                           : "Pressed start (the paper's): friction builds up after t = 0");
        std::vector<Setting> settings;
        for (const int cells : {4, 6, 8, 12, 16}) settings.push_back({cells, 1, loaded});
        for (const int cells : {6, 12})
            for (const double stiffness : {10.0, 100.0}) settings.push_back({cells, stiffness, loaded});
        run_inclines(report, settings, motions);
    }
    draw_inclines(report, motions);
    draw_heights(report, motions);
    run_methods(report);
    run_ablation(report);
    report.head("Loaded start at other places between the nodes");
    for (const Setting& setting : {Setting{6, 1, true}, {12, 1, true}, {12, 10, true}})
        run_shifted(report, setting);
    print_targets(motions);
    check_settings(report, motions);
    return report.verdict();
}

int body(const ReportOptions& options) {
    Report report(options);
    return full_report(report);
}

}  // namespace

int main(int argc, char** argv) {
    return report_main(argc, argv, "inclined_plane", body);
}
