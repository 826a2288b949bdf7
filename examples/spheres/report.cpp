// Spheres: rolling down a plane, hitting a wall, hitting each other, and the same bits for any number of
// threads.
#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "src/deck/read_deck.hpp"
#include "src/mesh/make_shape.hpp"
#include "src/results/frame_file.hpp"
#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace {

using namespace quern;

constexpr double radius = 0.5, density = 3000.0, g = 9.8;  // of the decks
const std::string folder = EXAMPLE_DIR;

std::string override_of(const std::string& name, double value) {
    return fmt::format("params.{}={}", name, value);
}

/// Moment of inertia of the particles of a deck's first shape, over M R^2.
double inertia_of(const std::string& deck, const std::vector<std::string>& overrides) {
    const Shape<3> shape = make_shape<3>(read_deck(deck, overrides).shapes.front());
    double mass = 0.0, polar = 0.0;
    for (int i = 0; i < shape.n_nodes(); ++i) {
        mass += shape.volume[i];
        polar += shape.volume[i] * shape.X[i].squaredNorm();
    }
    return 2.0 / 3.0 * polar / (mass * radius * radius);
}

struct Report {
    ReportOptions options;
    ReportChecks checks;
    double linear_error = 0.0, angular_error = 0.0;  ///< largest of all runs by the pair rule with impulses

    RunRecord run(const std::string& deck, const std::vector<std::string>& overrides,
                  const std::string& directory = "case") {
        RunRecord record = run_case(folder + deck, overrides, options.directory + "/" + directory);
        const auto other = [](const std::string& item) {
            return item == "params.rule=seed" || item == "params.coupling=flip";
        };
        if (std::none_of(overrides.begin(), overrides.end(), other)) {
            linear_error = std::max(linear_error, record.summary.momentum_error_linear);
            angular_error = std::max(angular_error, record.summary.momentum_error_angular);
        }
        return record;
    }
};

// ---------------------------------------------------------------------------------------------- rolling

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

void report_rolling(Report& report) {
    // Bounds of the errors at 1 s [%], of x and of the spin, and of the spin on the way.
    const std::vector<Incline> all = {
        {0.3, 10, "rings", 6, 0.2, 0.8, 1.5},    // measured 0.05, 0.46, 1.03
        {0.3, 10, "lattice", 6, 0.2, 0.8, 2.0},  // measured 0.03, 0.32, 1.45
        {0.3, 10, "mesh", 6, 0.2, 0.8, 2.0},     // measured 0.03, 0.21, 1.50
        {0.3, 1, "rings", 6, 0.7, 1.5, 4.0},     // measured 0.42, 0.83, 3.02
        {0.3, 1, "lattice", 6, 0.7, 2.0, 4.0},   // measured 0.37, 1.64, 3.26
        {0.1, 10, "rings", 6, 0.1, 0.3, 1.5},    // measured 0.001, 0.09, 1.12
        {0.155, 10, "rings", 6, 0.1, 0.5, 1.5},  // measured 0.005, 0.19, 1.18
        {0.175, 10, "rings", 6, 0.3, 1.0, 2.0},  // measured 0.15, 0.55, 1.48
        {0.3, 1, "rings", 12, 2.0, 0.5, 1.2},    // measured 1.67, 0.16, 0.70
        {0.3, 10, "rings", 12, 0.4, 0.5, 2.0},   // measured 0.20, 0.11, 1.39
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
        std::vector<std::string> overrides = {
            override_of("mu", c.mu), override_of("stiffness_factor", c.stiffness),
            override_of("cells_per_diameter", c.cells), "params.filling=" + c.filling};
        const double beta = inertia_of(folder + "/rolling.yaml", overrides);
        overrides.push_back(override_of("inertia", beta));
        const std::vector<GrainRow> rows = rows_of(report.run("/rolling.yaml", overrides, "rolling"), 0);
        const RigidMotion exact(c.mu, beta);
        const double start = rows.front().position[0], end = rows.back().time;
        double low = INFINITY, high = 0.0, height = 0.0, worst = 0.0, x_error = 0.0, spin_error = 0.0;
        ChartLine spins{fmt::format("mu {}, stiffness x{}, {} {}", c.mu, c.stiffness, c.filling, c.cells),
                        {},
                        {},
                        static_cast<int>(spin.lines.size())};
        ChartLine places = spins;
        for (const GrainRow& row : rows) {
            const double y = row.position[1], t = row.time;
            low = std::min(low, y);
            high = std::max(high, y);
            height += y / static_cast<double>(rows.size());
            if (t < 0.1) continue;
            x_error = 100.0 * ((row.position[0] - start) / (0.5 * exact.acceleration * t * t) - 1.0);
            const double spin_of_end = 100.0 * (-row.omega - exact.spin_rate * t) / (exact.spin_rate * end);
            spin_error = spin_of_end * end / t;
            if (t > 0.2) worst = std::max(worst, std::abs(spin_of_end));
            spins.x.push_back(t), spins.y.push_back(spin_of_end);
            places.x.push_back(t), places.y.push_back(x_error);
        }
        if (c.mu == 0.3 && c.filling == "rings") {
            spin.lines.push_back(spins);
            place.lines.push_back(places);
        }
        fmt::print("{:34} {:8.4f} {:9.2f} {:9.2f} {:9.2f} {:12.2f} {:12.2f}\n", spins.label, beta, x_error,
                   spin_error, worst, 1e3 * (high - low), 100.0 * (1.0 - height / radius));
        table.add(c.filling, {c.mu, c.stiffness, static_cast<double>(c.cells), beta, x_error, spin_error,
                              worst, high - low, 100.0 * (1.0 - height / radius)});
        report.checks.at_most(spins.label + ": |x error| [%]", std::abs(x_error), c.x_bound);
        report.checks.at_most(spins.label + ": |spin error| [%]", std::abs(spin_error), c.spin_bound);
        report.checks.at_most(spins.label + ": worst spin error [%]", worst, c.course_bound);
    }
    table.write(report.options.directory, "rolling");
    draw_charts({place, spin}, 2, report.options.directory + "/rolling.png");
}

