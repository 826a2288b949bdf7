// Cracks from two notches in a plate that is hit between them: their angle, and that both are alike.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "src/results/frame_file.hpp"
#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace {

using namespace quern;

const std::string deck = EXAMPLE_DIR "/plate.yaml";
constexpr double notch = 0.025;  ///< height of a notch above the middle of the plate [m]
constexpr double broken = 0.3;   ///< damage of what a crack has gone through

/// Of the angle [deg], as asked for.
constexpr double least_angle = 65.0, largest_angle = 72.0;

struct Case {
    std::string label;
    double dx = 1e-3, m = 3.015;
    std::vector<std::string> overrides = {};
    bool checked = true;  ///< else shown only
};

/// A straight line through the damaged particles of one side, weighted by damage: x = x0 + y/tan(angle).
struct Fit {
    double angle = 0.0;  ///< [deg]
    double reach = 0.0;  ///< farthest damaged particle above the notch [m]
};

/// From `low` to `top` above the notch of one side.
Fit fit_crack(const Frame& start, const Frame& frame, double side, double low, double top) {
    double n = 0.0, x_mean = 0.0, y_mean = 0.0;
    Fit fit;
    const auto each = [&](auto&& visit) {
        for (std::size_t p = 0; p < frame.n(); ++p) {
            const double x = start.position[2 * p], y = side * start.position[2 * p + 1] - notch;
            // What lies farther ahead belongs to the crack from the far edge.
            const bool own = y > 0.0 && x < 0.006 + y / std::tan(50.0 * std::numbers::pi / 180.0);
            if (frame.damage[p] > broken && own) visit(x, y, static_cast<double>(frame.damage[p]));
        }
    };
    each([&](double x, double y, double d) {
        fit.reach = std::max(fit.reach, y);
        if (y < low || y > top) return;
        n += d;
        x_mean += d * x;
        y_mean += d * y;
    });
    x_mean /= n;
    y_mean /= n;
    double xy = 0.0, yy = 0.0;
    each([&](double x, double y, double d) {
        if (y < low || y > top) return;
        xy += d * (x - x_mean) * (y - y_mean);
        yy += d * (y - y_mean) * (y - y_mean);
    });
    fit.angle = std::atan2(yy, xy) * 180.0 / std::numbers::pi;
    return fit;
}

struct Outcome {
    double angle = 0.0, first_angle = 0.0, difference = 0.0;  ///< [deg]
    double start = 0.0, top_speed = 0.0;                      ///< [s], [m/s]
    double reach = 0.0, residual = 0.0;
};

Outcome run_plate(const Case& c, const std::string& directory) {
    std::vector<std::string> overrides = {fmt::format("params.dx={} m", c.dx),
                                          fmt::format("params.m={}", c.m)};
    for (const std::string& item : c.overrides) overrides.push_back("params." + item);
    const RunRecord run = run_case(deck, overrides, directory);
    const FrameFileReader file(directory + "/results.h5");
    const Frame start = file.read(0), end = file.read(file.n_frames() - 1);
    const double horizon = c.m * c.dx, top = 0.075 - 3.0 * horizon;
    const Fit up = fit_crack(start, end, 1.0, horizon, top), down = fit_crack(start, end, -1.0, horizon, top);
    Outcome o;
    o.angle = 0.5 * (up.angle + down.angle);
    o.difference = std::abs(up.angle - down.angle);
    o.first_angle = fit_crack(start, end, 1.0, horizon, 0.3 * top).angle;
    o.reach = std::min(up.reach, down.reach);
    o.residual = run.summary.residual_relative;
    double before = 0.0, time_before = 0.0;
    for (std::size_t f = 0; f < file.n_frames(); ++f) {
        const Frame frame = file.read(f);
        const double reach = fit_crack(start, frame, 1.0, horizon, top).reach;
        if (reach > 0.0 && o.start == 0.0) o.start = frame.time;
        if (before > 0.0 && reach < top)
            o.top_speed =
                std::max(o.top_speed, (reach - before) / std::sin(o.angle * std::numbers::pi / 180.0) /
                                          (frame.time - time_before));
        before = reach;
        time_before = frame.time;
    }
    return o;
}

int body(const ReportOptions& options) {
    std::vector<Case> cases = {{"dx 1 mm, horizon 3 dx"}};
    if (!options.short_mode) {
        cases.push_back({"horizon 4 dx", 1e-3, 4.015, {}, false});
        cases.push_back({"nu 0.3", 1e-3, 3.015, {"nu=0.3"}, false});
        cases.push_back({"nu 0.3, by energy", 1e-3, 3.015, {"nu=0.3", "by=energy"}, false});
    }
    ReportTable table({"dx", "m", "angle", "first_angle", "difference", "start", "top_speed"});
    ReportChecks checks;
    for (const Case& c : cases) {
        const std::string directory = options.directory + "/run";
        const Outcome o = run_plate(c, directory);
        fmt::print("{}: angle {:.1f} deg (first third {:.1f}), starts at {:.0f} us, top speed {:.0f} m/s\n",
                   c.label, o.angle, o.first_angle, 1e6 * o.start, o.top_speed);
        table.add(c.label, {c.dx, c.m, o.angle, o.first_angle, o.difference, o.start, o.top_speed});
        if (&c == &cases.front()) render({directory, options.directory + "/damage.png", "damage"});
        if (!c.checked) continue;
        checks.at_least(c.label + ": angle [deg]", o.angle, least_angle);
        checks.at_most(c.label + ": angle [deg]", o.angle, largest_angle);
        checks.at_least(c.label + ": cracks reach above the notch [mm]", 1e3 * o.reach, 70.0);
        checks.at_most(c.label + ": upper and lower angle differ by [deg]", o.difference, 1.0);
        checks.at_most(c.label + ": energy residual", o.residual, 1e-3);
    }
    table.write(options.directory, "kalthoff_winkler");
    return checks.verdict();
}

}  // namespace

int main(int argc, char** argv) {
    return quern::report_main(argc, argv, "kalthoff_winkler", body);
}
