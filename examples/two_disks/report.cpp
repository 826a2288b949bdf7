// Two disks collide: head-on, oblique, equal and unequal, by the rules of contact, against converged
// references.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace {

using namespace quern;

const std::string deck = EXAMPLE_DIR "/collision.yaml";
constexpr double radius = 0.5, density = 3000.0;
constexpr double soft_modulus = 90.0 / 13.0 * 1e6, soft_poisson = 5.0 / 13.0;  // of the deck

/// What makes a case differ from the deck.
struct Case {
    double r_over_dx = 12;
    double speed = 1.0, modulus = soft_modulus, poisson = soft_poisson;
    double mu = 0.0, offset = 0.0, shift = 0.0, angle_degrees = 0.0;
    double size_ratio = 1.0, density_ratio = 1.0, stiffness_ratio = 1.0;
    std::string rule = "pair", coupling = "impulse";

    double wave_speed() const { return std::sqrt(modulus / density); }
    double plane_modulus() const { return modulus / (1.0 - poisson * poisson); }
    std::vector<std::string> overrides() const {
        return {fmt::format("params.cells_per_radius={}", r_over_dx / 2.0),
                fmt::format("params.speed={}", speed),
                fmt::format("params.young_modulus={}", modulus),
                fmt::format("params.poisson_ratio={}", poisson),
                fmt::format("params.mu={}", mu),
                fmt::format("params.offset={}", offset),
                fmt::format("params.grid_shift={}", shift),
                fmt::format("params.angle={}", angle_degrees),
                fmt::format("params.size_ratio={}", size_ratio),
                fmt::format("params.density_ratio={}", density_ratio),
                fmt::format("params.stiffness_ratio={}", stiffness_ratio),
                fmt::format("params.rule={}", rule),
                fmt::format("params.coupling={}", coupling)};
    }
    std::string name() const {
        return fmt::format(
            "{}/{} R/dx {} V {:.4g} nu {:.3g} mu {} offset {} shift {} angle {} ratios {} {} {}", rule,
            coupling, r_over_dx, speed, poisson, mu, offset, shift, angle_degrees, size_ratio, density_ratio,
            stiffness_ratio);
    }
};

/// What a collision did. Lengths in R, times in R/c0, forces in E* R, with R, c0, E* of the first disk.
struct Bounce {
    double restitution = 0, duration = 0, peak = 0;
    double spin = 0;                         ///< the larger |omega| R / V of the two
    double slip_ratio = 0, spin_ratio = 0;   ///< tangential, rotational change of the first disk over normal
    double contact_loss = 0, vibration = 0;  ///< over the kinetic energy before
    double force_mismatch = 0;               ///< largest |F_1 + F_2| over the largest |F_1|
    double linear_error = 0, angular_error = 0;
    std::vector<double> time, force;  ///< for charts
};

double size_of(const double (&v)[3]) {
    return std::hypot(v[0], v[1]);
}

/// Largest mean of the force over a window of 0.08 R/c0, or one step if that is longer.
double filtered_peak(const std::vector<GrainRow>& rows, double window) {
    std::vector<double> impulse(rows.size(), 0.0);
    for (std::size_t i = 1; i < rows.size(); ++i) {
        impulse[i] = impulse[i - 1] + size_of(rows[i].force) * (rows[i].time - rows[i - 1].time);
        window = std::max(window, rows[i].time - rows[i - 1].time);
    }
    const auto impulse_at = [&](double t) {
        const auto after = std::find_if(rows.begin() + 1, rows.end() - 1,
                                        [&](const GrainRow& row) { return row.time >= t; });
        const auto i = static_cast<std::size_t>(after - rows.begin());
        const double part = (t - rows[i - 1].time) / (rows[i].time - rows[i - 1].time);
        return impulse[i - 1] + std::clamp(part, 0.0, 1.0) * (impulse[i] - impulse[i - 1]);
    };
    double peak = 0.0;
    for (const GrainRow& row : rows)
        peak =
            std::max(peak, (impulse_at(row.time + window / 2) - impulse_at(row.time - window / 2)) / window);
    return peak;
}

