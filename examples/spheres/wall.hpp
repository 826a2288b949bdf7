// A sphere on a rigid wall: restitution, duration and peak force against finite elements.
#pragma once

#include "examples/spheres/cases.hpp"

namespace quern::spheres {

/// Converged finite elements, nu = 0.25, rigid frictionless wall.
struct Reference {
    double speed;                        ///< over c0
    double restitution, duration, peak;  ///< duration in R/c0, peak force in E* R^2
    double patch;                        ///< largest contact radius over R, by Hertz
};
inline const Reference slow{0.001, 0.9998, 19.27, 7.53e-4, 0.0827},
    fast{0.01, 0.9986, 11.67, 1.272e-2, 0.212};

struct WallCase {
    Reference reference;
    std::string filling;
    int cells;  ///< per radius
    int particles_per_cell = 1;
    std::vector<std::string> more = {};  ///< overrides
};

struct Impact {
    double restitution = 0, duration = 0, peak = 0, loss = 0;
    std::vector<double> time, force;  ///< in R/c0, E* R^2

    double duration_error(const Reference& reference) const {
        return 100.0 * (duration / reference.duration - 1.0);
    }
    double peak_error(const Reference& reference) const { return 100.0 * (peak / reference.peak - 1.0); }
};

inline double size_of(const double (&v)[3]) {
    return std::hypot(v[0], v[1], v[2]);
}

inline Impact hit_wall(Report& report, const WallCase& c, const std::string& directory = "wall") {
    std::vector<std::string> overrides = {
        override_of("speed", c.reference.speed), override_of("cells_per_radius", c.cells),
        override_of("particles_per_cell", c.particles_per_cell), "params.filling=" + c.filling};
    overrides.insert(overrides.end(), c.more.begin(), c.more.end());
    const RunRecord record = report.run("/wall.yaml", overrides, directory);
    const std::vector<GrainRow> rows = rows_of(record, 0);
    constexpr double modulus = 10e6, poisson = 0.25;  // of the deck
    const double unit_time = radius / std::sqrt(modulus / density);
    const double unit_force = modulus / (1.0 - poisson * poisson) * radius * radius;
    // Force as a mean over 0.08 R/c0, or over a step where that is longer.
    const double step = rows.back().time / static_cast<double>(rows.size() - 1);
    const auto window = static_cast<std::size_t>(std::max(1.0, std::round(0.08 * unit_time / step)));
    Impact impact;
    double begin = INFINITY, end = 0.0;
    for (std::size_t i = window; i < rows.size(); ++i) {
        double impulse = 0.0;
        for (std::size_t k = i + 1 - window; k <= i; ++k)
            impulse += size_of(rows[k].force) * (rows[k].time - rows[k - 1].time);
        impact.time.push_back(rows[i].time / unit_time);
        impact.force.push_back(impulse / (rows[i].time - rows[i - window].time) / unit_force);
        if (size_of(rows[i].force) == 0.0) continue;
        begin = std::min(begin, rows[i - 1].time / unit_time);
        end = rows[i].time / unit_time;
    }
    impact.peak = *std::max_element(impact.force.begin(), impact.force.end());
    impact.duration = end - begin;
    impact.restitution = size_of(rows.back().velocity) / size_of(rows.front().velocity);
    impact.loss = record.history.back().energy.contact_loss / record.history.front().energy.kinetic;
    return impact;
}

inline void print_impact(ReportTable& table, const std::string& name, const WallCase& c,
                         const Impact& impact) {
    const Reference& expected = c.reference;
    const int r_over_dx = c.cells * c.particles_per_cell;
    const double in_cells = expected.patch * c.cells;
    fmt::print("{:40} {:5} {:6.2f} {:9.4f} {:8.2f} {:8.1f} {:11.3e} {:8.1f} {:9.4f}\n", name, r_over_dx,
               in_cells, impact.restitution, impact.duration, impact.duration_error(expected), impact.peak,
               impact.peak_error(expected), impact.loss);
    table.add(name,
              {expected.speed, static_cast<double>(r_over_dx), in_cells, impact.restitution, impact.duration,
               impact.duration_error(expected), impact.peak, impact.peak_error(expected), impact.loss});
}

/// A force that acts on a cell cannot be narrower than the cell: errors belong to the contact radius in
/// cells.
inline void report_refinement(Report& report, ReportTable& table) {
    struct Series {
        Reference reference;
        std::string filling;
        int particles_per_cell;
        std::vector<int> cells;                                ///< per radius
        double restitution_bound, duration_bound, peak_bound;  ///< of the finest: 1 - e / e_FE, errors in %
    };
    const std::vector<Series> all = {
        {fast, "rings", 1, {4, 6, 8, 12}, 0.035, 1.5, 5.0},     // measured 0.030, 0.0, 3.6
        {fast, "lattice", 1, {4, 6, 8, 12}, 0.006, 1.5, 3.5},   // measured 0.0043, 0.0, 2.3
        {slow, "rings", 1, {4, 6, 8, 12}, 0.007, 15.0, 2.5},    // measured 0.0058, 12.8, 1.8
        {slow, "lattice", 1, {4, 6, 8, 12}, 0.004, 18.0, 4.0},  // measured 0.0021, 16.5, 2.4
        {fast, "rings", 2, {2, 3, 4, 6}, 0.006, 2.0, 8.0},      // measured 0.0044, 1.3, 6.9
        {slow, "rings", 2, {2, 3, 4, 6}, 0.004, 31.0, 20.0}};   // measured 0.0028, 28.0, 17.0
    const std::vector<Series> quick = {{fast, "rings", 1, {4, 6, 8}, 0.02, 4.0, 1.5}};  // 0.015, 3.3, 0.6
    Chart pulse{"Force on the wall, V = 0.01 c0, shells, h = dx", "t c0 / R", "F / (E* R^2)", {}};
    Chart duration{"Error of the duration", "contact radius / cell", "error [%]", {}};
    Chart peak{"Error of the peak force", "contact radius / cell", "error [%]", {}};
    for (const Series& series : report.options.short_mode ? quick : all) {
        const Reference& expected = series.reference;
        const std::string name = fmt::format("V = {} c0, {}, {}", expected.speed, series.filling,
                                             series.particles_per_cell == 1 ? "h = dx" : "h = 2 dx");
        ChartLine durations{name, {}, {}, static_cast<int>(duration.lines.size())};
        durations.markers = true;
        ChartLine peaks = durations;
        Impact impact;
        for (const int cells : series.cells) {
            const WallCase c{expected, series.filling, cells, series.particles_per_cell};
            impact = hit_wall(report, c);
            print_impact(table, name, c, impact);
            durations.x.push_back(expected.patch * cells),
                durations.y.push_back(impact.duration_error(expected));
            peaks.x.push_back(expected.patch * cells), peaks.y.push_back(impact.peak_error(expected));
            if (duration.lines.empty())
                pulse.lines.push_back({fmt::format("R/dx = {}", cells), impact.time, impact.force,
                                       static_cast<int>(pulse.lines.size())});
        }
        duration.lines.push_back(durations);
        peak.lines.push_back(peaks);
        report.checks.at_most(name + ": e lost", 1.0 - impact.restitution / expected.restitution,
                              series.restitution_bound);
        report.checks.at_most(name + ": |error of duration| [%]", std::abs(impact.duration_error(expected)),
                              series.duration_bound);
        report.checks.at_most(name + ": |error of peak force| [%]", std::abs(impact.peak_error(expected)),
                              series.peak_bound);
    }
    pulse.lines.push_back({"duration and peak force by FE",
                           {0.3, 0.3 + fast.duration},
                           {fast.peak, fast.peak},
                           static_cast<int>(pulse.lines.size()),
                           true});
    draw_charts({pulse, duration, peak}, 3, report.options.directory + "/wall.png");
}

/// The same impact with one thing changed each time.
inline void report_variants(Report& report, ReportTable& table) {
    const std::vector<std::pair<std::string, std::vector<std::string>>> all = {
        {"as it is", {}},
        {"wall 0.25 cells off the nodes", {"params.offset=0.25"}},
        {"wall 0.5 cells off the nodes", {"params.offset=0.5"}},
        {"wall 0.75 cells off the nodes", {"params.offset=0.75"}},
        {"wall tilted by 15 degrees", {"params.tilt=15"}},
        {"wall tilted by 30 degrees", {"params.tilt=30"}},
        {"wall tilted by 45 degrees", {"params.tilt=45"}},
        {"surface_correction volume", {"params.surface_correction=volume"}},
        {"calibration none", {"params.calibration=none"}},
        {"horizon_ratio 2", {"params.horizon_ratio=2"}},
        {"horizon_ratio 2.5", {"params.horizon_ratio=2.5"}},
        {"rule seed", {"params.rule=seed"}},
        {"coupling flip", {"params.coupling=flip"}}};
    if (report.options.short_mode) return;
    fmt::print("\nShells, R/dx = 8, h = dx, V = 0.01 c0, one thing changed\n");
    double worst = 0.0, least = 1.0, direct_peak = 0.0;
    for (const auto& [name, overrides] : all) {
        const WallCase c{fast, "rings", 8, 1, overrides};
        const Impact impact = hit_wall(report, c);
        print_impact(table, name, c, impact);
        if (overrides.empty()) direct_peak = impact.peak;
        if (!name.starts_with("wall")) continue;
        worst = std::max(worst, std::abs(impact.peak / direct_peak - 1.0));
        least = std::min(least, impact.restitution);
    }
    report.checks.at_most("peak force: spread over places and tilts of the wall", worst,
                          0.06);  // measured 0.055, bound 0.06

    report.checks.at_least("restitution: least over places and tilts", least,
                           0.94);  // measured 0.949, bound 0.94
}

inline void report_wall(Report& report) {
    ReportTable table({"speed_over_c0", "r_over_dx", "patch_in_cells", "restitution", "duration",
                       "duration_error_percent", "peak_force", "peak_error_percent", "contact_loss"});
    fmt::print(
        "\nSphere on a wall. Finite elements: V/c0 = 0.001: e 0.9998, t_c 19.27, F 7.53e-4; 0.01: 0.9986, "
        "11.67, "
        "1.272e-2\n{:40} {:>5} {:>6} {:>9} {:>8} {:>8} {:>11} {:>8} {:>9}\n",
        "", "R/dx", "a/h", "e", "t_c c0/R", "err [%]", "F/(E* R^2)", "err [%]", "loss/T");
    report_refinement(report, table);
    report_variants(report, table);
    table.write(report.options.directory, "wall");
}

}  // namespace quern::spheres
