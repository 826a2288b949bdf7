// A crack that runs through glass: it branches once, in two like halves, and stays below the Rayleigh speed.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "src/results/frame_file.hpp"
#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace {

using namespace quern;

const std::string deck = EXAMPLE_DIR "/plate.yaml";
constexpr double broken = 0.3;  ///< damage of what a crack has gone through

/// Rayleigh speed [m/s], (0.862 + 1.14 nu)/(1 + nu) of sqrt(G/rho): Viktorov, as in Freund, Dynamic Fracture
/// Mechanics (1990); nu and G hold in plane stress as well with nu/(1 + nu) in the place of nu.
double rayleigh_speed(double young, double poisson, double density) {
    const double G = young / (2.0 * (1.0 + poisson)), plane = poisson / (1.0 + poisson);
    return (0.862 + 1.14 * plane) / (1.0 + plane) * std::sqrt(G / density);
}

struct Case {
    std::string label;
    double dx = 0.25e-3, m = 4.0;
    std::vector<std::string> overrides = {};
    double horizon() const { return m * dx; }
};

struct Outcome {
    std::vector<double> time, tip, speed;  ///< [s], of the farthest damaged particle [m], [m/s]
    double top_speed = 0.0;                ///< [m/s]
    int most_cracks = 0;                   ///< next to each other, of all columns
    double branch = 0.0;                   ///< where two cracks begin [m]
    double two = 0.0;                      ///< part of the columns behind `branch` with two of them
    double opening = 0.0;                  ///< between the branches at the end [m]
    double asymmetry = 0.0;                ///< mean |d(x, y) - d(x, -y)| over the mean of d
    double residual = 0.0;
    double fracture = 0.0;  ///< [J/m]
};

/// Cracks that cross a column of particles: y of their middles.
std::vector<double> cracks_in(std::vector<std::pair<double, float>> column, double horizon) {
    std::vector<double> middles;
    double low = 0.0, high = -1e300;
    for (const auto& [y, damage] : column) {
        if (damage < broken) continue;
        if (y - high > horizon) {
            middles.push_back(y);
            low = y;
        }
        high = y;
        middles.back() = 0.5 * (low + high);
    }
    return middles;
}

Outcome run_plate(const Case& c, const std::string& directory) {
    std::vector<std::string> overrides = {fmt::format("params.dx={} m", c.dx),
                                          fmt::format("params.m={}", c.m)};
    for (const std::string& item : c.overrides) overrides.push_back("params." + item);
    const RunRecord run = run_case(deck, overrides, directory);
    Outcome o;
    o.residual = run.summary.residual_relative;
    o.fracture = run.summary.energy.fracture;
    const FrameFileReader file(directory + "/results.h5");
    const Frame start = file.read(0);
    for (std::size_t f = 0; f < file.n_frames(); ++f) {
        const Frame frame = file.read(f);
        double tip = 0.0;
        for (std::size_t p = 0; p < frame.n(); ++p)
            if (frame.damage[p] > broken) tip = std::max(tip, start.position[2 * p]);
        o.time.push_back(frame.time);
        o.tip.push_back(tip);
    }
    // Over two frames, while the crack runs and has not come to the edge.
    for (std::size_t f = 1; f + 1 < o.time.size(); ++f) {
        const bool runs = o.tip[f - 1] > 0.0 && o.tip[f + 1] < 0.05 - c.horizon();
        o.speed.push_back(runs ? (o.tip[f + 1] - o.tip[f - 1]) / (o.time[f + 1] - o.time[f - 1]) : 0.0);
        o.top_speed = std::max(o.top_speed, o.speed.back());
    }
    const Frame end = file.read(file.n_frames() - 1);
    std::map<long, std::vector<std::pair<double, float>>> columns;
    std::map<std::pair<long, long>, double> damage;
    const auto index = [&](double value) { return std::lround(2.0 * value / c.dx); };
    double sum = 0.0;
    for (std::size_t p = 0; p < end.n(); ++p) {
        const double x = start.position[2 * p], y = start.position[2 * p + 1];
        columns[index(x)].emplace_back(y, end.damage[p]);
        damage[{index(x), index(y)}] = end.damage[p];
        sum += end.damage[p];
    }
    for (const auto& [at, value] : damage)
        o.asymmetry += std::abs(value - damage.at({at.first, -at.second})) / sum;
    double n_behind = 0.0;
    for (const auto& [at, column] : columns) {
        const double x = 0.5 * c.dx * static_cast<double>(at);
        if (x < 0.0 || x > 0.05 - 1.5 * c.horizon()) continue;
        const std::vector<double> middles = cracks_in(column, 0.6 * c.horizon());
        const int n = static_cast<int>(middles.size());
        o.most_cracks = std::max(o.most_cracks, n);
        if (n >= 2 && o.branch == 0.0) o.branch = x;
        if (o.branch == 0.0) continue;
        n_behind += 1.0;
        o.two += n == 2 ? 1.0 : 0.0;
        if (n == 2) o.opening = middles[1] - middles[0];
    }
    if (n_behind > 0.0) o.two /= n_behind;
    return o;
}