Bounce measure(const Case& c, const RunRecord& record) {
    const std::vector<GrainRow> first = rows_of(record, 0), second = rows_of(record, 1);
    const double time_unit = radius / c.wave_speed(), force_unit = c.plane_modulus() * radius;
    Bounce b;
    std::size_t begin = first.size(), end = 0;
    double largest = 0.0;
    for (std::size_t i = 0; i < first.size(); ++i) {
        const double force = size_of(first[i].force);
        largest = std::max(largest, force);
        b.force_mismatch = std::max(b.force_mismatch, std::hypot(first[i].force[0] + second[i].force[0],
                                                                 first[i].force[1] + second[i].force[1]));
        b.time.push_back(first[i].time / time_unit);
        b.force.push_back(force / force_unit);
        if (force > 0.0) begin = std::min(begin, i), end = i;
    }
    const std::size_t middle = (begin + end) / 2;
    double n[2];
    for (int a = 0; a < 2; ++a) n[a] = second[middle].position[a] - first[middle].position[a];
    const double distance = std::hypot(n[0], n[1]);
    const auto along = [&](double x, double y) { return (x * n[0] + y * n[1]) / distance; };
    const auto across = [&](double x, double y) { return (y * n[0] - x * n[1]) / distance; };
    const auto approach = [&](std::size_t i) {
        return along(first[i].velocity[0] - second[i].velocity[0],
                     first[i].velocity[1] - second[i].velocity[1]);
    };
    const double change[2] = {first.back().velocity[0] - first[0].velocity[0],
                              first.back().velocity[1] - first[0].velocity[1]};
    const double normal = std::abs(along(change[0], change[1]));
    const double inertia = 0.5 * (1.0 - 0.5 / (c.r_over_dx * c.r_over_dx));  // of rings, over M R^2
    b.restitution = -approach(first.size() - 1) / approach(0);
    b.duration = (first[end].time - first[begin - 1].time) / time_unit;
    b.peak = filtered_peak(first, 0.08 * time_unit) / force_unit;
    b.spin = std::max(std::abs(first.back().omega), c.size_ratio * std::abs(second.back().omega)) * radius /
             c.speed;
    b.slip_ratio = std::abs(across(change[0], change[1])) / normal;
    b.spin_ratio = inertia * std::abs(first.back().omega) * radius / normal;
    b.force_mismatch /= largest;
    const EnergyBudget& energy = record.history.back().energy;
    b.contact_loss = energy.contact_loss / record.history[0].energy.kinetic;
    b.vibration = energy.elastic / record.history[0].energy.kinetic;
    b.linear_error = record.summary.momentum_error_linear;
    b.angular_error = record.summary.momentum_error_angular;
    return b;
}

/// Runs cases and keeps their numbers for the table of all.
class Bench {
  public:
    explicit Bench(std::string directory) : directory_(std::move(directory)) {}

    Bounce run(const Case& c, const std::string& subdirectory = "case") {
        const Bounce b = measure(c, run_case(deck, c.overrides(), directory_ + "/" + subdirectory));
        table_.add(c.name(),
                   {b.restitution, b.duration, b.peak, b.spin, b.slip_ratio, b.spin_ratio, b.contact_loss,
                    b.vibration, b.force_mismatch, b.linear_error, b.angular_error});
        if (c.rule == "pair") {
            linear_error_ = std::max(linear_error_, b.linear_error);
            angular_error_ = std::max(angular_error_, b.angular_error);
        }
        return b;
    }
    /// All shifts (in cells) with all angles (in degrees).
    std::vector<Bounce> run_all(Case c, const std::vector<double>& shifts,
                                const std::vector<double>& angles) {
        std::vector<Bounce> bounces;
        for (c.shift = 0.0; const double shift : shifts)
            for (const double angle : angles) {
                c.shift = shift;
                c.angle_degrees = angle;
                bounces.push_back(run(c));
            }
        return bounces;
    }
    void finish(ReportChecks& checks) const {
        table_.write(directory_, "two_disks");
        fmt::print("\nMomenta, pair rule, all runs\n");
        checks.at_most("linear momentum, relative error", linear_error_, 1e-12);
        checks.at_most("angular momentum, relative error", angular_error_, 1e-10);
    }
    const std::string& directory() const { return directory_; }

