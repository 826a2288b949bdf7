// 51 grains under a lid that comes down: force against displacement, with both ways of contact and several
// speeds.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/results/frame_file.hpp"
#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace {

using namespace quern;

const std::string deck_file = EXAMPLE_DIR "/compression_51.yaml";
constexpr double slice = 0.05e-3;              ///< of displacement, over which forces are averaged [m]
constexpr double foot = 300.0, knee = 1100.0;  ///< forces between which the line is fitted [N/m]

constexpr double none = std::numeric_limits<double>::quiet_NaN();

struct Compression {
    std::vector<double> u, force;     ///< displacement of the lid and force on it, mean of a slice [m, N/m]
    double stiffness = 0, touch = 0;  ///< of the line F = stiffness (u - touch) through the first rise
    double yield = none, yield_at = none;  ///< where the force falls a quarter below the line, if it does
    double peak = 0, peak_at = 0;          ///< largest force
    double fracture = 0, broken = 0;       ///< energy of cracks [J/m]; share of broken bonds
    double work_error = 0;                 ///< works of all walls less the external work, over it
    double residual = 0, momentum_error = 0, step_seconds = 0;

    double mean_force(double from, double to) const {
        double sum = 0, n = 0;
        for (std::size_t i = 0; i < u.size(); ++i)
            if (u[i] > from && u[i] < to) sum += force[i], n += 1;
        return sum / n;
    }
};

/// Least squares through the slices from the first above `foot` to the first above `knee`, and what follows.
void fit(Compression& c) {
    const auto above = [&](double limit) {
        return static_cast<std::size_t>(
            std::find_if(c.force.begin(), c.force.end(), [&](double f) { return f > limit; }) -
            c.force.begin());
    };
    const std::size_t first = above(foot), last = std::min(above(knee) + 1, c.u.size());
    double n = 0, su = 0, sf = 0, suu = 0, suf = 0;
    for (std::size_t i = first; i < last; ++i) {
        n += 1, su += c.u[i], sf += c.force[i];
        suu += c.u[i] * c.u[i], suf += c.u[i] * c.force[i];
    }
    c.stiffness = (n * suf - su * sf) / (n * suu - su * su);
    c.touch = (su - sf / c.stiffness) / n;
    for (std::size_t i = last; i < c.u.size() && std::isnan(c.yield); ++i)
        if (c.force[i] < 0.75 * c.stiffness * (c.u[i] - c.touch)) c.yield = c.force[i], c.yield_at = c.u[i];
    const auto most = std::max_element(c.force.begin(), c.force.end());
    c.peak = *most;
    c.peak_at = c.u[static_cast<std::size_t>(most - c.force.begin())];
}

double share_of_broken_bonds(const std::string& directory) {
    const FrameFileReader frames(directory + "/results.h5");
    const Frame last = frames.read(frames.n_frames() - 1);
    double broken = 0, all = 0;
    for (std::size_t i = 0; i < last.n(); ++i) {
        broken += last.volume[i] * static_cast<double>(last.damage[i]);
        all += last.volume[i];
    }
    return broken / all;
}

Compression compress(const std::vector<std::string>& overrides, const std::string& directory) {
    const RunRecord record = run_case(deck_file, overrides, directory);
    Compression c;
    std::vector<double> count;
    double work = 0;
    for (const ReactionRow& row : record.reactions) {
        if (row.time == record.history.back().time) work += row.work;
        if (row.name != "lid" || row.time == 0.0) continue;
        const auto k = static_cast<std::size_t>(-row.displacement[1] / slice);
        if (k >= c.u.size()) {
            c.u.resize(k + 1), c.force.resize(k + 1), count.resize(k + 1);
            c.u[k] = (static_cast<double>(k) + 0.5) * slice;
        }
        c.force[k] += row.force[1];
        count[k] += 1;
    }
    for (std::size_t k = 0; k < c.u.size(); ++k) c.force[k] /= count[k];
    fit(c);
    const EnergyBudget& energy = record.summary.energy;
    c.fracture = energy.fracture;
    c.broken = share_of_broken_bonds(directory);
    c.work_error = std::abs(work - energy.external_work) / energy.external_work;
    c.residual = record.summary.residual_relative;
    c.momentum_error = record.summary.momentum_error_linear;
    c.step_seconds = record.summary.wall_seconds / static_cast<double>(record.summary.steps);
    return c;
}

struct Case {
    std::string method, speed;
    std::vector<std::string> more = {};
    std::string name() const { return fmt::format("{}, {} m/s", method, speed); }
    std::vector<std::string> overrides() const {
        std::vector<std::string> all = {"params.method=" + method, "params.lid_speed=" + speed};
        all.insert(all.end(), more.begin(), more.end());
        return all;
    }
};

Compression run(const Case& c, const std::string& directory, ReportTable& table) {
    const Compression r = compress(c.overrides(), directory);
    fmt::print("{:20} {:9.3g} {:7.2f} {:8.0f} {:5.2f} {:8.0f} {:5.2f} {:9.3f} {:8.4f} {:9.1e} {:8.2f}\n",
               c.name(), r.stiffness, 1e3 * r.touch, r.yield, 1e3 * r.yield_at, r.peak, 1e3 * r.peak_at,
               r.fracture, r.broken, r.residual, 1e3 * r.step_seconds);
    table.add(c.name(), {r.stiffness, r.touch, r.yield, r.yield_at, r.peak, r.peak_at, r.fracture, r.broken,
                         r.work_error, r.residual, r.momentum_error, r.step_seconds});
    return r;
}

