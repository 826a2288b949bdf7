#include "examples/comparison/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>

#include "grid/error.hpp"
#include "src/deck/tree.hpp"
#include "src/results/render.hpp"

namespace quern {

namespace {

const std::vector<std::string> variants = {"pair", "surface", "node_pair", "seed_flip", "seed"};

/// comparison.json of one case.
class Numbers {
  public:
    explicit Numbers(const std::string& file) : tree_(read_tree(file)) {}

    std::vector<std::string> levels() const {
        std::vector<std::string> names;
        for (const Node& level : tree_.find("levels")->items) names.push_back(level.text);
        return names;
    }
    /// NaN if the run has no such number.
    double value(const std::string& variant, const std::string& level, const std::string& key) const {
        for (const Node& run : tree_.find("runs")->items) {
            if (run.find("variant")->text != variant || run.find("level")->text != level) continue;
            const Node* number = run.find("quantities")->find(key);
            if (number != nullptr && number->text != "null" && !number->text.empty())
                return std::stod(number->text);
        }
        return std::numeric_limits<double>::quiet_NaN();
    }

  private:
    Node tree_;
};

struct Row {
    std::string text, case_name, key;
    double factor = 1.0;
};

const std::vector<Row> rows = {
    {"rolling disk: off the rigid one after 1.63 m (flattening: 9) [mm]", "inclined_plane",
     "difference.position", 1e3},
    {"rolling disk: off the rigid one in spin (6.5) [rad/s]", "inclined_plane", "difference.omega"},
    {"backspin: error of the position [mm]", "backspin", "difference.position", 1e3},
    {"backspin: error of the spin [rad/s]", "backspin", "difference.omega"},
    {"block on a block: error of the way (0.36 m) [mm]", "blocks", "difference.position", 1e3},
    {"two disks, no friction: spin they should not have [rad/s]", "two_disks", "final.0.omega"},
    {"two disks: energy lost by contact [%]", "two_disks", "energy.numerical_loss", 100.0},
    {"two disks: error of the angular momentum", "two_disks", "momentum_error.angular"},
    {"two disks: residual of the energy budget", "two_disks", "energy.residual_relative"},
    {"two spheres: spin they should not have [rad/s]", "two_spheres", "final.0.omega"},
    {"200 disks settle: residual of the energy budget", "settling", "energy.residual_relative"},
    {"rolling disk: particle and step [ns]", "inclined_plane", "cost.ns_per_particle_step"},
    {"rolling disk: steps", "inclined_plane", "cost.steps"},
    {"200 disks settle: particle and step [ns]", "settling", "cost.ns_per_particle_step"},
    {"200 disks settle: steps", "settling", "cost.steps"},
    {"200 disks settle: wall time [s]", "settling", "cost.step_seconds"}};

/// Differences below this part, or values below round-off, are no differences.
constexpr double same = 0.05, round_off = 1e-12;

class Overview {
  public:
    explicit Overview(std::string directory) : directory_(std::move(directory)) {
        for (const Row& row : rows)
            if (!cases_.count(row.case_name))
                cases_.emplace(row.case_name, Numbers(directory_ + "/" + row.case_name + "/comparison.json"));
    }

    void write_table() const {
        std::string text = "| |";
        for (const std::string& variant : variants) text += fmt::format(" `{}` |", variant);
        text += "\n| --- |";
        for (std::size_t i = 0; i < variants.size(); ++i) text += " ---: |";
        text += "\n";
        for (const Row& row : rows) {
            std::vector<double> values;
            double best = std::numeric_limits<double>::infinity();
            for (const std::string& variant : variants) {
                values.push_back(std::abs(row.factor * last(row, variant)));
                if (std::isfinite(values.back())) best = std::min(best, values.back());
            }
            text += fmt::format("| {} |", row.text);
            for (const double value : values) {
                const bool is_best = value <= std::max((1.0 + same) * best, round_off);
                const std::string number = std::isfinite(value) ? fmt::format("{:.3g}", value) : "-";
                text += is_best ? fmt::format(" **{}** |", number) : fmt::format(" {} |", number);
            }
            text += "\n";
        }
        const std::string file = directory_ + "/summary.md";
        std::ofstream out(file);
        out << text;
        if (!out.flush()) throw OutputError(file + ": cannot be written");
    }

    void draw() const {
        draw_charts({chart("Disk that rolls: error of the position", "inclined_plane", "cells per diameter",
                           "[mm]", "difference.position", 1e3),
                     chart("Two disks, no friction: spin they should not have", "two_disks",
                           "cells per radius", "[rad/s]", "final.0.omega", 1.0),
                     chart("Two disks: energy lost by contact", "two_disks", "cells per radius", "[%]",
                           "energy.numerical_loss", 100.0),
                     chart("200 disks settle: wall time", "settling", "cells per radius", "[s]",
                           "cost.step_seconds", 1.0)},
                    2, directory_ + "/summary.png");
    }

  private:
    double last(const Row& row, const std::string& variant) const {
        const Numbers& numbers = cases_.at(row.case_name);
        return numbers.value(variant, numbers.levels().back(), row.key);
    }

    Chart chart(const std::string& title, const std::string& case_name, const std::string& x,
                const std::string& y, const std::string& key, double factor) const {
        Chart chart{.title = title, .x_label = x, .y_label = y, .lines = {}, .log_x = true, .log_y = true};
        const Numbers& numbers = cases_.at(case_name);
        for (const std::string& variant : variants) {
            ChartLine line{.label = variant, .x = {}, .y = {}, .color = static_cast<int>(chart.lines.size())};
            line.markers = true;
            for (const std::string& level : numbers.levels()) {
                const double value = std::abs(factor * numbers.value(variant, level, key));
                if (!(value > 0.0)) continue;
                line.x.push_back(std::stod(level));
                line.y.push_back(value);
            }
            chart.lines.push_back(line);
        }
        return chart;
    }

    std::string directory_;
    std::map<std::string, Numbers> cases_;
};

}  // namespace

void write_summary(const std::string& directory) {
    const Overview summary(directory);
    summary.write_table();
    summary.draw();
}

}  // namespace quern