// ------------------------------------------------------------------------------------------------- wall

/// Converged finite elements, nu = 0.25, rigid frictionless wall.
struct Reference {
    double speed;                        ///< over c0
    double restitution, duration, peak;  ///< duration in R/c0, peak force in E* R^2
    double patch;                        ///< largest contact radius over R, by Hertz
};
const Reference slow{0.001, 0.9998, 19.27, 7.53e-4, 0.0827}, fast{0.01, 0.9986, 11.67, 1.272e-2, 0.212};

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

double size_of(const double (&v)[3]) {
    return std::hypot(v[0], v[1], v[2]);
}

Impact hit_wall(Report& report, const WallCase& c, const std::string& directory = "wall") {
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

void print_impact(ReportTable& table, const std::string& name, const WallCase& c, const Impact& impact) {
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
void report_refinement(Report& report, ReportTable& table) {
    struct Series {
        Reference reference;
        std::string filling;
        int particles_per_cell;
        std::vector<int> cells;                                ///< per radius
        double restitution_bound, duration_bound, peak_bound;  ///< of the finest: 1 - e / e_FE, errors in %
    };
    const std::vector<Series> all = {{fast, "rings", 1, {4, 6, 8, 12}, 0.02, 3.0, 5.0},
                                     {fast, "lattice", 1, {4, 6, 8, 12}, 0.02, 3.0, 5.0},
                                     {slow, "rings", 1, {4, 6, 8, 12}, 0.02, 20.0, 20.0},
                                     {slow, "lattice", 1, {4, 6, 8, 12}, 0.02, 20.0, 20.0},
                                     {fast, "rings", 2, {2, 3, 4, 6}, 0.02, 8.0, 8.0},
                                     {slow, "rings", 2, {2, 3, 4, 6}, 0.02, 41.0, 41.0}};
    const std::vector<Series> quick = {{fast, "rings", 1, {4, 6, 8}, 0.02, 5.0, 5.0}};
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
void report_variants(Report& report, ReportTable& table) {
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
        {"max_sweeps 50", {"params.max_sweeps=50"}},
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
    report.checks.at_most("peak force: spread over places and tilts of the wall", worst, 0.05);
    report.checks.at_least("restitution: least over places and tilts", least, 0.97);
}

void report_wall(Report& report) {
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

// ------------------------------------------------------------------------------------------- collisions

/// Inverse inertia times angular momentum of one grain's particles [rad/s].
Vec<3> spin_of(const Frame& frame, int grain) {
    const auto at = [](const std::vector<double>& field, std::size_t i) {
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
void report_spin(Report& report, ReportTable& table) {
    const std::vector<double> shifts =
        report.options.short_mode ? std::vector<double>{0.25} : std::vector<double>{0, 0.25, 0.5, 0.75};
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
        bool one_shift = false;
    };
    const std::vector<Kind> all = {{"rings", 3, 1.0, 0.3},
                                   {"lattice", 3, 1.0, 0.3},
                                   {"rings", 3, 0.2, 0.03},
                                   {"rings", 6, 1.0, 0.1, true}};
    for (const Kind& kind : report.options.short_mode ? std::vector<Kind>{all[0]} : all) {
        std::vector<double> spins;
        double low = 1.0, high = 0.0;
        for (const double shift : kind.one_shift ? std::vector<double>{0.25} : shifts)
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
    }
}

/// Gross slip: J_t = mu J_n, and both spheres turn by R J_t / I.
void report_friction(Report& report, ReportTable& table) {
    struct Slip {
        double mu, speed, slip_bound, spin_bound;
    };
    const std::vector<Slip> all = {{0.1, 1.0, 5.0, 8.0}, {0.1, 0.2, 1.0, 2.0}, {0.05, 0.2, 1.0, 2.0}};
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

void report_collisions(Report& report) {
    ReportTable table({"cells_per_radius", "shift", "angle", "rise", "speed", "mu", "offset", "spin",
                       "kinetic_kept", "slip_error_percent", "spin_error_percent"});
    report_spin(report, table);
    report_friction(report, table);
    table.write(report.options.directory, "collisions");
}

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
    return report.checks.verdict();
}

}  // namespace

int main(int argc, char** argv) {
    return report_main(argc, argv, "spheres", body);
}