int body(const ReportOptions& options) {
    const double c_R = rayleigh_speed(72e9, 0.22, 2440.0);
    std::vector<Case> cases = {{"horizon 2 mm, m 4", 0.5e-3, 4.0}};
    if (!options.short_mode)
        cases.insert(cases.begin(),
                     {{"horizon 1 mm, m 4", 0.25e-3, 4.0}, {"horizon 1.5 mm, m 3", 0.5e-3, 3.0}});
    ReportTable table(
        {"horizon", "branch_m", "most_cracks", "two", "opening_m", "asymmetry", "top_speed", "fracture"});
    ReportChecks checks;
    Chart chart{"Speed of the crack", "time [us]", "speed [m/s]", {}};
    fmt::print("Rayleigh speed {:.0f} m/s\n\n", c_R);
    for (const Case& c : cases) {
        const std::string directory = options.directory + fmt::format("/case_{}", chart.lines.size());
        const Outcome o = run_plate(c, directory);
        fmt::print(
            "{}: branches at {:.1f} mm, {:.1f} mm apart at the end; top speed {:.0f} m/s = {:.2f} c_R; "
            "{:.3f} J/m\n",
            c.label, 1e3 * o.branch, 1e3 * o.opening, o.top_speed, o.top_speed / c_R, o.fracture);
        checks.at_most(c.label + ": cracks next to each other, most", o.most_cracks, 2);
        checks.at_least(c.label + ": columns with two behind the branch", o.two, 0.9);
        checks.at_least(c.label + ": branches behind the notch [mm]", 1e3 * o.branch, 5.0);
        checks.at_most(c.label + ": asymmetry", o.asymmetry, 0.05);
        checks.at_most(c.label + ": top speed over Rayleigh speed", o.top_speed / c_R, 0.75);
        checks.at_most(c.label + ": energy residual", o.residual, 1e-4);
        table.add(c.label, {c.horizon(), o.branch, static_cast<double>(o.most_cracks), o.two, o.opening,
                            o.asymmetry, o.top_speed, o.fracture});
        ChartLine line{c.label, {}, {}, static_cast<int>(chart.lines.size())};
        for (std::size_t f = 0; f < o.speed.size(); ++f)
            if (o.speed[f] > 0.0) {
                line.x.push_back(1e6 * o.time[f + 1]);
                line.y.push_back(o.speed[f]);
            }
        chart.lines.push_back(line);
        render(
            {directory, options.directory + fmt::format("/damage_{}.png", chart.lines.size() - 1), "damage"});
    }
    chart.lines.push_back({"Rayleigh", {5.0, 46.0}, {c_R, c_R}, 7, true});
    draw_charts({chart}, 1, options.directory + "/speed.png");
    table.write(options.directory, "branching_plate");
    return checks.verdict();
}

}  // namespace

int main(int argc, char** argv) {
    return quern::report_main(argc, argv, "branching_plate", body);
}
