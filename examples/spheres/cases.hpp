// What the reports of the spheres share: the decks' numbers, and how a case is run.
#pragma once

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "src/deck/read_deck.hpp"
#include "src/mesh/make_shape.hpp"
#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace quern::spheres {

constexpr double radius = 0.5, density = 3000.0, g = 9.8;  // of the decks
inline const std::string folder = EXAMPLE_DIR;

inline std::string override_of(const std::string& name, double value) {
    return fmt::format("params.{}={}", name, value);
}

/// Moment of inertia of the particles of a deck's first shape, over M R^2.
inline double inertia_of(const std::string& deck, const std::vector<std::string>& overrides) {
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
    double energy_residual = 0.0;                    ///< largest of all runs

    RunRecord run(const std::string& deck, const std::vector<std::string>& overrides,
                  const std::string& directory = "case") {
        RunRecord record = run_case(folder + deck, overrides, options.directory + "/" + directory);
        energy_residual = std::max(energy_residual, record.summary.residual_relative);
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

}  // namespace quern::spheres
