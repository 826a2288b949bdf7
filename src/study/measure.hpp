// The numbers that runs of one deck are compared by.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "src/deck/deck.hpp"
#include "src/study/run_files.hpp"

namespace quern {

/// What a quantity is, the same in all runs of a study.
struct QuantityKind {
    std::string group;  ///< heading of its table
    std::string key;    ///< for programs: "contact.0.restitution"
    std::string name, unit;
    bool less_is_better = false;  ///< false: no verdict
    double round_off = 0.0;       ///< values below it are equally good
    double noise = 0.0;           ///< relative: values closer than this are equally good
    bool has_order = false;       ///< an error or a cost: its slope over a resolution says something
};

struct Quantity {
    QuantityKind kind;
    double value = 0.0;  ///< NaN: the run has none
};

/// Times and memory of the repeats of a run, in their median.
struct RunCost {
    double step_seconds = 0;  ///< wall time of the steps, without output
    double ns_per_particle_step = 0, peak_memory_bytes = 0;
    double noise = 0;  ///< of the times, relative: half of largest less smallest over the median
    std::vector<std::pair<std::string, double>> stages;  ///< [s]
};
/// Noise that is assumed at least, and where nothing is repeated.
constexpr double least_noise = 0.03, unknown_noise = 0.1;

RunCost median_cost(const std::vector<RunSummary>& repeats);

/// Trajectories that others are compared with: columns time, x, y, (z), angle, omega of each grain.
using Trajectories = std::map<int, Columns>;

/// Value of a column at a time, linear between rows; NaN outside of them or without the column.
double value_at(const Columns& rows, const std::string& column, double time);

/// The grains whose contacts and final states are told one by one: the first eight that are tracked.
std::vector<int> told_grains(const RunFiles& run);

/// All quantities of a run, in the order of the report. `reference` may be null; `closer_is_better`: it is
/// the truth, so that differences to it are errors.
std::vector<Quantity> measure(const Deck& deck, const RunFiles& run, const RunCost& cost,
                              const Trajectories* reference, bool closer_is_better);

/// Size of the contact force on a grain at each row [N; 2D: N/m].
std::vector<double> force_size(const Columns& rows, int dimension);

/// Damping, friction, contact loss, fracture and transfer loss up to each row of a history [J; 2D: J/m].
std::vector<double> energy_lost(const Columns& history);

}  // namespace quern