  private:
    std::string directory_;
    ReportTable table_{{"restitution", "duration", "peak_force", "spin", "slip_ratio", "spin_ratio",
                        "contact_loss", "vibration", "force_mismatch", "linear_error", "angular_error"}};
    double linear_error_ = 0.0, angular_error_ = 0.0;
};

struct Spread {
    double least = INFINITY, mean = 0, largest = -INFINITY;
};

Spread spread(const std::vector<Bounce>& bounces, double Bounce::*number) {
    Spread s;
    for (const Bounce& b : bounces) {
        s.least = std::min(s.least, b.*number);
        s.largest = std::max(s.largest, b.*number);
        s.mean += b.*number / static_cast<double>(bounces.size());
    }
    return s;
}

const std::vector<double> all_shifts = {0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875};
const std::vector<double> all_angles = {0, 15, 30, 45};

std::string text(const Spread& s) {
    return fmt::format("{:.3f} ({:.3f}..{:.3f})", s.mean, s.least, s.largest);
}

/// Head-on and oblique without friction over shifts and angles, by the pair rule.
void report_scatter(Bench& bench, const ReportOptions& options, ReportChecks& checks,
                    std::vector<Chart>& charts) {
    struct Target {
        double r_over_dx, restitution, worst_bound, spin_bound;
    };
    // Worst over shifts and angles, head-on: measured MEASURED
    const std::vector<Target> targets = {
        {6, 0.92, 0.90, 0.14}, {12, 0.96, 0.95, 0.1}, {24, 0.975, 0.97, 0.1}};
    const std::vector<double> shifts = options.short_mode ? std::vector<double>{0, 0.375} : all_shifts;
    const std::vector<double> angles = options.short_mode ? std::vector<double>{0, 30} : all_angles;
    fmt::print(
        "\nPair rule, V = 1 m/s (0.021 c0), no friction: mean (least..largest) over {} shifts x {} angles\n"
        "{:8} {:6} {:>22} {:>22} {:>24} {:>22} {:>14}\n",
        shifts.size(), angles.size(), "offset", "R/dx", "restitution", "t_c c0/R", "F/(E* R) x 100",
        "spin omega R/V", "loss+vibration");
    Chart restitution{"Head-on, over grid shifts and angles", "R/dx", "restitution", {}, true};
    Chart spin{"No friction, so no spin is right", "R/dx", "largest |omega| R/V", {}, true};
    const std::vector<std::string> labels = {"head-on", "offset R"};
    for (int k = 0; k < 2; ++k) {
        ChartLine worst{labels[k] + ", least", {}, {}, k, true}, mean{labels[k] + ", mean", {}, {}, k};
        ChartLine spins{labels[k], {}, {}, k};
        mean.markers = spins.markers = true;
        for (const Target& target : targets) {
            if (options.short_mode && target.r_over_dx > 12) continue;
            Case c;
            c.r_over_dx = target.r_over_dx;
            c.offset = k;
            const std::vector<Bounce> bounces = bench.run_all(c, shifts, angles);
            Spread peak = spread(bounces, &Bounce::peak);
            for (double* value : {&peak.least, &peak.mean, &peak.largest}) *value *= 100.0;
            fmt::print("{:8} {:<6} {:>22} {:>22} {:>24} {:>22} {:>6.3f}+{:.3f}\n", labels[k],
                       target.r_over_dx, text(spread(bounces, &Bounce::restitution)),
                       text(spread(bounces, &Bounce::duration)), text(peak),
                       text(spread(bounces, &Bounce::spin)), spread(bounces, &Bounce::contact_loss).mean,
                       spread(bounces, &Bounce::vibration).mean);
            const Spread e = spread(bounces, &Bounce::restitution);
            mean.x.push_back(target.r_over_dx), mean.y.push_back(e.mean);
            worst.x.push_back(target.r_over_dx), worst.y.push_back(e.least);
            spins.x.push_back(target.r_over_dx), spins.y.push_back(spread(bounces, &Bounce::spin).largest);
        }
        restitution.lines.insert(restitution.lines.end(), {mean, worst});
        spin.lines.push_back(spins);
        for (std::size_t i = 0; i < mean.x.size(); ++i) {
            const std::string where = fmt::format("{}, R/dx {}: ", labels[k], mean.x[i]);
            if (k == 0) checks.at_least(where + "mean restitution", mean.y[i], targets[i].restitution);
            checks.at_least(where + "least restitution", worst.y[i], targets[i].worst_bound);
            checks.at_most(where + "largest spurious spin", spins.y[i], targets[i].spin_bound);
        }
    }
    ChartLine asked{"asked for", {}, {}, 2};
    asked.markers = true;
    asked.line = false;
    for (const Target& target : targets)
        asked.x.push_back(target.r_over_dx), asked.y.push_back(target.restitution);
    restitution.lines.push_back(asked);
    charts.insert(charts.end(), {restitution, spin});
}

