#include "tests/benchmark/plots.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "src/results/render.hpp"

namespace quern::bench {

namespace {

const Entry* find(const Report& report, const std::string& name) {
    for (const Entry& e : report.entries)
        if (e.name == name && e.threads == 1) return &e;
    return nullptr;
}

/// Packings of disks, by their number.
std::vector<const Entry*> packings(const Report& report) {
    std::vector<const Entry*> list;
    for (const Entry& e : report.entries)
        if (e.kind == "problem" && e.threads == 1 && e.name.starts_with("disks ") &&
            e.name.find(',') == std::string::npos)
            list.push_back(&e);
    std::sort(list.begin(), list.end(),
              [](const Entry* a, const Entry* b) { return a->size("grains") < b->size("grains"); });
    return list;
}

ChartLine line(const std::string& label, int color) {
    ChartLine line;
    line.label = label;
    line.color = color;
    line.markers = true;
    return line;
}

Chart cost_chart(const Report& report) {
    Chart chart{.title = "Packings of disks, one thread",
                .x_label = "grains",
                .y_label = "ns per particle and step",
                .lines = {},
                .log_x = true};
    int color = 0;
    for (const std::string stage : {"", "force", "contact", "kick", "drift"}) {
        ChartLine cost = line(stage.empty() ? "step" : stage, color++);
        for (const Entry* problem : packings(report))
            if (const Entry* e = find(report, problem->name + (stage.empty() ? "" : ": " + stage))) {
                cost.x.push_back(problem->size("grains"));
                cost.y.push_back(e->median() * e->count / problem->count);
            }
        chart.lines.push_back(cost);
    }
    return chart;
}

Chart memory_chart(const Report& report) {
    Chart chart{.title = "Packings of disks, one thread",
                .x_label = "grains",
                .y_label = "peak memory [kB per particle]",
                .lines = {},
                .log_x = true,
                .legend = false};
    ChartLine memory = line("memory", 0);
    for (const Entry* problem : packings(report))
        if (problem->memory > 0.0) {
            memory.x.push_back(problem->size("grains"));
            memory.y.push_back(1e-3 * problem->memory);
        }
    chart.lines.push_back(memory);
    return chart;
}

Chart force_chart(const Report& report) {
    Chart chart{.title = "Forces in batches of eight grains",
                .x_label = "bits of a vector",
                .y_label = "ns per bond",
                .lines = {},
                .log_x = true};
    int color = 0;
    for (const std::string law : {"2D LPS", "3D LPS", "2D bond-based", "3D bond-based"}) {
        ChartLine cost = line(law, color++);
        for (const auto& [set, bits] : {std::pair{"plain", 128.0}, {"avx2", 256.0}, {"avx512", 512.0}})
            if (const Entry* e = find(report, fmt::format("force {} batch {}", law, set))) {
                cost.x.push_back(bits);
                cost.y.push_back(e->median());
            }
        chart.lines.push_back(cost);
    }
    return chart;
}

Chart roofline_chart(const Report& report) {
    Chart chart{.title = "Roofline, one thread",
                .x_label = "flops per byte",
                .y_label = "GFlop/s",
                .lines = {},
                .log_x = true,
                .log_y = true};
    for (const Roofline& roof : report.rooflines) {
        if (roof.threads != 1) continue;
        ChartLine memory = line("triad in memory", 0), cache = line("triad in cache", 1);
        for (double intensity = 0.05; intensity < 100.0; intensity *= 1.1) {
            memory.x.push_back(intensity);
            memory.y.push_back(std::min(roof.fma, intensity * roof.triad));
            cache.x.push_back(intensity);
            cache.y.push_back(std::min(roof.fma, intensity * roof.triad_cache));
        }
        memory.markers = cache.markers = false;
        chart.lines.push_back(memory);
        chart.lines.push_back(cache);
    }
    int color = 2;
    for (const std::string kernel : {"avx512", "avx2", "plain", "single", "drift"}) {
        ChartLine points = line(kernel == "drift" ? kernel : "force, " + kernel, color++);
        points.line = false;
        for (const Entry& e : report.entries)
            if (e.kind == "kernel" && e.bytes > 0.0 && e.flops > 0.0 &&
                (e.name.ends_with(kernel) || e.name.starts_with(kernel))) {
                points.x.push_back(e.flops / e.bytes);
                points.y.push_back(e.flops / e.median());
            }
        chart.lines.push_back(points);
    }
    return chart;
}

/// Contact by each method, packings at rest or moving.
Chart method_chart(const Report& report, bool moving) {
    Chart chart{.title = moving ? "Contact, grains moving" : "Contact, grains at rest",
                .x_label = "grains",
                .y_label = "ns per particle and step",
                .lines = {},
                .log_x = true,
                .log_y = true};
    for (const Entry& e : report.entries) {
        if (e.kind != "method" || (e.size("moving") > 0.0) != moving) continue;
        const auto same = [&](const ChartLine& l) { return l.label == e.name; };
        auto found = std::find_if(chart.lines.begin(), chart.lines.end(), same);
        if (found == chart.lines.end())
            found = chart.lines.insert(found, line(e.name, static_cast<int>(chart.lines.size())));
        found->x.push_back(e.size("grains"));
        found->y.push_back(e.median());
    }
    return chart;
}

bool has_points(const Chart& chart) {
    return std::any_of(chart.lines.begin(), chart.lines.end(),
                       [](const ChartLine& l) { return l.markers && !l.x.empty(); });
}

}  // namespace

void draw_report(const Report& report, const std::string& file) {
    std::vector<Chart> charts;
    for (const Chart& chart :
         {cost_chart(report), force_chart(report), memory_chart(report), roofline_chart(report),
          method_chart(report, false), method_chart(report, true)})
        if (has_points(chart)) charts.push_back(chart);
    if (!charts.empty()) draw_charts(charts, 2, file);
}

}  // namespace quern::bench
