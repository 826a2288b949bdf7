#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "src/results/render.hpp"
#include "src/study/comparison.hpp"
#include "src/study/table.hpp"

namespace quern {

namespace {

constexpr std::size_t most_drawn = 3;  ///< grains

std::string per_thickness(const Comparison& comparison, const char* unit) {
    return fmt::format("{}{}", unit, comparison.runs.front().deck.dimension == 2 ? "/m" : "");
}

class ComparisonCharts {
  public:
    ComparisonCharts(const Comparison& comparison, std::string folder)
        : comparison_(comparison), folder_(std::move(folder)) {
        for (std::size_t v = 0; v < comparison.variants.size(); ++v)
            if (comparison.run(comparison.last_level(), v).done()) shown_.push_back(v);
    }

    std::vector<std::string> draw() {
        if (shown_.empty()) return {};
        draw_trajectories();
        draw_forces();
        draw_energies();
        draw_momenta();
        draw_cost();
        if (comparison_.levels.size() > 1) draw_levels();
        return files_;
    }

  private:
    const ComparedRun& shown(std::size_t i) const {
        return comparison_.run(comparison_.last_level(), shown_[i]);
    }
    const std::string& name(std::size_t i) const { return comparison_.variants[shown_[i]].name; }
    int color(std::size_t i) const { return static_cast<int>(shown_[i]); }

    void save(std::vector<Chart> charts, int columns, const std::string& file) {
        if (charts.empty()) return;
        if (!comparison_.over.empty() && file != "levels.png")
            for (Chart& chart : charts)
                chart.title += ", " + comparison_.level_name(comparison_.last_level());
        draw_charts(charts, columns, folder_ + "/" + file);
        files_.push_back(file);
    }

    std::vector<int> drawn_grains() const {
        std::vector<int> grains;
        for (const auto& [grain, rows] : shown(0).files.grains)
            if (grains.size() < most_drawn && rows.n_rows() > 1) grains.push_back(grain);
        return grains;
    }

    /// A line a variant of a column of its rows of a grain.
    Chart grain_chart(int grain, const std::string& column, const std::string& label) const {
        Chart chart{fmt::format("grain {}", grain), "time [s]", label, {}, false, false, true};
        for (std::size_t i = 0; i < shown_.size(); ++i)
            if (const auto rows = shown(i).files.grains.find(grain); rows != shown(i).files.grains.end())
                chart.lines.push_back(
                    {name(i), *rows->second.find("time"), *rows->second.find(column), color(i)});
        const auto reference = comparison_.trajectories.find(grain);
        if (comparison_.reference_is_file && reference != comparison_.trajectories.end())
            add_reference(chart, reference->second, column);
        return chart;
    }

    /// As far as the runs reach.
    static void add_reference(Chart& chart, const Columns& rows, const std::string& column) {
        double end = 0.0;
        for (const ChartLine& line : chart.lines) end = std::max(end, line.x.back());
        const std::vector<double>*time = rows.find("time"), *values = rows.find(column);
        if (!values) return;
        ChartLine line{"reference", {}, {}, 7, true};
        for (std::size_t i = 0; i < time->size() && (*time)[i] <= end; ++i) {
            line.x.push_back((*time)[i]);
            line.y.push_back((*values)[i]);
        }
        chart.lines.push_back(std::move(line));
    }

    void draw_trajectories() {
        std::vector<Chart> charts;
        const bool flat = shown(0).deck.dimension == 2;
        for (const int grain : drawn_grains()) {
            charts.push_back(grain_chart(grain, "x", "x [m]"));
            charts.push_back(grain_chart(grain, "y", "y [m]"));
            if (!flat) charts.push_back(grain_chart(grain, "z", "z [m]"));
            charts.push_back(grain_chart(grain, "angle", "angle [rad]"));
        }
        save(charts, flat ? 3 : 4, "trajectories.png");
    }

    void draw_forces() {
        std::vector<Chart> charts;
        for (const int grain : drawn_grains()) {
            Chart chart{fmt::format("force on grain {}", grain),
                        "time [s]",
                        fmt::format("force [{}]", per_thickness(comparison_, "N")),
                        {},
                        false,
                        false,
                        true};
            bool any = false;
            for (std::size_t i = 0; i < shown_.size(); ++i) {
                const auto rows = shown(i).files.grains.find(grain);
                if (rows == shown(i).files.grains.end()) continue;
                const std::vector<double> force = force_size(rows->second, shown(i).deck.dimension);
                any = any || *std::max_element(force.begin(), force.end()) > 0.0;
                chart.lines.push_back({name(i), *rows->second.find("time"), force, color(i)});
            }
            if (any) charts.push_back(std::move(chart));
        }
        save(charts, 3, "forces.png");
    }

    void draw_energies() {
        std::vector<Chart> charts;
        const std::string unit = fmt::format(" [{}]", per_thickness(comparison_, "J"));
        const auto add = [&](const std::string& title, const auto& values_of) {
            Chart chart{title, "time [s]", "energy" + unit, {}, false, false, true};
            bool any = false;
            for (std::size_t i = 0; i < shown_.size(); ++i) {
                const Columns& history = shown(i).files.history;
                const std::vector<double> values = values_of(history);
                any = any || std::any_of(values.begin(), values.end(), [](double e) { return e != 0.0; });
                chart.lines.push_back({name(i), *history.find("time"), values, color(i)});
            }
            if (any) charts.push_back(std::move(chart));
        };
        add("energy lost, all accounts", energy_lost);
        for (const char* account :
             {"friction", "contact_loss", "damping", "fracture", "plastic", "transfer_loss", "residual"})
            add(account, [&](const Columns& history) { return *history.find(account); });
        save(charts, 3, "energy.png");
    }

