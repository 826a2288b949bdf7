// A sphere on an inclined plane: rolling and slipping against the rigid answer.
#pragma once

#include "examples/spheres/cases.hpp"

namespace quern::spheres {

struct Incline {
    double mu, stiffness;
    std::string filling;
    int cells;                   ///< per diameter
    double x_bound, spin_bound;  ///< of the errors at 1 s [%]
    double course_bound;         ///< of the spin after 0.2 s, in % of the spin at 1 s
};

/// A rigid sphere of moment of inertia beta M R^2 that slips or rolls.
struct RigidMotion {
    double acceleration, spin_rate;
    RigidMotion(double mu, double beta) {
        const double sine = 0.5, cosine = std::sqrt(0.75);  // 30 degrees
        const double traction = std::min(beta / (1.0 + beta) * g * sine, mu * g * cosine);
        acceleration = g * sine - traction;
        spin_rate = traction / (beta * radius);
    }
};

/// Errors against the rigid answer [%]: of x, of the spin, and of the spin in units of its last value.
struct Descent {
    std::vector<double> time, x_error, spin_error;  ///< spin: in % of the last
    double beta = 0, x = 0, spin = 0, worst_spin = 0;
    double height_range = 0;  ///< [m]
    double flattening = 0;    ///< mean of 1 - y/R [%]
};

inline Descent roll(Report& report, const Incline& c) {
    std::vector<std::string> overrides = {
        override_of("mu", c.mu), override_of("stiffness_factor", c.stiffness),
        override_of("cells_per_diameter", c.cells), "params.filling=" + c.filling};
    Descent d;
    d.beta = inertia_of(folder + "/rolling.yaml", overrides);
    overrides.push_back(override_of("inertia", d.beta));
    const std::vector<GrainRow> rows = rows_of(report.run("/rolling.yaml", overrides, "rolling"), 0);
    const RigidMotion exact(c.mu, d.beta);
    const double start = rows.front().position[0], end = rows.back().time;
    double low = INFINITY, high = 0.0;
    for (const GrainRow& row : rows) {
        const double y = row.position[1], t = row.time;
        low = std::min(low, y);
        high = std::max(high, y);
        d.flattening += 100.0 * (1.0 - y / radius) / static_cast<double>(rows.size());
        if (t < 0.1) continue;
        d.time.push_back(t);
        d.x_error.push_back(100.0 * ((row.position[0] - start) / (0.5 * exact.acceleration * t * t) - 1.0));
        d.spin_error.push_back(100.0 * (-row.omega - exact.spin_rate * t) / (exact.spin_rate * end));
        if (t > 0.2) d.worst_spin = std::max(d.worst_spin, std::abs(d.spin_error.back()));
    }
    d.height_range = high - low;
    d.x = d.x_error.back();
    d.spin = d.spin_error.back();
    return d;
}

inline void report_rolling(Report& report) {
    // Bounds of the errors at 1 s [%], of x and of the spin, and of the spin on the way.
    const std::vector<Incline> all = {
        {0.3, 10, "rings", 6, 0.2, 1.3, 1.8},    // measured 0.11, 1.11, 1.58
        {0.3, 10, "lattice", 6, 0.1, 1.2, 2.2},  // measured 0.05, 1.03, 1.97
        {0.3, 10, "mesh", 6, 0.2, 1.1, 2.2},     // measured 0.13, 0.92, 1.88
        {0.3, 1, "rings", 6, 0.3, 0.5, 2.7},     // measured 0.22, 0.15, 2.35
        {0.3, 1, "lattice", 6, 0.6, 0.5, 2.6},   // measured 0.44, 0.26, 2.26
        {0.1, 10, "rings", 6, 0.1, 0.3, 1.2},    // measured 0.001, 0.08, 0.96
        {0.155, 10, "rings", 6, 0.1, 1.8, 1.8},  // measured 0.003, 1.58, 1.58
        {0.175, 10, "rings", 6, 0.2, 1.3, 1.8},  // measured 0.13, 1.08, 1.56
        {0.3, 1, "rings", 12, 1.2, 1.6, 1.8},    // measured 1.04, 1.43, 1.50
        {0.3, 10, "rings", 12, 0.2, 0.6, 1.6},   // measured 0.16, 0.47, 1.33
    };
    const std::vector<Incline> cases = report.options.short_mode ? std::vector<Incline>{all[0]} : all;
    ReportTable table({"mu", "stiffness_factor", "cells", "inertia", "x_error_percent", "spin_error_percent",
                       "largest_spin_error_percent", "height_range", "height_loss_percent"});
    Chart spin{"Spin against the rigid answer", "t [s]", "error, % of the spin at 1 s", {}};
    Chart place{"Distance against the rigid answer", "t [s]", "error [%]", {}};
    fmt::print(
        "\nSphere on a plane of 30 degrees, threshold of slip mu = tan(30) / 3.5 = 0.165\n"
        "{:34} {:>8} {:>9} {:>9} {:>9} {:>12} {:>12}\n",
        "", "I/(MR^2)", "x [%]", "spin [%]", "worst [%]", "y range [mm]", "1 - y/R [%]");
    for (const Incline& c : cases) {
        const Descent d = roll(report, c);
        const std::string name =
            fmt::format("mu {}, stiffness x{}, {} {}", c.mu, c.stiffness, c.filling, c.cells);
        if (c.mu == 0.3 && c.filling == "rings") {
            const int color = static_cast<int>(spin.lines.size());
            spin.lines.push_back({name, d.time, d.spin_error, color});
            place.lines.push_back({name, d.time, d.x_error, color});
        }
        fmt::print("{:34} {:8.4f} {:9.2f} {:9.2f} {:9.2f} {:12.2f} {:12.2f}\n", name, d.beta, d.x, d.spin,
                   d.worst_spin, 1e3 * d.height_range, d.flattening);
        table.add(c.filling, {c.mu, c.stiffness, static_cast<double>(c.cells), d.beta, d.x, d.spin,
                              d.worst_spin, d.height_range, d.flattening});
        report.checks.at_most(name + ": |x error| [%]", std::abs(d.x), c.x_bound);
        report.checks.at_most(name + ": |spin error| [%]", std::abs(d.spin), c.spin_bound);
        report.checks.at_most(name + ": worst spin error [%]", d.worst_spin, c.course_bound);
    }
    table.write(report.options.directory, "rolling");
    draw_charts({place, spin}, 2, report.options.directory + "/rolling.png");
}

}  // namespace quern::spheres