/// Mean difference of two curves from `from` on, over the mean force.
double difference(const Compression& a, const Compression& b, double from) {
    double sum = 0, all = 0;
    for (std::size_t i = 0; i < std::min(a.u.size(), b.u.size()); ++i)
        if (a.u[i] > from) sum += std::abs(a.force[i] - b.force[i]), all += 0.5 * (a.force[i] + b.force[i]);
    return sum / all;
}

Chart chart(const std::string& title, const std::vector<std::pair<std::string, Compression>>& curves) {
    Chart chart{title, "displacement of the lid [mm]", "force on the lid [N/m]", {}, false, false, true};
    int color = 0;
    for (const auto& [name, c] : curves) {
        std::vector<double> u = c.u;
        for (double& x : u) x *= 1e3;
        chart.lines.push_back({name, u, c.force, color++, false, false, true});
    }
    return chart;
}

void check_budget(const std::string& name, const Compression& c, double residual, ReportChecks& checks) {
    checks.at_most(name + ": energy residual", c.residual, residual);
    checks.at_most(name + ": momentum error", c.momentum_error, 1e-12);
    checks.at_most(name + ": works of the walls against the external work", c.work_error, 1e-11);
}

int body(const ReportOptions& options) {
    ReportTable table({"stiffness", "touch", "yield", "yield_at", "peak", "peak_at", "fracture", "broken",
                       "work_error", "residual", "momentum_error", "step_seconds"});
    ReportChecks checks;
    const std::string at = options.directory + "/";
    fmt::print("{:20} {:>9} {:>7} {:>8} {:>5} {:>8} {:>5} {:>9} {:>8} {:>9} {:>8}\n", "case", "stiffness",
               "touch", "yield", "at", "peak", "at", "fracture", "broken", "energy", "a step");
    fmt::print("{:20} {:>9} {:>7} {:>8} {:>5} {:>8} {:>5} {:>9} {:>8} {:>9} {:>8}\n", "", "[N/m^2]", "[mm]",
               "[N/m]", "[mm]", "[N/m]", "[mm]", "[J/m]", "bonds", "residual", "[ms]");
    if (options.short_mode) {
        const std::vector<std::string> less = {"params.stroke=1.7 mm"};
        const Compression grid = run({"grid", "1.2", less}, at + "grid", table);
        const Compression pairs = run({"node_pair", "1.2", less}, at + "pairs", table);
        check_budget("grid", grid, 1e-3, checks);
        check_budget("node pairs", pairs, 1e-2, checks);
        checks.at_least("grid: force behind 1.2 mm [N/m]", grid.mean_force(1.2e-3, 1.7e-3), 800);
        checks.at_least("node pairs: force behind 1.2 mm [N/m]", pairs.mean_force(1.2e-3, 1.7e-3), 1000);
        checks.at_least("broken bonds, smaller of both", std::min(grid.broken, pairs.broken), 1e-4);
        table.write(options.directory, "compression");
        return checks.verdict();
    }
    std::vector<std::pair<std::string, Compression>> methods, rates, grid_rates;
    for (const char* speed : {"0.15", "0.3", "0.6", "1.2"}) {
        const std::string label = std::string(speed) + " m/s";
        // Only on the grid particles pass the walls: a tight box is a large picture.
        rates.emplace_back(label,
                           run({"node_pair", speed, {"params.margin=1 mm"}}, at + "pairs_" + speed, table));
        grid_rates.emplace_back(label, run({"grid", speed}, at + "grid_" + speed, table));
    }
    const Compression &pairs = rates[1].second, &grid = grid_rates[1].second;
    methods = {{"grid", grid}, {"node pairs", pairs}};
    draw_charts({chart("Two ways of contact, 0.3 m/s", methods), chart("Grid: speeds of the lid", grid_rates),
                 chart("Node pairs: speeds of the lid", rates)},
                3, at + "force.png");
    for (const int frame : {50, 64, 80, 100})
        render({.directory = at + "pairs_0.3",
                .file = fmt::format("{}damage_{}.png", at, frame),
                .field = "damage",
                .frame = std::to_string(frame),
                .width = 620,
                .height = 560});
    check_budget("grid", grid, 1e-3, checks);
    check_budget("node pairs", pairs, 1e-2, checks);
    checks.at_most("grid: 0.3 against 0.15 m/s, from 1.25 mm on",
                   difference(grid, grid_rates[0].second, 1.25e-3), 0.25);
    checks.at_most("node pairs: 0.3 against 0.15 m/s, from 1.25 mm on",
                   difference(pairs, rates[0].second, 1.25e-3), 0.1);
    checks.at_most("grid against node pairs up to 1.4 mm",
                   std::abs(grid.mean_force(1e-3, 1.4e-3) / pairs.mean_force(1e-3, 1.4e-3) - 1.0), 0.25);
    checks.at_most("grid against node pairs behind 1.8 mm",
                   std::abs(grid.mean_force(1.8e-3, 2.2e-3) / pairs.mean_force(1.8e-3, 2.2e-3) - 1.0), 0.25);
    table.write(options.directory, "compression");
    return checks.verdict();
}

}  // namespace

int main(int argc, char** argv) {
    return report_main(argc, argv, "compression", body);
}
