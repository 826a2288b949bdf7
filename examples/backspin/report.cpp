// A disk thrown along a plane with backspin: when it stops to slip, and how fast it rolls then.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace {

using namespace quern;

const std::string deck = EXAMPLE_DIR "/backspin.yaml";
constexpr double g = 9.8, mu = 0.3, radius = 0.5;
constexpr int particles_per_cell = 2;

struct Case {
    double speed = 2, spin = 4;  ///< [m/s], [rad/s]: backspin is positive
    std::string label = "as in the deck";
    std::vector<std::string> overrides = {};  ///< of params
    int cells = 12;                           ///< per diameter

    /// Moment of inertia over M R^2, of rings of particles.
    double beta() const {
        const double rings = 0.5 * cells * particles_per_cell;
        return 0.5 * (1.0 - 1.0 / (2.0 * rings * rings));
    }
    /// Of the foot, at the start.
    double slip() const { return speed + spin * radius; }
    /// Rolling after friction has taken v0 - v_f from the speed and (v0 - v_f)/(beta R) from the spin.
    double final_speed() const { return (speed - beta() * spin * radius) / (1.0 + beta()); }
    double slip_time() const { return std::abs(speed - final_speed()) / (mu * g); }
    double end() const { return slip_time() + 0.6; }
    std::string name() const { return fmt::format("v {} w {}, {}", speed, spin, label); }
};

struct Throw {
    double final_speed = 0, slip_time = 0;
    double rolling_radius = 0;  ///< v / omega at the end, over R
    double friction = 0;        ///< deceleration while slipping over mu g
    double height = 0;          ///< of the rolling centre over R
    double residual = 0;
    std::vector<double> time, speed, rim;  ///< rim: -omega R
};

/// Slope and value at t = 0 of y over t, of the rows with t in (from, to); least squares.
struct Fit {
    double slope = 0, start = 0;
};
template <class Value>
Fit fit(const std::vector<GrainRow>& rows, double from, double to, Value value) {
    double n = 0, t = 0, y = 0, tt = 0, ty = 0;
    for (const GrainRow& row : rows) {
        if (row.time <= from || row.time >= to) continue;
        n += 1;
        t += row.time;
        y += value(row);
        tt += row.time * row.time;
        ty += row.time * value(row);
    }
    const double slope = (n * ty - t * y) / (n * tt - t * t);
    return {slope, (y - slope * t) / n};
}

double x_of(const GrainRow& row) {
    return row.position[0];
}
double speed_of(const GrainRow& row) {
    return row.velocity[0];
}
double angle_of(const GrainRow& row) {
    return row.angle;
}

Throw throw_disk(const Case& c, const std::string& directory) {
    std::vector<std::string> overrides = {
        fmt::format("params.speed={}", c.speed), fmt::format("params.spin={}", c.spin),
        fmt::format("params.cells_per_diameter={}", c.cells), fmt::format("params.t_end={}", c.end())};
    for (const std::string& item : c.overrides) overrides.push_back("params." + item);
    const RunRecord record = run_case(deck, overrides, directory + "/run");
    const std::vector<GrainRow> rows = rows_of(record, 0);
    const double end = rows.back().time, rolls = c.slip_time() + 0.15;
    const Fit slipping = fit(rows, 0.1 * c.slip_time(), 0.9 * c.slip_time(), speed_of);
    Throw t;
    t.final_speed = fit(rows, rolls, end, x_of).slope;
    t.slip_time = (t.final_speed - slipping.start) / slipping.slope;
    t.rolling_radius = -t.final_speed / fit(rows, rolls, end, angle_of).slope / radius;
    t.friction = std::abs(slipping.slope) / (mu * g);
    t.height = rows.back().position[1] / radius;
    t.residual = record.summary.residual_relative;
    t.time = column(rows, [](const GrainRow& row) { return row.time; });
    t.speed = column(rows, speed_of);
    t.rim = column(rows, [](const GrainRow& row) { return -row.omega * radius; });
    return t;
}

/// Bounds of a case, relative: of v_f in units of v_f, or of v0 - v_f where the disk should stop; of t_s.
struct Bounds {
    double final_speed, slip_time;
};

class Report {
  public:
    explicit Report(const ReportOptions& options) : options_(options) {
        fmt::print("{:38} {:>8} {:>8} {:>9} {:>9} {:>7} {:>7} {:>8} {:>9} {:>9} {:>8}\n", "case", "v_f",
                   "v_f exact", "error/v_f", "/(v0-v_f)", "t_s", "exact", "error", "a/(mu g)", "v/(w R)",
                   "y/R");
        fmt::print("{:38} {:>8} {:>9} {:>9} {:>9} {:>7} {:>7} {:>8} {:>9} {:>9}\n", "", "[m/s]", "[m/s]",
                   "[%]", "[%]", "[s]", "[s]", "[%]", "-1 [%]", "-1 [%]");
    }

