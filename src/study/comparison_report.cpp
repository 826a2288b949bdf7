#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "src/deck/names.hpp"
#include "src/results/json.hpp"
#include "src/study/comparison.hpp"
#include "src/study/table.hpp"

namespace quern {

namespace {

std::vector<std::string> names_of(const Comparison& comparison) {
    std::vector<std::string> names;
    for (const Variant& variant : comparison.variants) names.push_back(variant.name);
    return names;
}

std::string code(const std::string& text) {
    return text.empty() ? "" : fmt::format("`{}`", text);
}

std::string introduction(const Comparison& comparison) {
    const ComparedRun& first = comparison.runs.front();
    std::string text = fmt::format("# Comparison: {}\n\nDeck {}", first.deck.title,
                                   code(readable_path(comparison.base.deck)));
    if (!comparison.settings.empty()) text += fmt::format(" with `{}`", join(comparison.settings));
    text += fmt::format("; one run after the other, {} thread{} each", comparison.base.threads,
                        comparison.base.threads == 1 ? "" : "s");
    if (comparison.n_repeats > 1)
        text += fmt::format(", {} times in turns (times and memory: medians)", comparison.n_repeats);
    text += ".\n";
    for (const ComparedRun& run : comparison.runs) {
        if (!run.done()) continue;
        text += fmt::format("Quern {}, instructions {}.\n", run.files.summary.text("version"),
                            run.files.summary.text("instructions"));
        break;
    }
    const bool last = !comparison.over.empty() && !comparison.reference_is_file;
    text += fmt::format(
        "Differences are to {}{}.\n",
        code(comparison.reference_is_file ? readable_path(comparison.reference) : comparison.reference),
        last ? fmt::format(" at `{}`", comparison.level_name(comparison.last_level())) : "");
    Table variants({"variant", "settings"});
    for (const Variant& variant : comparison.variants)
        variants.add({variant.name, code(join(variant.overrides))});
    text += fmt::format("\n{}", variants.markdown());
    for (const DroppedVariant& variant : comparison.dropped)
        text += fmt::format("\nWithout `{}`: {}\n", variant.name, variant.reason);
    return text;
}

std::string troubles(const Comparison& comparison) {
    Table table({"run", "outcome", "message"});
    for (const ComparedRun& run : comparison.runs) {
        if (!run.done()) table.add({run.repeats.front().name, run.end.outcome, run.end.message});
        if (!run.same_bits)
            table.add({run.repeats.front().name, "not reproducible", "repeats end in different states"});
        if (run.done() && run.files.summary.n_warnings() > 0)
            table.add({run.repeats.front().name, "warning", run.files.summary.warnings()});
    }
    return table.empty() ? "" : fmt::format("\n## Failures and warnings\n\n{}", table.markdown());
}

/// "; at cells=6 `pair`, at cells=12 a tie".
std::string other_levels(const Comparison& comparison, const QuantityKind& kind) {
    std::string text;
    for (std::size_t l = 0; l < comparison.last_level(); ++l) {
        const Verdict verdict = judge_at(comparison, l, kind);
        if (verdict.best.empty()) continue;
        std::vector<std::string> quoted;
        for (const std::string& name : verdict.best) quoted.push_back(fmt::format("`{}`", name));
        text += fmt::format("{} at {} {}", text.empty() ? ";" : ",", comparison.level_name(l),
                            std::isnan(verdict.factor) ? "a tie" : join(quoted, " and "));
    }
    return text;
}

std::string verdicts(const Comparison& comparison) {
    std::string list;
    for (const QuantityKind& kind : kinds_at(comparison, comparison.last_level())) {
        const Verdict verdict = judge_at(comparison, comparison.last_level(), kind);
        if (verdict.best.empty()) continue;
        list += fmt::format("- {}, {}{}: {}{}.\n", kind.group, kind.name,
                            kind.unit.empty() ? "" : fmt::format(" [{}]", kind.unit), verdict.text,
                            other_levels(comparison, kind));
    }
    if (list.empty()) return "";
    std::string text = "\n## Where each is better\n\nQuantities of which less is better";
    if (!comparison.over.empty())
        text += fmt::format(", at `{}`", comparison.level_name(comparison.last_level()));
    if (comparison.n_repeats == 1)
        text += fmt::format(
            "; times of single runs within {} % count as equal (a busy machine needs --repeat 3 or more)",
            readable(100.0 * unknown_noise));
    return text + ".\n\n" + list;
}

/// Values of a quantity at a level by variant.
std::vector<double> values_at(const Comparison& comparison, std::size_t level, const std::string& key) {
    std::vector<double> values;
    for (std::size_t v = 0; v < comparison.variants.size(); ++v)
        values.push_back(comparison.run(level, v).value(key));
    return values;
}

std::string quantity_tables(const Comparison& comparison) {
    const std::vector<QuantityKind> kinds = kinds_at(comparison, comparison.last_level());
    std::vector<std::string> groups;
    for (const QuantityKind& kind : kinds)
        if (std::find(groups.begin(), groups.end(), kind.group) == groups.end()) groups.push_back(kind.group);
    std::vector<std::string> columns = {"", "unit"};
    if (!comparison.over.empty()) columns.push_back(comparison.over_name);
    for (const std::string& name : names_of(comparison)) columns.push_back(name);
    std::string text;
    for (const std::string& group : groups) {
        Table table(columns);
        for (const QuantityKind& kind : kinds) {
            if (kind.group != group) continue;
            std::vector<std::vector<Cell>> rows;
            bool any = false;
            for (std::size_t l = 0; l < comparison.levels.size(); ++l) {
                std::vector<Cell> row = {kind.name, kind.unit};
                if (!comparison.over.empty()) row.emplace_back(comparison.levels[l]);
                for (const double value : values_at(comparison, l, kind.key)) {
                    any = any || (std::isfinite(value) && value != 0.0);
                    row.emplace_back(value);
                }
                rows.push_back(std::move(row));
            }
            if (!any) continue;
            for (std::vector<Cell>& row : rows) table.add(std::move(row));
        }
        if (!table.empty()) text += fmt::format("\n## {}\n\n{}", group, table.markdown());
    }
    return text.empty() ? "" : text + "\nRows that are zero or without a number throughout are left out.\n";
}

/// Slopes over the varied parameter, by variant.
std::vector<double> slopes_of(const Comparison& comparison, const std::string& key) {
    std::vector<double> slopes;
    for (std::size_t v = 0; v < comparison.variants.size(); ++v) {
        std::vector<double> x, y;
        for (std::size_t l = 0; l < comparison.levels.size(); ++l) {
            x.push_back(comparison.level_number(l));
            y.push_back(comparison.run(l, v).value(key));
        }
        slopes.push_back(log_slope(x, y));
    }
    return slopes;
}

std::vector<QuantityKind> kinds_with_slopes(const Comparison& comparison) {
    std::vector<QuantityKind> kinds;
    if (comparison.levels.size() < 2) return kinds;
    for (const QuantityKind& kind : kinds_at(comparison, 0))
        if (kind.has_order) kinds.push_back(kind);
    return kinds;
}

std::string slope_table(const Comparison& comparison) {
    std::vector<std::string> columns = {"quantity"};
    for (const std::string& name : names_of(comparison)) columns.push_back(name);
    Table table(columns);
    for (const QuantityKind& kind : kinds_with_slopes(comparison)) {
        std::vector<Cell> row = {fmt::format("{}, {}", kind.group, kind.name)};
        for (const double slope : slopes_of(comparison, kind.key))
            row.emplace_back(std::isnan(slope) ? "-" : fmt::format("{:.2f}", slope));
        table.add(std::move(row));
    }
    if (table.empty()) return "";
    return fmt::format("\n## Slopes over {}\n\nOf log(quantity) over log({}), by least squares.\n\n{}",
                       code(comparison.over), comparison.over_name, table.markdown());
}

std::string list_of_strings(const std::vector<std::string>& texts) {
    std::vector<std::string> quoted;
    for (const std::string& text : texts) quoted.push_back(json_string(text));
    return fmt::format("[{}]", join(quoted));
}

/// {"pair": 1, ...}, by variant.
std::string by_variant(const Comparison& comparison, const std::vector<double>& values) {
    std::vector<std::string> members;
    for (std::size_t v = 0; v < values.size(); ++v)
        members.push_back(
            fmt::format("{}: {}", json_string(comparison.variants[v].name), json_number(values[v])));
    return fmt::format("{{{}}}", join(members));
}

std::string list(const std::vector<std::string>& items) {
    return items.empty() ? "[]" : fmt::format("[\n    {}\n  ]", join(items, ",\n    "));
}

std::string run_json(const Comparison& comparison, const ComparedRun& run) {
    std::vector<std::string> quantities, folders;
    for (const Quantity& quantity : run.quantities)
        quantities.push_back(
            fmt::format("{}: {}", json_string(quantity.kind.key), json_number(quantity.value)));
    for (const StudyRun& repeat : run.repeats) folders.push_back("runs/" + repeat.name);
    const std::string level = comparison.over.empty() ? "null" : json_string(comparison.levels[run.level]);
    return fmt::format(
        "{{\"variant\": {}, \"level\": {}, \"outcome\": {}, \"message\": {}, \"overrides\": {}, \"folders\": "
        "{}, "
        "\"state_hash\": {}, \"deck_hash\": {}, \"same_bits\": {},\n     \"quantities\": {{{}}}}}",
        json_string(comparison.variants[run.variant].name), level, json_string(run.end.outcome),
        json_string(run.end.message), list_of_strings(run.repeats.front().overrides),
        list_of_strings(folders), json_string(run.files.summary.text("state_hash")),
        json_string(run.repeats.front().hash), run.same_bits, join(quantities));
}

std::string verdict_json(const Comparison& comparison, std::size_t level, const QuantityKind& kind) {
    const Verdict verdict = judge_at(comparison, level, kind);
    if (verdict.best.empty()) return {};
    return fmt::format("{{\"quantity\": {}, \"level\": {}, \"best\": {}, \"factor\": {}, \"text\": {}}}",
                       json_string(kind.key),
                       comparison.over.empty() ? "null" : json_string(comparison.levels[level]),
                       list_of_strings(verdict.best), json_number(verdict.factor), json_string(verdict.text));
}

}  // namespace

std::string comparison_markdown(const Comparison& comparison, const std::vector<std::string>& plots) {
    std::string text = introduction(comparison) + troubles(comparison) + verdicts(comparison) +
                       quantity_tables(comparison) + slope_table(comparison);
    if (!plots.empty()) text += "\n## Charts\n";
    for (const std::string& plot : plots)
        text += fmt::format("\n![{}]({})\n", plot.substr(0, plot.find('.')), plot);
    return text;
}

std::string comparison_json(const Comparison& comparison, const std::vector<std::string>& plots) {
    std::vector<std::string> variants, dropped, quantities, runs, verdict_list, slopes;
    for (const Variant& variant : comparison.variants)
        variants.push_back(fmt::format("{{\"name\": {}, \"overrides\": {}}}", json_string(variant.name),
                                       list_of_strings(variant.overrides)));
    for (const DroppedVariant& variant : comparison.dropped)
        dropped.push_back(fmt::format("{{\"name\": {}, \"reason\": {}}}", json_string(variant.name),
                                      json_string(variant.reason)));
    for (std::size_t l = 0; l < comparison.levels.size(); ++l)
        for (const QuantityKind& kind : kinds_at(comparison, l)) {
            if (l == comparison.last_level())
                quantities.push_back(fmt::format(
                    "{{\"key\": {}, \"group\": {}, \"name\": {}, \"unit\": {}, \"less_is_better\": {}}}",
                    json_string(kind.key), json_string(kind.group), json_string(kind.name),
                    json_string(kind.unit), kind.less_is_better));
            if (const std::string verdict = verdict_json(comparison, l, kind); !verdict.empty())
                verdict_list.push_back(verdict);
        }
    for (const ComparedRun& run : comparison.runs) runs.push_back(run_json(comparison, run));
    for (const QuantityKind& kind : kinds_with_slopes(comparison))
        slopes.push_back(fmt::format("{{\"quantity\": {}, \"slopes\": {}}}", json_string(kind.key),
                                     by_variant(comparison, slopes_of(comparison, kind.key))));
    std::string text = "{\n";
    const auto add = [&](const char* key, const std::string& value, bool last = false) {
        text += fmt::format("  {}: {}{}\n", json_string(key), value, last ? "" : ",");
    };
    add("deck", json_string(comparison.base.deck));
    add("title", json_string(comparison.runs.front().deck.title));
    add("settings", list_of_strings(comparison.settings));
    add("threads", fmt::format("{}", comparison.base.threads));
    add("repeats", fmt::format("{}", comparison.n_repeats));
    add("over", comparison.over.empty() ? "null" : json_string(comparison.over));
    add("levels", comparison.over.empty() ? "[]" : list_of_strings(comparison.levels));
    add("reference", json_string(comparison.reference));
    add("variants", list(variants));
    add("dropped", list(dropped));
    add("quantities", list(quantities));
    add("runs", list(runs));
    add("verdicts", list(verdict_list));
    add("slopes", list(slopes));
    add("plots", list_of_strings(plots), true);
    return text + "}\n";
}

}  // namespace quern
