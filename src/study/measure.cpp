#include "src/study/measure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "src/study/contacts.hpp"
#include "src/study/encounter.hpp"

namespace quern {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double momentum_round_off = 1e-12, residual_round_off = 1e-12, small_part = 0.02;
constexpr std::size_t most_told = 8;
constexpr const char* losses[] = {"damping",  "friction", "contact_loss",
                                  "fracture", "plastic",  "transfer_loss"};
constexpr std::array<const char*, 3> axes = {"x", "y", "z"}, forces = {"fx", "fy", "fz"};

double median(std::vector<double> values) {
    if (values.empty()) return none;
    std::sort(values.begin(), values.end());
    const std::size_t n = values.size();
    return 0.5 * (values[(n - 1) / 2] + values[n / 2]);
}

class Measurement {
  public:
    Measurement(const Deck& deck, const RunFiles& run, const RunCost& cost, const Trajectories* reference,
                bool closer_is_better)
        : deck_(deck), run_(run), cost_(cost), reference_(reference), closer_is_better_(closer_is_better) {}

    std::vector<Quantity> take() {
        add_energies();
        add_momenta();
        for (const int grain : told_grains(run_)) add_contact(grain);
        add_differences();
        for (const int grain : told_grains(run_)) add_final_state(grain);
        add_cost();
        return std::move(list_);
    }

  private:
    void add(QuantityKind kind, double value) { list_.push_back({std::move(kind), value}); }
    double energy(const char* account) const { return run_.summary.number(std::string("energy.") + account); }

    void add_energies() {
        const std::string group = "Energy", unit = deck_.dimension == 2 ? "J/m" : "J";
        double lost = 0.0;
        for (const char* account : losses) lost += energy(account);
        add({group, "energy.lost", "lost, all accounts", unit}, lost);
        for (const char* account : losses)
            add({group, std::string("energy.") + account, account, unit}, energy(account));
        add({group, "energy.numerical_loss", "contact and transfer loss over the energy that changed hands",
             "", true, 1e-9, small_part, true},
            (energy("contact_loss") + energy("transfer_loss")) / energy("throughput"));
        for (const char* account : {"kinetic", "elastic", "gravity"})
            add({group, std::string("energy.") + account, std::string(account) + " at the end", unit},
                energy(account));
        add({group, "energy.external_work", "external work", unit}, energy("external_work"));
        add({group, "energy.residual_relative", "largest residual over the energy that changed hands", "",
             true, residual_round_off, small_part, true},
            energy("residual_relative"));
    }

    void add_momenta() {
        for (const char* which : {"linear", "angular"})
            add({"Momentum", std::string("momentum_error.") + which,
                 fmt::format("largest error of the {} momentum, relative", which), "", true,
                 momentum_round_off, small_part},
                run_.summary.number(std::string("momentum_error.") + which));
    }

    void add_contact(int grain) {
        const Columns& rows = run_.grains.at(grain);
        const ForceMeasures force = measure_force(*rows.find("time"), force_size(rows, deck_.dimension));
        const std::string group = fmt::format("Contact of grain {}", grain),
                          key = fmt::format("contact.{}.", grain), unit = deck_.dimension == 2 ? "N/m" : "N";
        const auto add_one = [&](const char* name, const std::string& text, const std::string& of,
                                 double value, bool less = false) {
            add({group, key + name, text, of, less, 0.0, small_part}, value);
        };
        const bool any = !force.contacts.empty();
        add_one("restitution", "restitution of the first contact", "",
                any ? first_restitution(deck_, run_, grain, force.contacts) : none);
        add_one("duration", "duration of the first contact", "s",
                any ? force.contacts.front().duration : none);
        add_one("count", "contacts", "", static_cast<double>(force.contacts.size()));
        add_one("time", "time in contact", "s", force.in_contact);
        add_one("peak", "peak force", unit, any ? force.peak : none);
        add_one("mean", "mean force in contact", unit, any ? force.mean : none);
        add_one("chatter", "chatter of the force", "", any ? force.chatter : none, true);
    }

