// Two spheres in oblique collision: spin without friction, and what friction does in gross slip.
#pragma once

#include <Eigen/LU>
#include <numbers>
#include <numeric>

#include "examples/spheres/cases.hpp"
#include "src/results/frame_file.hpp"

namespace quern::spheres {

/// Inverse inertia times angular momentum of one grain's particles [rad/s].
inline Vec<3> spin_of(const Frame& frame, int grain) {
    const auto at = [](const auto& field, std::size_t i) {
        return Vec<3>(field[3 * i], field[3 * i + 1], field[3 * i + 2]);
    };
    double mass = 0.0;
    Vec<3> centre = Vec<3>::Zero(), momentum = Vec<3>::Zero(), angular = Vec<3>::Zero();
    Mat<3> second = Mat<3>::Zero();
    for (std::size_t i = 0; i < frame.n(); ++i) {
        if (frame.grain[i] != grain) continue;
        const Vec<3> x = at(frame.position, i), p = frame.volume[i] * at(frame.velocity, i);
        mass += frame.volume[i];
        centre += frame.volume[i] * x;
        momentum += p;
        angular += x.cross(p);
        second += frame.volume[i] * x * x.transpose();
    }
    centre /= mass;
    angular -= centre.cross(momentum);
    second -= mass * centre * centre.transpose();
    const Mat<3> inertia = second.trace() * Mat<3>::Identity() - second;
    return inertia.inverse() * angular;
}

/// Grazing collisions without friction over places and directions: nothing may begin to spin.
inline void report_spin(Report& report, ReportTable& table) {
    const std::vector<std::pair<double, double>> directions =  // angle and rise [degrees]
        report.options.short_mode ? std::vector<std::pair<double, double>>{{0, 0}, {30, 20}}
                                  : std::vector<std::pair<double, double>>{
                                        {0, 0}, {20, 0}, {45, 0}, {0, 30}, {30, 20}, {45, 35.3}, {70, 60}};
    fmt::print(
        "\nTwo spheres, offset 0.7 R, mu = 0, over places and directions: spin [rad/s], kinetic energy kept\n"
        "{:28} {:>6} {:>8} {:>8} {:>10} {:>10}\n",
        "each at", "runs", "largest", "mean", "least kept", "most kept");
    struct Kind {
        std::string filling;
        int cells;
        double speed, bound;
        std::vector<double> shifts;  ///< in cells
    };
    const std::vector<double> every = {0, 0.25, 0.5, 0.75};
    const std::vector<Kind> all = {{"rings", 3, 1.0, 0.25, every},        // measured 0.220
                                   {"lattice", 3, 1.0, 0.5, every},       // measured 0.444
                                   {"rings", 3, 0.2, 0.045, every},       // measured 0.038
                                   {"rings", 4, 1.0, 0.17, {0.25, 0.5}},  // measured 0.148
                                   {"rings", 6, 1.0, 0.1, {0.25, 0.5}}};  // measured 0.085, wanted 0.05
    const std::vector<Kind> quick = {{"rings", 3, 1.0, 0.21, {0.25}}};    // measured 0.178
    ChartLine largest_line{"largest", {}, {}, 0}, mean_line{"mean", {}, {}, 1};
    largest_line.markers = mean_line.markers = true;
    for (const Kind& kind : report.options.short_mode ? quick : all) {
        std::vector<double> spins;
        double low = 1.0, high = 0.0;
        for (const double shift : kind.shifts)
            for (const auto& [angle, rise] : directions) {
                const RunRecord record = report.run(
                    "/collision.yaml",
                    {override_of("grid_shift", shift), override_of("angle", angle), override_of("rise", rise),
                     override_of("cells_per_radius", kind.cells), override_of("speed", kind.speed),
                     "params.filling=" + kind.filling, override_of("t_end", kind.speed < 1.0 ? 0.4 : 0.1)},
                    "collision");
                const FrameFileReader file(report.options.directory + "/collision/results.h5");
                const Frame last = file.read(file.n_frames() - 1);
                spins.push_back(std::max(spin_of(last, 0).norm(), spin_of(last, 1).norm()));
                const double kept =
                    record.history.back().energy.kinetic / record.history.front().energy.kinetic;
                low = std::min(low, kept);
                high = std::max(high, kept);
                table.add(kind.filling, {static_cast<double>(kind.cells), shift, angle, rise, kind.speed, 0.0,
                                         0.7, spins.back(), kept, NAN, NAN});
            }
        const double largest = *std::max_element(spins.begin(), spins.end());
        const double mean =
            std::accumulate(spins.begin(), spins.end(), 0.0) / static_cast<double>(spins.size());
        const std::string name =
            fmt::format("{}, R/dx = {}, {} m/s", kind.filling, 2 * kind.cells, kind.speed);
        fmt::print("{:28} {:6} {:8.4f} {:8.4f} {:10.4f} {:10.4f}\n", name, spins.size(), largest, mean, low,
                   high);
        report.checks.at_most(name + ": spin without friction [rad/s]", largest, kind.bound);
        if (kind.filling != "rings" || kind.speed < 1.0) continue;
        largest_line.x.push_back(2 * kind.cells), largest_line.y.push_back(largest);
        mean_line.x.push_back(2 * kind.cells), mean_line.y.push_back(mean);
    }
    const ChartLine wanted{"wanted", {6, 12}, {0.05, 0.05}, 2, true};
    draw_charts({{"Spin of frictionless spheres, 1 m/s each",
                  "R / dx",
                  "spin [rad/s]",
                  {largest_line, mean_line, wanted}}},
                1, report.options.directory + "/spin.png");
}

/// Gross slip: J_t = mu J_n, and both spheres turn by R J_t / I.
inline void report_friction(Report& report, ReportTable& table) {
    struct Slip {
        double mu, speed, slip_bound, spin_bound;
    };
    const std::vector<Slip> all = {{0.1, 1.0, 2.8, 6.5},    // measured 2.3, 5.5
                                   {0.1, 0.2, 0.8, 1.8},    // measured 0.62, 1.53
                                   {0.05, 0.2, 0.8, 2.0}};  // measured 0.47, 1.70
    fmt::print(
        "\nTwo spheres in gross slip, offset 1.4 R, R/dx = 6: tangential impulse against mu times the normal "
        "one, "
        "spin\nagainst mu J_n R / I\n{:28} {:>12} {:>12}\n",
        "", "J_t error [%]", "spin error [%]");
    const double beta = inertia_of(folder + "/collision.yaml", {});
    const double mass = 4.0 / 3.0 * std::numbers::pi * density * std::pow(radius, 3);
    for (const Slip& c : all) {
        if (report.options.short_mode && c.speed < 1.0) continue;
        const std::vector<GrainRow> rows_1_and_2 =
            report
                .run("/collision.yaml",
                     {override_of("mu", c.mu), override_of("offset", 1.4), override_of("speed", c.speed),
                      override_of("t_end", c.speed < 1.0 ? 0.4 : 0.1)},
                     "collision")
                .grains;
        double normal = 0.0, tangential = 0.0;  // the line of centres turns meanwhile: impulses along it
        for (std::size_t i = 2; i < rows_1_and_2.size(); i += 2) {
            const GrainRow &before = rows_1_and_2[i - 2], &first = rows_1_and_2[i],
                           &second = rows_1_and_2[i + 1];
            const double nx = second.position[0] - first.position[0];
            const double ny = second.position[1] - first.position[1];
            const double weight = (first.time - before.time) / std::hypot(nx, ny);
            normal -= weight * (first.force[0] * nx + first.force[1] * ny);
            tangential += weight * (first.force[0] * ny - first.force[1] * nx);
        }
        const double omega = std::abs(rows_1_and_2[rows_1_and_2.size() - 2].omega);
        const double slip = 100.0 * (std::abs(tangential) / normal / c.mu - 1.0);
        const double spin = 100.0 * (omega * beta * radius * mass / normal / c.mu - 1.0);
        const std::string name = fmt::format("mu = {}, {} m/s each", c.mu, c.speed);
        fmt::print("{:28} {:12.2f} {:12.2f}\n", name, slip, spin);
        table.add("rings", {3.0, 0.0, 0.0, 0.0, c.speed, c.mu, 1.4, omega, NAN, slip, spin});
        report.checks.at_most(name + ": |J_t error| [%]", std::abs(slip), c.slip_bound);
        report.checks.at_most(name + ": |spin error| [%]", std::abs(spin), c.spin_bound);
    }
}

inline void report_collisions(Report& report) {
    ReportTable table({"cells_per_radius", "shift", "angle", "rise", "speed", "mu", "offset", "spin",
                       "kinetic_kept", "slip_error_percent", "spin_error_percent"});
    report_spin(report, table);
    report_friction(report, table);
    // Unequal in all respects, with friction, out of the planes of the grid: for the momenta.
    report.run("/collision.yaml",
               {"params.size_ratio=0.6", "params.density_ratio=4", "params.stiffness_ratio=10",
                "params.mu=0.3", "params.angle=25", "params.rise=40"},
               "collision");
    table.write(report.options.directory, "collisions");
}

}  // namespace quern::spheres
