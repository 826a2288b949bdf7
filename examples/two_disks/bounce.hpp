// One collision of the deck: what makes it a case of its own, and the numbers it is judged by.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "src/sim/study.hpp"

namespace quern {

constexpr double radius = 0.5, density = 3000.0;  // of the deck, as all below
constexpr double soft_modulus = 90.0 / 13.0 * 1e6, soft_poisson = 5.0 / 13.0;

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
    double linear_error = 0, angular_error = 0, energy_residual = 0;
    std::vector<double> time, force;  ///< for charts
};

inline double size_of(const double (&v)[3]) {
    return std::hypot(v[0], v[1]);
}

/// Largest mean of the force over a window of 0.08 R/c0, or one step if that is longer.
inline double filtered_peak(const std::vector<GrainRow>& rows, double window) {
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

inline Bounce measure(const Case& c, const RunRecord& record) {
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
    b.slip_ratio = across(change[0], change[1]) / normal;
    b.spin_ratio = inertia * first.back().omega * radius / normal;
    b.force_mismatch /= largest;
    const EnergyBudget& energy = record.history.back().energy;
    b.contact_loss = energy.contact_loss / record.history[0].energy.kinetic;
    b.vibration = energy.elastic / record.history[0].energy.kinetic;
    b.linear_error = record.summary.momentum_error_linear;
    b.angular_error = record.summary.momentum_error_angular;
    b.energy_residual = record.summary.residual_relative;
    return b;
}

}  // namespace quern