    /// Over all tracked grains that the reference has, too.
    void add_differences() {
        if (!reference_ || run_.grains.empty()) return;
        double last = 0, path = 0, turn = 0, spin = 0, n_rows = 0, n_grains = 0;
        for (const auto& [grain, rows] : run_.grains) {
            const auto other = reference_->find(grain);
            if (other == reference_->end()) continue;
            const std::vector<double>& time = *rows.find("time");
            double square = none;
            for (std::size_t i = 0; i < time.size(); ++i) {
                const double now = distance(rows, i, other->second);
                if (!std::isfinite(now)) continue;
                square = now * now;
                path += square;
                ++n_rows;
            }
            last += square;
            turn = std::max(turn, last_difference(rows, other->second, "angle"));
            spin = std::max(spin, last_difference(rows, other->second, "omega"));
            ++n_grains;
        }
        const std::string group = "Difference to the reference";
        const auto add_one = [&](const char* key, const char* name, const char* unit, double value) {
            add({group, std::string("difference.") + key, name, unit, closer_is_better_, 0.0, small_part,
                 true},
                n_grains > 0 ? value : none);
        };
        add_one("trajectory", "positions over time, rms", "m", std::sqrt(path / n_rows));
        add_one("position", "final positions, rms", "m", std::sqrt(last / n_grains));
        add_one("angle", "final angles, largest", "rad", turn);
        add_one("omega", "final spins, largest", "rad/s", spin);
    }

    double distance(const Columns& rows, std::size_t i, const Columns& other) const {
        const double time = (*rows.find("time"))[i];
        double square = 0.0;
        for (int a = 0; a < deck_.dimension; ++a) {
            const double there = value_at(other, axes[static_cast<std::size_t>(a)], time);
            square += std::pow((*rows.find(axes[static_cast<std::size_t>(a)]))[i] - there, 2);
        }
        return std::sqrt(square);
    }

    static double last_difference(const Columns& rows, const Columns& other, const char* column) {
        const double difference =
            std::abs(rows.find(column)->back() - value_at(other, column, rows.find("time")->back()));
        return std::isfinite(difference) ? difference : 0.0;
    }

    void add_final_state(int grain) {
        const Columns& rows = run_.grains.at(grain);
        const std::string group = fmt::format("Final state of grain {}", grain);
        const auto add_one = [&](const char* column, const char* unit) {
            add({group, fmt::format("final.{}.{}", grain, column), column, unit}, rows.find(column)->back());
        };
        for (int a = 0; a < deck_.dimension; ++a) add_one(axes[static_cast<std::size_t>(a)], "m");
        add_one("angle", "rad");
        add_one("vx", "m/s");
        add_one("vy", "m/s");
        if (deck_.dimension == 3) add_one("vz", "m/s");
        add_one("omega", "rad/s");
    }

    void add_cost() {
        const std::string group = "Cost";
        const auto number = [&](const char* path) { return run_.summary.number(path); };
        add({group, "cost.n_particles", "particles", ""}, number("n_particles"));
        add({group, "cost.time_step", "time step", "s"}, number("time_step"));
        add({group, "cost.stable_step", "stable step", "s"}, number("stable_step"));
        add({group, "cost.steps", "steps", "", true, 0.0, small_part, true}, number("steps"));
        add({group, "cost.step_seconds", "wall time without output", "s", true, 0.0, cost_.noise, true},
            cost_.step_seconds);
        add({group, "cost.ns_per_particle_step", "cost of a particle and step", "ns", true, 0.0, cost_.noise,
             true},
            cost_.ns_per_particle_step);
        add({group, "cost.noise", "noise of the times, relative", ""}, cost_.noise);
        add({group, "cost.memory", "peak memory", "MB", true, 0.0, small_part, true},
            1e-6 * cost_.peak_memory_bytes);
        add({group, "cost.warnings", "warnings", ""}, run_.summary.n_warnings());
        const double particle_steps = number("n_particles") * number("steps");
        for (const auto& [stage, seconds] : cost_.stages) {
            add({"Cost by stage", "stage." + stage, stage, "ns per particle and step"},
                1e9 * seconds / particle_steps);
        }
    }