/// Head-on against converged finite elements on a rigid frictionless wall, nu = 0.25.
void report_reference(Bench& bench, const ReportOptions& options, ReportChecks& checks,
                      std::vector<Chart>& charts) {
    struct Reference {
        double speed_ratio, restitution, duration, peak;
    };
    const std::vector<Reference> references = {{0.01, 0.984, 7.10, 1.329e-2}, {0.001, 0.986, 8.72, 1.115e-3}};
    std::vector<double> resolutions = {6, 12, 24, 48};
    if (options.short_mode) resolutions = {24};
    fmt::print("\nAgainst finite elements (nu = 0.25): error\n{:>8} {:>6} {:>12} {:>10} {:>10}\n", "V/c0",
               "R/dx", "restitution", "t_c", "F");
    for (const Reference& reference : references) {
        Chart chart{
            fmt::format("Head-on, V/c0 = {}, nu = 0.25", reference.speed_ratio), "t c0/R", "F/(E* R)", {}};
        for (std::size_t i = 0; i < resolutions.size(); ++i) {
            Case c;
            c.poisson = 0.25;
            c.speed = reference.speed_ratio * c.wave_speed();
            c.r_over_dx = resolutions[i];
            c.shift = 0.25;
            const Bounce b = bench.run(c);
            const double errors[3] = {b.restitution - reference.restitution,
                                      b.duration / reference.duration - 1.0, b.peak / reference.peak - 1.0};
            fmt::print("{:8} {:6} {:12.4f} {:9.2f}% {:9.2f}%\n", reference.speed_ratio, resolutions[i],
                       errors[0], 100.0 * errors[1], 100.0 * errors[2]);
            if (i > 0)
                chart.lines.push_back(
                    {fmt::format("R/dx = {}", resolutions[i]), b.time, b.force, static_cast<int>(i)});
            if (resolutions[i] < 24) continue;
            const std::string where =
                fmt::format("V/c0 {}, R/dx {}: ", reference.speed_ratio, resolutions[i]);
            checks.at_most(where + "error of restitution", std::abs(errors[0]), 0.01);
            checks.at_most(where + "error of duration", std::abs(errors[1]), 0.03);
            checks.at_most(where + "error of peak force", std::abs(errors[2]), 0.05);
        }
        chart.lines.push_back({"reference: peak", {0, 9}, {reference.peak, reference.peak}, 0, true});
        charts.push_back(chart);
    }
}

/// Full slip: the tangential change of velocity is mu times the normal one, and so is the change of spin.
void report_slip(Bench& bench, ReportChecks& checks) {
    fmt::print(
        "\nOffset 1.4 R, friction 0.1 (slips throughout): |dv_t|/|dv_n| and k R |d omega|/|dv_n|, both 0.1\n"
        "{:>6} {:>10} {:>10}\n",
        "R/dx", "velocity", "spin");
    for (const double r_over_dx : {6.0, 12.0}) {
        Case c;
        c.r_over_dx = r_over_dx;
        c.mu = 0.1;
        c.offset = 1.4;
        c.shift = 0.25;
        const Bounce b = bench.run(c);
        fmt::print("{:6} {:10.4f} {:10.4f}\n", r_over_dx, b.slip_ratio, b.spin_ratio);
        const std::string where = fmt::format("full slip, R/dx {}: error over mu, ", r_over_dx);
        checks.at_most(where + "velocity", std::abs(b.slip_ratio / c.mu - 1.0), 0.1);
        checks.at_most(where + "spin", std::abs(b.spin_ratio / c.mu - 1.0), 0.1);
    }
}