    std::vector<std::string> names() const {
        std::vector<std::string> all;
        for (std::size_t i = 0; i < shown_.size(); ++i) all.push_back(name(i));
        return all;
    }

    /// Momenta are conserved when nothing from outside acts.
    bool is_isolated() const {
        const Deck& deck = shown(0).deck;
        const bool free =
            std::all_of(deck.gravity.begin(), deck.gravity.end(), [](double g) { return g == 0.0; });
        return free && deck.walls.empty() && deck.loads.empty() && deck.constraints.empty() &&
               deck.mass_damping == 0.0;
    }

    void draw_momenta() {
        std::vector<Chart> charts;
        for (const char* which : {"linear", "angular"}) {
            Chart chart{
                fmt::format("{} momentum, largest error", which), "", "relative", {}, false, true, false};
            chart.categories = names();
            for (std::size_t i = 0; i < shown_.size(); ++i)
                chart.lines.push_back({name(i),
                                       {static_cast<double>(i)},
                                       {shown(i).value(std::string("momentum_error.") + which)},
                                       color(i),
                                       false,
                                       true,
                                       false});
            charts.push_back(std::move(chart));
        }
        if (is_isolated()) charts.push_back(drift_chart());
        save(charts, 3, "momenta.png");
    }

    Chart drift_chart() const {
        Chart chart{"linear momentum, change",
                    "time [s]",
                    fmt::format("[{}]", per_thickness(comparison_, "kg m/s")),
                    {},
                    false,
                    true,
                    true};
        for (std::size_t i = 0; i < shown_.size(); ++i) {
            const Columns& history = shown(i).files.history;
            std::vector<double> change(history.n_rows(), 0.0);
            for (const char* part : {"momentum_x", "momentum_y", "momentum_z"})
                if (const std::vector<double>* p = history.find(part))
                    for (std::size_t k = 0; k < change.size(); ++k)
                        change[k] = std::hypot(change[k], (*p)[k] - p->front());
            chart.lines.push_back({name(i), *history.find("time"), change, color(i)});
        }
        return chart;
    }

    void draw_cost() {
        Chart stages{"cost by stage", "", "ns per particle and step", {}, false, false, true};
        Chart wall{"wall time without output", "", "[s]", {}, false, false, false};
        stages.categories = wall.categories = names();
        for (const auto& [stage, unused] : shown(0).cost.stages) {
            if (stage == "output") continue;
            ChartLine part;
            part.label = stage;
            part.bar = true;
            part.color = static_cast<int>(stages.lines.size());
            for (std::size_t i = 0; i < shown_.size(); ++i) {
                part.x.push_back(static_cast<double>(i));
                part.y.push_back(shown(i).value("stage." + stage));
            }
            stages.lines.push_back(std::move(part));
        }
        for (std::size_t i = 0; i < shown_.size(); ++i) {
            ChartLine bar{name(i), {static_cast<double>(i)}, {shown(i).cost.step_seconds}, color(i)};
            bar.bar = true;
            wall.lines.push_back(std::move(bar));
        }
        save({stages, wall}, 2, "cost.png");
    }

    static std::string title_of(const QuantityKind& kind) {
        const bool plain = kind.group == "Energy" || kind.group == "Cost";
        return plain ? kind.name : fmt::format("{}: {}", kind.group, kind.name);
    }

    /// A quantity over the varied parameter; with slopes in the legend where both axes are logarithmic.
    void add_level_chart(std::vector<Chart>& charts, const QuantityKind& kind, bool log) const {
        Chart chart{title_of(kind),
                    comparison_.over_name,
                    kind.unit.empty() ? "" : fmt::format("[{}]", kind.unit),
                    {},
                    log,
                    log,
                    true};
        for (std::size_t v = 0; v < comparison_.variants.size(); ++v) {
            ChartLine line;
            line.label = comparison_.variants[v].name;
            line.color = static_cast<int>(v);
            line.markers = true;
            for (std::size_t l = 0; l < comparison_.levels.size(); ++l) {
                line.x.push_back(comparison_.level_number(l));
                const double value = comparison_.run(l, v).value(kind.key);
                line.y.push_back(log ? std::abs(value) : value);
            }
            if (const double slope = log ? log_slope(line.x, line.y) : std::nan(""); std::isfinite(slope))
                line.label += fmt::format(", slope {:.2f}", slope);
            const bool any = std::any_of(line.y.begin(), line.y.end(),
                                         [&](double y) { return std::isfinite(y) && (!log || y > 0.0); });
            if (any) chart.lines.push_back(std::move(line));
        }
        if (!chart.lines.empty()) charts.push_back(std::move(chart));
    }

    void draw_levels() {
        std::vector<Chart> charts;
        const std::vector<int> grains = told_grains(shown(0).files);
        const std::string contact = grains.empty() ? "none" : fmt::format("contact.{}.", grains.front());
        for (const QuantityKind& kind : kinds_at(comparison_, 0)) {
            const bool is_plain = kind.key == contact + "restitution" || kind.key == contact + "duration" ||
                                  kind.key == contact + "peak" || kind.key == contact + "chatter";
            const bool is_dull = kind.key == "cost.steps" || kind.key == "cost.memory";
            if ((kind.has_order && !is_dull) || is_plain) add_level_chart(charts, kind, kind.has_order);
        }
        save(charts, 3, "levels.png");
    }

    const Comparison& comparison_;
    std::string folder_;
    std::vector<std::size_t> shown_;  ///< variants that are done at the last level
    std::vector<std::string> files_;
};

}  // namespace

std::vector<std::string> draw_comparison(const Comparison& comparison, const std::string& folder) {
    return ComparisonCharts(comparison, folder).draw();
}

}  // namespace quern