    const Deck& deck_;
    const RunFiles& run_;
    const RunCost& cost_;
    const Trajectories* reference_;
    bool closer_is_better_;
    std::vector<Quantity> list_;
};

}  // namespace

RunCost median_cost(const std::vector<RunSummary>& repeats) {
    const auto all = [&](const auto& number_of) {
        std::vector<double> values;
        for (const RunSummary& one : repeats) values.push_back(number_of(one));
        return values;
    };
    const auto of = [](const char* path) {
        return [path](const RunSummary& one) { return one.number(path); };
    };
    const auto step_seconds = [](const RunSummary& one) {
        return one.number("wall_seconds") - one.number("stages.output");
    };
    RunCost cost;
    const std::vector<double> wall = all(step_seconds);
    cost.step_seconds = median(wall);
    cost.ns_per_particle_step = median(all(of("ns_per_particle_step")));
    cost.peak_memory_bytes = median(all(of("peak_memory_bytes")));
    cost.noise = unknown_noise;
    if (repeats.size() > 1) {
        const auto [least, most] = std::minmax_element(wall.begin(), wall.end());
        cost.noise = std::max(least_noise, 0.5 * (*most - *least) / cost.step_seconds);
    }
    for (const auto& stage : repeats.front().members("stages")) {
        const std::string path = "stages." + stage.first;
        cost.stages.emplace_back(stage.first, median(all(of(path.c_str()))));
    }
    return cost;
}

double value_at(const Columns& rows, const std::string& column, double time) {
    const std::vector<double>*times = rows.find("time"), *values = rows.find(column);
    if (!times || !values || times->empty()) return none;
    const double slack = 1e-9 * std::max(std::abs(times->front()), std::abs(times->back()));
    if (time < times->front() - slack || time > times->back() + slack) return none;
    const auto after = std::lower_bound(times->begin(), times->end(), time);
    if (after == times->end()) return values->back();
    const auto i = static_cast<std::size_t>(after - times->begin());
    if (i == 0) return values->front();
    const double part = (time - (*times)[i - 1]) / ((*times)[i] - (*times)[i - 1]);
    return (*values)[i - 1] + part * ((*values)[i] - (*values)[i - 1]);
}

std::vector<int> told_grains(const RunFiles& run) {
    std::vector<int> grains;
    if (run.grains.size() > most_told) return grains;
    for (const auto& [grain, rows] : run.grains)
        if (rows.n_rows() > 1) grains.push_back(grain);
    return grains;
}

std::vector<Quantity> measure(const Deck& deck, const RunFiles& run, const RunCost& cost,
                              const Trajectories* reference, bool closer_is_better) {
    return Measurement(deck, run, cost, reference, closer_is_better).take();
}

std::vector<double> force_size(const Columns& rows, int dimension) {
    std::vector<double> size(rows.n_rows(), 0.0);
    for (int a = 0; a < dimension; ++a) {
        const std::vector<double>& part = *rows.find(forces[static_cast<std::size_t>(a)]);
        for (std::size_t i = 0; i < size.size(); ++i) size[i] = std::hypot(size[i], part[i]);
    }
    return size;
}

std::vector<double> energy_lost(const Columns& history) {
    std::vector<double> lost(history.n_rows(), 0.0);
    for (const char* account : losses)
        if (const std::vector<double>* column = history.find(account))
            for (std::size_t i = 0; i < lost.size(); ++i) lost[i] += (*column)[i];
    return lost;
}

}  // namespace quern