/// Unequal radii, densities, stiffnesses, and all three at once.
void report_unequal(Bench& bench, const ReportOptions& options, ReportChecks& checks) {
    fmt::print(
        "\nUnequal disks, head-on, second over first\n{:>8} {:>8} {:>10} {:>6} {:>12} {:>8} {:>10} {:>18}\n",
        "radius", "density", "stiffness", "R/dx", "restitution", "t_c", "spin", "|F_1 + F_2|/F_max");
    struct Ratios {
        double size, density, stiffness;
    };
    std::vector<Ratios> all = {{0.5, 1, 1}, {1, 4, 1}, {1, 1, 4}, {0.5, 4, 4}};
    if (options.short_mode) all = {{0.5, 4, 4}};
    for (const Ratios& ratios : all)
        for (const double r_over_dx : {12.0, 24.0}) {
            if (options.short_mode && r_over_dx > 12.0) continue;
            Case c;
            c.r_over_dx = r_over_dx;
            c.size_ratio = ratios.size;
            c.density_ratio = ratios.density;
            c.stiffness_ratio = ratios.stiffness;
            c.shift = 0.25;
            const Bounce b = bench.run(c);
            fmt::print("{:8} {:8} {:10} {:6} {:12.4f} {:8.3f} {:10.4f} {:18.1e}\n", ratios.size,
                       ratios.density, ratios.stiffness, r_over_dx, b.restitution, b.duration, b.spin,
                       b.force_mismatch);
            const std::string where = fmt::format("unequal {}/{}/{}, R/dx {}: ", ratios.size, ratios.density,
                                                  ratios.stiffness, r_over_dx);
            checks.at_least(where + "restitution", b.restitution, 0.9);
            checks.at_most(where + "force is not equal and opposite", b.force_mismatch, 1e-12);
            checks.at_most(where + "spin", b.spin, 0.1);
        }
}

/// All rules and couplings side by side.
void report_rules(Bench& bench, std::vector<Chart>& charts) {
    struct Method {
        std::string rule, coupling;
    };
    const std::vector<Method> methods = {
        {"pair", "impulse"}, {"pair", "flip"}, {"seed", "flip"}, {"seed", "impulse"}};
    fmt::print(
        "\nRules, R/dx = 12, V = 1 m/s, over shifts 0 and 0.25 and angles 0 and 30: mean (least..largest)\n"
        "{:14} {:>22} {:>22} {:>22} {:>10} {:>10}\n",
        "rule/coupling", "restitution", "t_c c0/R", "spin", "dP", "dL");
    Chart chart{"Rules, R/dx = 12, V/c0 = 0.021", "t c0/R", "F/(E* R)", {}};
    for (std::size_t i = 0; i < methods.size(); ++i) {
        Case c;
        c.rule = methods[i].rule;
        c.coupling = methods[i].coupling;
        const std::vector<Bounce> bounces = bench.run_all(c, {0, 0.25}, {0, 30});
        const std::string label = c.rule + "/" + c.coupling;
        fmt::print("{:14} {:>22} {:>22} {:>22} {:10.1e} {:10.1e}\n", label,
                   text(spread(bounces, &Bounce::restitution)), text(spread(bounces, &Bounce::duration)),
                   text(spread(bounces, &Bounce::spin)), spread(bounces, &Bounce::linear_error).largest,
                   spread(bounces, &Bounce::angular_error).largest);
        chart.lines.push_back({label, bounces[3].time, bounces[3].force, static_cast<int>(i)});
    }
    charts.push_back(chart);
}

int report(const ReportOptions& options) {
    Bench bench(options.directory);
    ReportChecks checks;
    std::vector<Chart> charts;
    report_reference(bench, options, checks, charts);
    report_scatter(bench, options, checks, charts);
    report_slip(bench, checks);
    report_unequal(bench, options, checks);
    if (!options.short_mode) report_rules(bench, charts);
    bench.finish(checks);
    if (!options.short_mode) draw_charts(charts, 2, options.directory + "/two_disks.png");
    return checks.verdict();
}

}  // namespace

int main(int argc, char** argv) {
    return quern::report_main(argc, argv, "two_disks", report);
}
