// A disk on an inclined plane: cases, the rigid disk, and what a run shows against it.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>
#include <numbers>
#include <string>
#include <vector>

#include "src/sim/study.hpp"

namespace quern::incline {

inline const std::string deck = EXAMPLE_DIR "/disk.yaml";
inline constexpr double g = 9.8, radius = 0.5, particles_per_cell = 2.0;
inline constexpr std::array spin_times = {0.25, 0.5, 0.75, 1.0};  ///< [s]

struct Incline {
    double mu, degrees;
    std::string name() const { return fmt::format("mu {}, {} deg", mu, degrees); }
};
inline const std::array inclines = {Incline{0.3, 60}, Incline{0.9, 60}, Incline{0.5, 60}, Incline{0.5, 30}};
inline const Incline rolling_gentle = inclines[3], slipping = inclines[2];

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

/// Runs a case with results in DIRECTORY/run.
inline Motion move(const Case& c, const std::string& directory) {
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

}  // namespace quern::incline
