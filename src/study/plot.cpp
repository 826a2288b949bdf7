#include "src/study/plot.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "grid/error.hpp"
#include "src/deck/names.hpp"
#include "src/results/render.hpp"
#include "src/results/rose.hpp"
#include "src/study/observed.hpp"

namespace quern {

namespace {

constexpr std::size_t profiles_at_once = 4;
constexpr double mean_width = 0.1, largest_width = 0.5;  ///< of the lines of the network, over the branch

struct Drawing {
    const PlotOptions& options;
    std::string file;
};

struct Plot {
    const char *name, *about;
    std::vector<std::string> needs;  ///< files of the run
    void (*draw)(const Drawing&);
};

ChartLine line(std::string label, std::vector<double> x, std::vector<double> y, std::size_t color,
               bool dashed = false) {
    ChartLine line{std::move(label), std::move(x), std::move(y), static_cast<int>(color)};
    line.dashed = dashed;
    return line;
}

/// Frames that were asked for, as times of a table.
std::vector<double> chosen_times(const PlotOptions& options, std::size_t n_default) {
    const std::vector<double> times = ObservedTable(options.directory, "grain_stress").times();
    if (times.empty()) throw InputError(options.directory, "no observed frame", "one frame at least");
    std::vector<double> chosen;
    for (const std::string& text : options.frames) {
        std::size_t number = times.size() - 1;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        const bool whole = error == std::errc() && end == text.data() + text.size();
        if (text != "last" && (!whole || number >= times.size()))
            throw InputError("--frame", fmt::format("'{}'", text),
                             fmt::format("last, or a number from 0 to {}", times.size() - 1));
        chosen.push_back(times[number]);
    }
    if (!chosen.empty()) return chosen;
    const std::size_t n = std::min(n_default, times.size());
    for (std::size_t k = 0; k < n; ++k)
        chosen.push_back(times[n == 1 ? times.size() - 1 : k * (times.size() - 1) / (n - 1)]);
    return chosen;
}

std::string at_time(double time) {
    return fmt::format("t = {:.4g} s", time);
}

void check_region(const ObservedTable& table, const std::string& region) {
    const std::vector<std::string> names = table.names();
    if (std::find(names.begin(), names.end(), region) != names.end()) return;
    throw InputError("--region", fmt::format("'{}'", region),
                     fmt::format("one of {}", fmt::join(names, ", ")), did_you_mean(region, names));
}

void draw_energy(const Drawing& drawing) {
    const Columns history = read_columns(drawing.options.directory + "/history.csv");
    const char* label = history.find("momentum_z") ? "energy [J]" : "energy [J/m]";
    const auto chart = [&](const char* title, const std::vector<std::string>& names) {
        Chart chart{title, "time [s]", label, {}};
        for (const std::string& name : names) {
            const std::vector<double>* values = history.find(name);
            const bool any =
                values && std::any_of(values->begin(), values->end(), [](double e) { return e != 0.0; });
            if (any) chart.lines.push_back(line(name, *history.find("time"), *values, chart.lines.size()));
        }
        return chart;
    };
    draw_charts({chart("Stored", {"kinetic", "elastic", "contact_elastic", "gravity"}),
                 chart("Work and loss", {"external_work", "damping", "friction", "contact_loss", "fracture",
                                         "plastic", "transfer_loss", "residual"})},
                2, drawing.file);
}

void draw_forces(const Drawing& drawing) {
    const ObservedTable reactions(drawing.options.directory, "reactions");
    std::vector<Chart> charts;
    for (const char* axis : {"x", "y", "z"}) {
        const std::string column = std::string("f") + axis;
        if (!reactions.has(column)) continue;
        Chart chart{fmt::format("Force along {}", axis),
                    "time [s]",
                    fmt::format("{} [{}]", column, reactions.has("fz") ? "N" : "N/m"),
                    {}};
        for (const std::string& name : reactions.names()) {
            const std::vector<std::size_t> rows = reactions.rows_of(name);
            chart.lines.push_back(
                line(name, reactions.pick("time", rows), reactions.pick(column, rows), chart.lines.size()));
        }
        charts.push_back(chart);
    }
    draw_charts(charts, static_cast<int>(charts.size()), drawing.file);
}

void draw_state(const Drawing& drawing) {
    const ObservedTable regions(drawing.options.directory, "regions");
    std::vector<Chart> charts;
    for (const auto& [column, label] : {std::pair{"coordination", "contacts a grain"},
                                        {"solid_fraction", "solid fraction"},
                                        {"pressure", "pressure [Pa]"},
                                        {"principal_difference", "principal stress difference [Pa]"},
                                        {"fabric_difference", "largest less smallest of the fabric"},
                                        {"half_load", "grains that carry half"}}) {
        Chart chart{"", "time [s]", label, {}};
        for (const std::string& name : regions.names()) {
            const std::vector<std::size_t> rows = regions.rows_of(name);
            chart.lines.push_back(
                line(name, regions.pick("time", rows), regions.pick(column, rows), chart.lines.size()));
        }
        chart.legend = chart.lines.size() > 1;
        charts.push_back(chart);
    }
    draw_charts(charts, 3, drawing.file);
}

void draw_stress(const Drawing& drawing) {
    const ObservedTable regions(drawing.options.directory, "regions");
    check_region(regions, drawing.options.region);
    const std::vector<std::size_t> rows = regions.rows_of(drawing.options.region);
    Chart chart{fmt::format("Mean stress, {}", drawing.options.region),
                "time [s]",
                "stress [Pa], tension positive",
                {}};
    std::size_t color = 0;
    for (const char* component : {"xx", "yy", "zz", "xy", "yz", "xz"}) {
        const std::string name = fmt::format("stress_{}", component);
        if (!regions.has(name)) continue;
        chart.lines.push_back(line(fmt::format("{}, contacts", component), regions.pick("time", rows),
                                   regions.pick(name, rows), color));
        chart.lines.push_back(line(fmt::format("{}, particles", component), regions.pick("time", rows),
                                   regions.pick("particle_" + name, rows), color, true));
        ++color;
    }
    draw_charts({chart}, 1, drawing.file);
}

void draw_profiles(const Drawing& drawing) {
    const ObservedTable profiles(drawing.options.directory, "profiles");
    const std::vector<double> times = chosen_times(drawing.options, profiles_at_once);
    std::vector<Chart> charts;
    int columns = 0;
    for (const std::string& name : profiles.names()) {
        columns = 0;
        for (const auto& [column, label] : {std::pair{"solid_fraction", "solid fraction"},
                                            {"vx", "vx [m/s]"},
                                            {"vy", "vy [m/s]"},
                                            {"vz", "vz [m/s]"},
                                            {"omega", "rate of rotation [rad/s]"},
                                            {"omega_z", "rate of rotation about z [rad/s]"},
                                            {"ux", "displacement x [m]"},
                                            {"uy", "displacement y [m]"},
                                            {"uz", "displacement z [m]"}}) {
            if (!profiles.has(column)) continue;
            Chart chart{name, "place along the axis [m]", label, {}};
            for (const double time : times) {
                const std::vector<std::size_t> rows = profiles.rows(time, name);
                std::vector<double> middle = profiles.pick("from", rows);
                const std::vector<double> to = profiles.pick("to", rows);
                for (std::size_t k = 0; k < middle.size(); ++k) middle[k] = 0.5 * (middle[k] + to[k]);
                chart.lines.push_back(
                    line(at_time(time), middle, profiles.pick(column, rows), chart.lines.size()));
                chart.lines.back().markers = true;
            }
            charts.push_back(chart);
            ++columns;
        }
    }
    if (charts.empty())
        throw InputError(drawing.options.directory, "no profile", "one profile at least",
                         "run again with observe.profiles in the deck");
    draw_charts(charts, (columns + 1) / 2, drawing.file);
}

void draw_distribution(const Drawing& drawing) {
    const ObservedTable forces(drawing.options.directory, "forces"),
        regions(drawing.options.directory, "regions");
    const double time = chosen_times(drawing.options, 1).back();
    Chart chart{fmt::format("Normal forces, {}", at_time(time)), "F / <F>", "P(F / <F>)", {}};
    chart.log_y = true;
    for (const std::string& name : forces.names()) {
        const std::vector<std::size_t> rows = forces.rows(time, name), of_region = regions.rows(time, name);
        if (rows.empty() || of_region.empty()) continue;
        const std::size_t color = chart.lines.size();
        std::vector<double> f = forces.pick("from", rows);
        const std::vector<double> to = forces.pick("to", rows), density = forces.pick("density", rows);
        for (std::size_t k = 0; k < f.size(); ++k) f[k] = 0.5 * (f[k] + to[k]);
        chart.lines.push_back(line(name, f, density, color));
        chart.lines.back().markers = true;
        chart.lines.back().line = false;
        const std::size_t row = of_region.front();
        const double slope = regions.column("tail_slope")[row], n = regions.column("contacts")[row];
        if (!std::isfinite(slope)) continue;
        // n_1 of the n forces lie above the mean, with the density beta exp(-beta (f - 1)).
        const double part = regions.column("tail_contacts")[row] / n;
        std::vector<double> x, y;
        for (double at = 1.0; at <= to.back() + 1e-9; at += 0.1) {
            x.push_back(at);
            y.push_back(part * slope * std::exp(-slope * (at - 1.0)));
        }
        chart.lines.push_back(line(
            fmt::format("{}: exp(-({:.3g} +- {:.2g}) f)", name, slope, regions.column("tail_error")[row]), x,
            y, color, true));
    }
    draw_charts({chart}, 1, drawing.file);
}

/// Cells of rows in up to three columns: prefix + x, y, z.
std::array<double, 3> vector_at(const ObservedTable& table, const std::string& prefix, std::size_t row) {
    std::array<double, 3> v{};
    for (std::size_t a = 0; a < 3; ++a)
        if (const std::string name = prefix + "xyz"[a]; table.has(name)) v[a] = table.column(name)[row];
    return v;
}

void draw_contact_network(const Drawing& drawing) {
    const ObservedTable contacts(drawing.options.directory, "contacts"),
        grains(drawing.options.directory, "grain_stress");
    const double time = chosen_times(drawing.options, 1).back();
    const std::vector<double> times = grains.times();
    const std::vector<std::size_t> of_grains = grains.rows(time), rows = contacts.rows(time);
    double mean = 0.0, length = 0.0;
    for (const std::size_t i : rows) {
        const std::array<double, 3> branch = vector_at(contacts, "l", i);
        mean += contacts.column("fn")[i] / static_cast<double>(rows.size());
        length += std::hypot(branch[0], branch[1], branch[2]) / static_cast<double>(rows.size());
    }
    std::vector<PictureLink> links;
    for (const std::size_t i : rows) {
        const std::array<double, 3> branch = vector_at(contacts, "l", i);
        const double width = length * std::min(largest_width, mean_width * contacts.column("fn")[i] / mean);
        const auto add = [&](double grain, double sign) {
            const std::array<double, 3> from =
                vector_at(grains, "", of_grains[static_cast<std::size_t>(grain)]);
            PictureLink link{from, from, width};
            for (std::size_t a = 0; a < 3; ++a) link.to[a] += sign * branch[a];
            links.push_back(link);
            return link.to;
        };
        const std::array<double, 3> end = add(contacts.column("first")[i], 1.0);
        const double second = contacts.column("second")[i];
        if (second < 0.0) continue;
        const std::array<double, 3> centre =
            vector_at(grains, "", of_grains[static_cast<std::size_t>(second)]);
        const double off = std::hypot(end[0] - centre[0], end[1] - centre[1], end[2] - centre[2]);
        if (off > 0.5 * std::hypot(branch[0], branch[1], branch[2]))
            add(second, -1.0);  // across a periodic face
    }
    std::stable_sort(links.begin(), links.end(),
                     [](const PictureLink& a, const PictureLink& b) { return a.width < b.width; });
    const auto frame = static_cast<std::size_t>(std::find(times.begin(), times.end(), time) - times.begin());
    draw_network(drawing.options.directory, frame, links, drawing.file);
}

void draw_normals(const Drawing& drawing) {
    const ObservedTable contacts(drawing.options.directory, "contacts"),
        regions(drawing.options.directory, "regions");
    if (contacts.has("nz"))
        throw InputError("rose", "a run in space", "a run in the plane", "the other plots show it");
    const double time = chosen_times(drawing.options, 1).back();
    Rose rose;
    rose.title = fmt::format("Contact normals, {}", at_time(time));
    for (const std::size_t i : contacts.rows(time)) {
        if (contacts.column("second")[i] < 0.0) continue;
        rose.angles.push_back(std::atan2(contacts.column("ny")[i], contacts.column("nx")[i]));
    }
    const std::size_t all = regions.rows(time, "all").at(0);
    rose.difference = regions.column("fabric_difference")[all];
    rose.along = regions.column("fabric_along")[all];
    draw_rose(rose, drawing.file);
}

const std::vector<Plot>& plots() {
    static const std::vector<Plot> all = {
        {"energy", "energies, works and losses against time", {"history.csv"}, draw_energy},
        {"forces", "forces on walls and constraints against time", {"reactions.csv"}, draw_forces},
        {"state", "coordination, solid fraction, stress, fabric of each region", {"regions.csv"}, draw_state},
        {"stress", "mean stress of a region, by contacts and by particles", {"regions.csv"}, draw_stress},
        {"profiles", "profiles at some frames", {"profiles.csv", "grain_stress.csv"}, draw_profiles},
        {"distribution",
         "P(f) of normal forces with its exponential tail",
         {"forces.csv", "regions.csv", "grain_stress.csv"},
         draw_distribution},
        {"network",
         "contacts as lines between centres, as wide as they press",
         {"contacts.csv", "grain_stress.csv", "results.h5"},
         draw_contact_network},
        {"rose",
         "directions of contacts, with the fabric (2D)",
         {"contacts.csv", "regions.csv", "grain_stress.csv"},
         draw_normals},
    };
    return all;
}

/// The first lines of a file: the names of its columns, and one row if there is any.
std::array<std::string, 2> first_lines(const std::string& file) {
    std::ifstream stream(file);
    std::array<std::string, 2> lines;
    for (std::string& line : lines) std::getline(stream, line);
    return lines;
}

/// What a plot lacks; "" if it can be drawn.
std::string lack(const Plot& plot, const std::string& directory) {
    for (const std::string& name : plot.needs) {
        if (!std::filesystem::exists(directory + "/" + name)) return "no " + name;
        if (!name.ends_with(".csv")) continue;
        if (first_lines(directory + "/" + name)[1].empty()) return "no rows in " + name;
    }
    return {};
}

}  // namespace

std::vector<std::pair<std::string, std::string>> plot_names() {
    std::vector<std::pair<std::string, std::string>> names;
    for (const Plot& plot : plots()) names.emplace_back(plot.name, plot.about);
    return names;
}

PlotReport plot(const PlotOptions& options) {
    if (!std::filesystem::exists(options.directory + "/history.csv"))
        throw InputError(options.directory, "no run", "a folder with history.csv", "as quern run makes it");
    std::vector<std::string> known;
    for (const Plot& plot : plots()) known.emplace_back(plot.name);
    for (const std::string& name : options.names)
        if (std::find(known.begin(), known.end(), name) == known.end())
            throw InputError("plot", fmt::format("'{}'", name),
                             fmt::format("one of {}", fmt::join(known, ", ")), did_you_mean(name, known));
    const std::string folder = options.output.empty() ? options.directory + "/plots" : options.output;
    const bool flat = first_lines(options.directory + "/contacts.csv")[0].find(",nz,") == std::string::npos;
    PlotReport report;
    for (const Plot& plot : plots()) {
        const bool wanted =
            std::find(options.names.begin(), options.names.end(), plot.name) != options.names.end();
        if (!options.names.empty() && !wanted) continue;
        std::string missing = lack(plot, options.directory);
        const bool observed =
            missing.find("history") == std::string::npos && missing.find("reactions") == std::string::npos;
        if (!missing.empty() && wanted)
            throw InputError(
                options.directory, missing, fmt::format("what the plot '{}' shows", plot.name),
                observed ? "run again with observe in the deck (docs/observers.md)" : "nothing to draw");
        if (missing.empty() && !wanted && plot.draw == draw_normals && !flat) missing = "a run in space";
        if (!missing.empty()) {
            report.left_out.emplace_back(plot.name, missing);
            continue;
        }
        const std::string file = fmt::format("{}/{}.png", folder, plot.name);
        plot.draw({options, file});
        report.files.push_back(file);
    }
    return report;
}

}  // namespace quern
