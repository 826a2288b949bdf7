// A disk falls on a fixed one, as published with PeriDEM: Tables 2, 3 and 4 and Fig. 11 of the paper, and
// what each correction of the published model changes.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/results/render.hpp"
#include "src/sim/report.hpp"
#include "src/sim/report_table.hpp"
#include "src/sim/study.hpp"

namespace {

using namespace quern;
using Words = std::vector<std::string>;

const std::string deck = EXAMPLE_DIR "/tables.yaml";
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

/// One run: parameters beside those of the deck, and what the paper prints.
struct Case {
    std::string name;
    double restitution = 0.95;
    Words params = {};
    double published = unknown;  ///< C_R
    Words overrides = {};        ///< other keys of the deck
};

struct Bounce {
    double c_r = 0, height = 0;     ///< sqrt(H1/H0), H1/H0
    double touch = 0;               ///< least gap of the edges [m]
    std::vector<double> time, gap;  ///< [ms], [mm]
};

/// The disk's edges are those of the circles: what a mesh lacks of them does not count.
Bounce bounce(const RunRecord& record, double H0, double centre_at_touch) {
    const std::vector<GrainRow> rows = rows_of(record, 1);
    Bounce b;
    b.time = column(rows, [](const GrainRow& row) { return 1e3 * row.time; });
    b.gap = column(rows, [&](const GrainRow& row) { return 1e3 * (row.position[1] - centre_at_touch); });
    const auto lowest = std::min_element(b.gap.begin(), b.gap.end());
    b.touch = 1e-3 * *lowest;
    b.height = 1e-3 * *std::max_element(lowest, b.gap.end()) / H0;
    b.c_r = std::sqrt(std::max(0.0, b.height));
    return b;
}

class Report {
  public:
    explicit Report(const ReportOptions& options) : options_(options) {
        fmt::print("{:52} {:>6} {:>8} {:>9} {:>8} {:>9} {:>9}\n", "case", "eps_n", "C_R", "published", "off",
                   "gap [mm]", "residual");
    }

    Bounce run(const Case& c) {
        Words overrides = c.overrides;
        overrides.push_back(fmt::format("params.restitution={}", c.restitution));
        double radius_bottom = 1e-3;
        for (const std::string& item : c.params) {
            overrides.push_back("params." + item);
            if (item == "radius_bottom=3 mm") radius_bottom = 3e-3;
        }
        const RunRecord record = run_case(deck, overrides, options_.directory + "/run");
        const Bounce b = bounce(record, 1e-3, 2.0 * radius_bottom + 1e-3);
        const double residual = record.summary.residual_relative;
        const bool printed = std::isfinite(c.published);
        fmt::print("{:52} {:6.2f} {:8.4f} {:>9} {:>8} {:9.4f} {:9.1e}\n", c.name, c.restitution, b.c_r,
                   printed ? fmt::format("{:.3f}", c.published) : "",
                   printed ? fmt::format("{:+.4f}", b.c_r - c.published) : "", 1e3 * b.touch, residual);
        table_.add(c.name, {c.restitution, b.c_r, c.published, b.height, 1e3 * b.touch, residual});
        std::fflush(stdout);
        if (printed) {
            worst_ = std::max(worst_, std::abs(b.c_r - c.published));
            parity_.x.push_back(c.published);
            parity_.y.push_back(b.c_r);
        }
        if (printed && c.overrides.empty()) worst_residual_ = std::max(worst_residual_, residual);
        return b;
    }

    /// Every published number against ours.
    Chart parity() const {
        const ChartLine exact{.label = "exact", .x = {0.7, 1.0}, .y = {0.7, 1.0}, .color = 1};
        return {
            .title = "Tables 2, 3, 4", .x_label = "C_R, paper", .y_label = "C_R", .lines = {exact, parity_}};
    }

    int finish(const std::vector<Chart>& charts) {
        table_.write(options_.directory, "peridem_tables");
        if (!charts.empty()) draw_charts(charts, 2, options_.directory + "/peridem_tables.png");
        ReportChecks checks;
        checks.at_most("C_R off the published value, largest", worst_, 0.005);
        checks.at_most("energy residual of these, largest", worst_residual_, 5e-3);
        return checks.verdict();
    }

