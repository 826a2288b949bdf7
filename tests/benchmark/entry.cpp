#include "tests/benchmark/entry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/results/json.hpp"

namespace quern::bench {

namespace {

double quantile(std::vector<double> values, double part) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    const double at = part * static_cast<double>(values.size() - 1);
    const std::size_t i = static_cast<std::size_t>(at);
    const double rest = at - static_cast<double>(i);
    return i + 1 < values.size() ? (1.0 - rest) * values[i] + rest * values[i + 1] : values[i];
}

/// "-" for a number that was not counted.
std::string counted(double value, const char* format) {
    return value > 0.0 ? fmt::format(fmt::runtime(format), value) : "-";
}

std::string note(const Entry& e) {
    if (e.kind == "method")
        return fmt::format("{:.0f} grains {}", e.size("grains"),
                           e.size("moving") > 0.0 ? "moving" : "at rest") +
               (e.size("step_ns") > 0.0 ? fmt::format(", whole step {:.1f} ns", e.size("step_ns")) : "");
    if (e.kind != "problem") return "";
    std::string text = fmt::format("{:.3g} ms a step", 1e-6 * e.median() * e.count);
    if (e.size("cpu_share") < 0.95)
        text += fmt::format(", {:.0f} % of the core", 100.0 * e.size("cpu_share"));
    if (e.memory > 0.0) text += fmt::format(", {:.2f} kB a particle", 1e-3 * e.memory);
    if (e.size("speed_up") > 0.0) text += fmt::format(", {:.2f} times one thread", e.size("speed_up"));
    return text;
}

std::string pairs_json(const std::vector<std::pair<std::string, double>>& pairs) {
    std::string text;
    for (const auto& [name, value] : pairs)
        text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", json_string(name), json_number(value));
    return "{" + text + "}";
}

std::string entry_json(const Entry& e, const std::vector<Roofline>& rooflines) {
    std::string text = fmt::format(
        "    {{\"kind\": {}, \"name\": {}, \"threads\": {}, \"unit\": {}, \"count\": {}, \"median\": {}, "
        "\"spread\": {}",
        json_string(e.kind), json_string(e.name), e.threads, json_string(e.unit), json_number(e.count),
        json_number(e.median()), json_number(e.spread()));
    if (e.bytes > 0.0) text += fmt::format(", \"bytes\": {}", json_number(e.bytes));
    if (e.flops > 0.0) text += fmt::format(", \"flops\": {}", json_number(e.flops));
    if (const double part = roofline_fraction(e, rooflines); part > 0.0)
        text += fmt::format(", \"roofline\": {}", json_number(part));
    if (e.memory > 0.0) text += fmt::format(", \"bytes_per_particle\": {}", json_number(e.memory));
    if (!e.sizes.empty()) text += ", \"sizes\": " + pairs_json(e.sizes);
    text += ", \"repetitions\": [";
    for (std::size_t i = 0; i < e.ns.size(); ++i) text += (i > 0 ? ", " : "") + json_number(e.ns[i]);
    return text + "]}";
}

}  // namespace

double Entry::median() const {
    return quantile(ns, 0.5);
}

double Entry::spread() const {
    return median() > 0.0 ? (quantile(ns, 0.75) - quantile(ns, 0.25)) / median() : 0.0;
}

double Entry::size(const std::string& wanted) const {
    for (const auto& [key, value] : sizes)
        if (key == wanted) return value;
    return 0.0;
}

double roofline_fraction(const Entry& entry, const std::vector<Roofline>& rooflines) {
    for (const Roofline& roof : rooflines)
        if (roof.threads == entry.threads && entry.median() > 0.0)
            return std::max(entry.bytes / roof.triad, entry.flops / roof.fma) / entry.median();
    return 0.0;
}

std::string table_head() {
    return fmt::format("{:8}{:38}{:>3} {:9}{:>11}{:>10}{:>7}{:>8}{:>7}{:>7}\n", "", "", "thr", "unit",
                       "units", "ns/unit", "+-", "bytes", "flops", "roof");
}

std::string table_row(const Entry& e, const std::vector<Roofline>& rooflines) {
    return fmt::format("{:8}{:38}{:>3} {:9}{:>11.0f}{:>10.3f}{:>6.1f}%{:>8}{:>7}{:>7}  {}\n", e.kind, e.name,
                       e.threads, e.unit, e.count, e.median(), 50.0 * e.spread(), counted(e.bytes, "{:.1f}"),
                       counted(e.flops, "{:.0f}"),
                       counted(100.0 * roofline_fraction(e, rooflines), "{:.1f}%"), note(e));
}

std::string report_json(const Report& report) {
    std::string text = "{\n  \"measure\": \"ns\",\n  \"band\": 0.1,\n  \"machine\": {";
    for (std::size_t i = 0; i < report.machine.size(); ++i)
        text += fmt::format("{}\n    {}: {}", i > 0 ? "," : "", json_string(report.machine[i].first),
                            json_string(report.machine[i].second));
    text += "\n  },\n  \"rooflines\": [";
    for (std::size_t i = 0; i < report.rooflines.size(); ++i) {
        const Roofline& r = report.rooflines[i];
        text += fmt::format(
            "{}\n    {{\"threads\": {}, \"triad_gb_per_s\": {}, \"triad_cache_gb_per_s\": {}, "
            "\"fma_gflop_per_s\": {}}}",
            i > 0 ? "," : "", r.threads, json_number(r.triad), json_number(r.triad_cache),
            json_number(r.fma));
    }
    text += "\n  ],\n  \"entries\": [";
    for (std::size_t i = 0; i < report.entries.size(); ++i)
        text += (i > 0 ? ",\n" : "\n") + entry_json(report.entries[i], report.rooflines);
    return text + "\n  ]\n}\n";
}

}  // namespace quern::bench