    Throw run(const Case& c) {
        const Throw t = throw_disk(c, options_.directory);
        const double error = t.final_speed - c.final_speed();
        fmt::print(
            "{:38} {:+8.4f} {:+9.4f} {:+9.2f} {:+9.2f} {:7.4f} {:7.4f} {:+8.2f} {:+9.2f} {:+9.2f} {:8.4f}\n",
            c.name(), t.final_speed, c.final_speed(), 100.0 * error / std::abs(c.final_speed()),
            100.0 * error / std::abs(c.speed - c.final_speed()), t.slip_time, c.slip_time(),
            100.0 * (t.slip_time / c.slip_time() - 1.0), 100.0 * (t.friction - 1.0),
            100.0 * (t.rolling_radius - 1.0), t.height);
        table_.add(c.name(), {c.speed, c.spin, t.final_speed, c.final_speed(), t.slip_time, c.slip_time(),
                              t.friction, t.rolling_radius, t.height, t.residual});
        worst_residual_ = std::max(worst_residual_, t.residual);
        return t;
    }

    /// Runs a case whose numbers are checked at the end.
    Throw check(const Case& c, const Bounds& bounds) {
        const Throw t = run(c);
        const double change = std::abs(c.speed - c.final_speed());
        const bool stops = std::abs(c.final_speed()) < 0.01 * change;
        checks_.at_most_later(
            c.name() + (stops ? ": error of v_f over v0 - v_f" : ": error of v_f"),
            std::abs(t.final_speed - c.final_speed()) / (stops ? change : std::abs(c.final_speed())),
            bounds.final_speed);
        checks_.at_most_later(c.name() + ": error of t_s", std::abs(t.slip_time / c.slip_time() - 1.0),
                              bounds.slip_time);
        return t;
    }

    int verdict() {
        table_.write(options_.directory, "backspin");
        fmt::print("\n");
        checks_.at_most_later("energy residual, largest of all", worst_residual_, 1e-3);
        return checks_.verdict();
    }

  private:
    ReportOptions options_;
    ReportTable table_{{"v0", "w0", "v_f", "v_f_exact", "t_s", "t_s_exact", "deceleration_over_mu_g",
                        "rolling_radius_over_R", "height_over_R", "energy_residual"}};
    ReportChecks checks_;
    double worst_residual_ = 0;
};

/// Points: every twentieth row.
ChartLine points(const std::string& label, const Throw& t, const std::vector<double>& values, int color) {
    ChartLine line{label, {}, {}, color, false, true, false};
    for (std::size_t i = 0; i < values.size(); i += 20) {
        line.x.push_back(t.time[i]);
        line.y.push_back(values[i]);
    }
    return line;
}

/// Speed and rim speed over time: straight while the foot slips, then one.
Chart speed_chart(const Case& c, const Throw& t) {
    const double v_f = c.final_speed(), t_s = c.slip_time(), end = t.time.back();
    Chart chart{fmt::format("v0 = {} m/s, w0 = {} rad/s", c.speed, c.spin), "time [s]", "speed [m/s]", {}};
    chart.lines = {{"closed form", {0.0, t_s, end}, {c.speed, v_f, v_f}, 2, false, false, true},
                   {"", {0.0, t_s}, {-c.spin * radius, v_f}, 2, false, false, true},
                   points("centre, v", t, t.speed, 0),
                   points("rim, -w R", t, t.rim, 1)};
    return chart;
}

/// Softer, finer, undamped, with other rules: shown, not checked, but for the energy residual.
void run_variants(Report& report) {
    for (const double spin : {4.0, 12.0}) {
        for (const int factor : {1, 10})
            report.run({2,
                        spin,
                        fmt::format("stiffness x{}", factor),
                        {fmt::format("stiffness_factor={}", factor)}});
        report.run({2, spin, "undamped", {"bond_damping=0"}});
        report.run({2, spin, "undamped, x10, 24 cells", {"bond_damping=0", "stiffness_factor=10"}, 24});
    }
    report.run({2, 4, "6 cells per diameter", {}, 6});
    for (const std::string rule : {"pair", "seed"})
        report.run({2, 4, rule + "/flip, x10", {"rule=" + rule, "coupling=flip", "stiffness_factor=10"}});
}

int body(const ReportOptions& options) {
    Report report(options);
    const Case forwards{2, 4}, back{1, 6};
    const Bounds forwards_bounds{0.001, 0.001};  // measured 0.0006 and 0.0003
    if (options.short_mode) {
        report.check(forwards, forwards_bounds);
        return report.verdict();
    }
    std::vector<Chart> charts;
    charts.push_back(speed_chart(forwards, report.check(forwards, forwards_bounds)));
    charts.push_back(speed_chart(back, report.check(back, {0.008, 0.002})));  // measured 0.0054 and 0.0014
    report.check({2, 0}, {0.001, 0.001});                                     // measured 0.0003 and 0.0006
    report.check({1, -6}, {0.001, 0.001});  // topspin; measured 0.0003 and 0.0006
    report.check({2, 8}, {0.001, 0.001});   // stops; measured 0.0006 and 0.0006
    run_variants(report);
    draw_charts(charts, 2, options.directory + "/backspin.png");
    return report.verdict();
}

}  // namespace

int main(int argc, char** argv) {
    return report_main(argc, argv, "backspin", body);
}