  private:
    ReportOptions options_;
    ReportTable table_{{"case", "eps_n", "C_R", "published", "H1/H0", "gap_mm", "residual"}};
    ChartLine parity_{.label = "runs", .x = {}, .y = {}, .markers = true, .line = false};
    double worst_ = 0.0, worst_residual_ = 0.0;
};

const Words three_mm = {"mesh_bottom=disk_3mm", "radius_bottom=3 mm"};
const Words hard_bottom = {"K_bottom=2 GPa", "Gc_bottom=500", "step=0.1 us"};
const Words hard = {"K_bottom=2 GPa", "Gc_bottom=500", "K_top=2 GPa", "Gc_top=500", "step=0.02 us"};

Words operator+(Words a, const Words& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

/// Table 2: damping.
Chart table_2(Report& report) {
    Chart chart{
        .title = "Table 2: gap of the edges", .x_label = "t [ms]", .y_label = "gap [mm]", .lines = {}};
    const std::pair<double, double> rows[] = {
        {1.0, 1.0}, {0.95, 0.946}, {0.9, 0.893}, {0.85, 0.845}, {0.8, 0.796}};
    for (const auto& [restitution, published] : rows) {
        const Bounce b = report.run({"Table 2: M1, M1", restitution, {}, published});
        chart.lines.push_back({.label = fmt::format("eps_n {}: C_R {:.3f}", restitution, b.c_r),
                               .x = b.time,
                               .y = b.gap,
                               .color = static_cast<int>(chart.lines.size())});
    }
    return chart;
}

/// Table 3: sizes and materials.
void table_3(Report& report) {
    const std::pair<Case, double> rows[] = {
        {{"Table 3, 6: (3, 1) M1, M1", 0.95, three_mm}, 0.935},
        {{"Table 3, 7: (1, 1) M2, M2", 0.95, hard}, 0.744},
        {{"Table 3, 8: (3, 1) M2, M2", 0.95, three_mm + hard}, 0.716},
        {{"Table 3, 9: (1, 1) M2, M1", 0.95, hard_bottom}, 0.925},
        {{"Table 3, 10: (3, 1) M2, M1", 0.95, three_mm + hard_bottom}, 0.914}};
    for (const auto& [row, published] : rows)
        for (const double restitution : {1.0, 0.95}) {
            Case c = row;
            c.restitution = restitution;
            c.published = restitution == 1.0 ? 1.0 : published;
            report.run(c);
        }
}

/// A row of Table 4: mesh, its smallest distance of nodes as published, horizon.
struct Mesh {
    std::string file;
    double h, horizon, step;  ///< [mm], [mm], [us]
    double published;
    int n_boundary;  ///< nodes on the boundary
    Words params() const {
        return {"mesh_bottom=" + file, "mesh_top=" + file, fmt::format("horizon={} mm", horizon),
                fmt::format("step={} us", step)};
    }
};
const Mesh meshes[] = {{"disk_1mm", 0.1423, 0.6, 0.2, 0.946, 32},
                       {"disk_1mm_h0125", 0.0805, 0.375, 0.1, 0.962, 52},
                       {"disk_1mm_h0100", 0.062, 0.3, 0.1, 0.968, 64},
                       {"disk_1mm_h0067", 0.0379, 0.2, 0.05, 0.977, 96}};

ChartLine markers(const std::string& label, int color) {
    return {.label = label, .x = {}, .y = {}, .color = color, .markers = true, .line = false};
}

/// Table 4 and Fig. 11: mesh and horizon.
Chart table_4(Report& report) {
    Chart chart{.title = "Fig. 11: finer meshes", .x_label = "h [mm]", .y_label = "C_R, H1/H0", .lines = {}};
    ChartLine paper{.label = "C_R, paper", .x = {}, .y = {}, .color = 0};
    ChartLine paper_height{.label = "H1/H0, paper", .x = {}, .y = {}, .color = 1};
    ChartLine own = markers("C_R", 0), height = markers("H1/H0", 1),
              turned = markers("C_R, other nodes meet", 2);
    for (const Mesh& mesh : meshes) {
        report.run({fmt::format("Table 4, h {} mm", mesh.h), 1.0, mesh.params(), 1.0});
        const Bounce b =
            report.run({fmt::format("Table 4, h {} mm", mesh.h), 0.95, mesh.params(), mesh.published});
        const double radius = 0.95 * mesh.h;
        report.run({fmt::format("  R_c as published, {:.4f} mm", radius),
                    0.95,
                    mesh.params(),
                    mesh.published,
                    {fmt::format("contact.node_pair.contact_radius={} mm", radius)}});
        for (const int nodes : {1, 2, 3}) {
            if (mesh.n_boundary > 64) break;  // minutes a run
            const double turn = 360.0 * nodes / mesh.n_boundary;
            const Bounce t = report.run({fmt::format("  both disks turned by {:.3f} degrees", turn), 0.95,
                                         mesh.params() + Words{fmt::format("turn={} deg", turn)}});
            turned.x.push_back(mesh.h);
            turned.y.push_back(t.c_r);
        }
        for (ChartLine* line : {&paper, &paper_height, &own, &height}) line->x.push_back(mesh.h);
        paper.y.push_back(mesh.published);
        paper_height.y.push_back(mesh.published * mesh.published);
        own.y.push_back(b.c_r);
        height.y.push_back(b.height);
    }
    chart.lines = {paper, paper_height, own, height, turned};
    return chart;
}

/// The published model with one thing corrected at a time, then all of them.
Chart corrections(Report& report) {
    Chart chart{.title = "Corrections", .x_label = "t [ms]", .y_label = "gap [mm]", .lines = {}};
    const std::pair<std::string, Words> rows[] = {
        {"as published", {}},
        {"bonds break in tension only", {"breaks_in=tension"}},
        {"no volume correction", {"volume_correction=none"}},
        {"plane strain", {"constants=plane"}},
        {"dashpots between nodes", {"damping=nodes"}},
        {"stiffness of a single bond", {"stiffness=consistent"}},
        {"stiffness of a layer", {"stiffness=layer"}},
        {"surfaces touch", {"radius=surface"}},
        {"all of these",
         {"breaks_in=tension", "volume_correction=none", "constants=plane", "damping=nodes",
          "stiffness=layer", "radius=surface"}},
        {"plane strain, grid contact",
         {"constants=plane", "volume_correction=none", "method=grid", "t_end=22 ms"}},
        {"plane strain, grid contact, surfaces",
         {"constants=plane", "volume_correction=none", "method=grid", "rule=surface", "t_end=22 ms"}},
        {"half the step", {"step=0.1 us"}}};
    double as_published = 0.0;
    for (const auto& [name, params] : rows)
        for (const double restitution : {0.95, 1.0}) {
            const bool dashpots = name.find("grid") == std::string::npos;
            if (!dashpots && restitution < 1.0) continue;
            const Bounce b = report.run({"M1, M1: " + name, restitution, params});
            if (restitution == 1.0 && dashpots) continue;
            if (chart.lines.empty()) as_published = b.c_r;
            if (!chart.lines.empty() && std::abs(b.c_r - as_published) < 0.005) continue;  // the same line
            chart.lines.push_back(
                {.label = name, .x = b.time, .y = b.gap, .color = static_cast<int>(chart.lines.size())});
        }
    return chart;
}

int report(const ReportOptions& options) {
    Report report(options);
    if (options.short_mode) {
        report.run({"Table 2: M1, M1", 0.9, {}, 0.893});
        return report.finish({});
    }
    std::vector<Chart> charts = {table_2(report)};
    table_3(report);
    charts.push_back(table_4(report));
    charts.push_back(report.parity());
    charts.push_back(corrections(report));
    return report.finish(charts);
}

}  // namespace

int main(int argc, char** argv) {
    return quern::report_main(argc, argv, "peridem_tables", report);
}
