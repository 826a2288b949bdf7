#include "src/study/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "grid/error.hpp"
#include "src/deck/names.hpp"
#include "src/deck/read_deck.hpp"
#include "src/results/output_file.hpp"
#include "src/results/stop_signals.hpp"
#include "src/study/comparison.hpp"
#include "src/study/settings.hpp"
#include "src/study/study_progress.hpp"

namespace quern {

namespace {

/// A table with time and x; other columns of grains.csv are used where it has them.
Trajectories read_reference(const std::string& file) {
    const Columns table = read_columns(file);
    for (const char* name : {"time", "x"})
        if (!table.find(name))
            throw InputError(file, "the columns " + join(table.names), fmt::format("also '{}'", name),
                             "as grains.csv has them");
    if (table.n_rows() < 2) throw InputError(file, "fewer than two rows", "a trajectory");
    return split_by_grain(table);
}

void choose_reference(Comparison& comparison, const std::string& given) {
    std::vector<std::string> names;
    for (const Variant& variant : comparison.variants) names.push_back(variant.name);
    comparison.reference_is_truth = !given.empty();
    comparison.reference = given.empty() ? names.front() : given;
    if (std::find(names.begin(), names.end(), comparison.reference) != names.end()) return;
    if (!std::filesystem::exists(given))
        throw InputError("--reference", "'" + given + "', neither a variant nor a file",
                         "one of " + join(names) + ", or a CSV file", did_you_mean(given, names));
    comparison.reference_is_file = true;
    comparison.trajectories = read_reference(given);
}

/// Everything but results. A mistake anywhere is told before the first run.
Comparison make_plan(const CompareOptions& options) {
    Comparison plan;
    plan.base = options.base;
    plan.settings = options.settings;
    plan.n_repeats = options.n_repeats;
    std::vector<std::vector<std::string>> levels = {options.settings};
    plan.levels = {""};
    if (!options.over.empty()) {
        const SweptKey swept = parse_swept(options.over, "--over");
        plan.over = swept.key;
        plan.over_name = short_names({swept}).front();
        plan.levels = swept.values;
        levels.assign(swept.values.size(), options.settings);
        for (std::size_t l = 0; l < levels.size(); ++l)
            levels[l].push_back(swept.key + "=" + swept.values[l]);
    }
    const VariantChoice choice =
        choose_variants(options.variants, default_variants(), options.base.deck, levels.front());
    plan.variants = choice.variants;
    plan.dropped = choice.dropped;
    choose_reference(plan, options.reference);
    for (std::size_t l = 0; l < plan.levels.size(); ++l)
        for (std::size_t v = 0; v < plan.variants.size(); ++v) {
            ComparedRun run;
            run.variant = v;
            run.level = l;
            std::vector<std::string> overrides = levels[l];
            const std::vector<std::string>& own = plan.variants[v].overrides;
            overrides.insert(overrides.end(), own.begin(), own.end());
            run.deck = read_deck(options.base.deck, overrides);
            for (int r = 0; r < plan.n_repeats; ++r) {
                std::string name = plan.variants[v].name;
                if (!plan.over.empty()) name += "," + plan.level_name(l);
                if (r > 0) name += fmt::format("+{}", r + 1);
                name = folder_name(name);
                run.repeats.push_back(
                    {name, options.directory + "/runs/" + name, overrides, deck_hash(run.deck)});
            }
            plan.runs.push_back(std::move(run));
        }
    return plan;
}

/// A repeat of a run.
struct Turn {
    std::size_t run, repeat;
};

/// Repeat by repeat, every other one backwards: a machine that gets slower is unfair to nobody.
std::vector<Turn> turns_of(const Comparison& plan) {
    std::vector<Turn> turns;
    for (std::size_t r = 0; r < static_cast<std::size_t>(plan.n_repeats); ++r)
        for (std::size_t i = 0; i < plan.runs.size(); ++i)
            turns.push_back({r % 2 == 0 ? i : plan.runs.size() - 1 - i, r});
    return turns;
}

void run_all(Comparison& plan, const CompareOptions& options) {
    std::vector<Turn> turns = turns_of(plan);
    for (ComparedRun& run : plan.runs) run.end.outcome = "done";
    if (options.reuse)
        std::erase_if(turns,
                      [&](const Turn& turn) { return is_done(plan.runs[turn.run].repeats[turn.repeat]); });
    std::vector<ProcessJob> jobs;
    for (const Turn& turn : turns) {
        jobs.push_back(make_job(plan.base, plan.runs[turn.run].repeats[turn.repeat]));
        plan.runs[turn.run].end.outcome = "missing";
    }
    fmt::print("{} runs, one after the other\n", jobs.size());
    std::fflush(stdout);
    StudyProgress progress(jobs.size(), options.terminal);
    run_processes(jobs, 1, [&](std::size_t job, const ProcessEnd& end) {
        ComparedRun& run = plan.runs[turns[job].run];
        const StudyRun& repeat = run.repeats[turns[job].repeat];
        const RunEnd now = end_of(repeat, end);
        if (run.end.outcome == "missing" || run.end.outcome == "done") run.end = now;
        progress.ended(repeat.name, now, end.seconds);
    });
    progress.finish();
}

/// Removes default variants that turned out to be refused once their scene was made.
void drop_refused(Comparison& plan) {
    for (std::size_t v = plan.variants.size(); v-- > 0;) {
        const RunEnd end = plan.run(0, v).end;
        if (!plan.variants[v].may_be_dropped || end.exit_code != InputError::exit_code) continue;
        plan.dropped.push_back({plan.variants[v].name, end.message});
        plan.variants.erase(plan.variants.begin() + static_cast<std::ptrdiff_t>(v));
        std::erase_if(plan.runs, [&](const ComparedRun& run) { return run.variant == v; });
        for (ComparedRun& run : plan.runs)
            if (run.variant > v) --run.variant;
    }
}

void measure_all(Comparison& plan) {
    for (ComparedRun& run : plan.runs) {
        if (!run.done()) continue;
        run.files = read_run(run.repeats.front().directory);
        std::vector<RunSummary> repeats;
        for (const StudyRun& repeat : run.repeats) {
            repeats.emplace_back(repeat.directory);
            run.same_bits =
                run.same_bits && repeats.back().text("state_hash") == repeats.front().text("state_hash");
        }
        run.cost = median_cost(repeats);
        if (plan.is_reference(run)) plan.trajectories = run.files.grains;
    }
    for (ComparedRun& run : plan.runs) {
        if (!run.done()) continue;
        const bool alone = plan.is_reference(run) || plan.trajectories.empty();
        run.quantities = measure(run.deck, run.files, run.cost, alone ? nullptr : &plan.trajectories,
                                 plan.reference_is_truth);
    }
}

}  // namespace

int compare(const CompareOptions& options) {
    Comparison comparison = make_plan(options);
    const FolderLock lock(options.directory);
    for (const DroppedVariant& variant : comparison.dropped)
        fmt::print("without {}: {}\n", variant.name, variant.reason);
    {
        const StopSignals signals;
        run_all(comparison, options);
        if (stop_requested()) {
            fmt::print("interrupted; the same command with --reuse runs what is left\n");
            return interrupted_exit_code;
        }
    }
    drop_refused(comparison);
    if (comparison.variants.empty())
        throw InputError("--variant", "no variant that this version takes", "at least one",
                         comparison.dropped.front().reason);
    measure_all(comparison);
    const std::vector<std::string> plots = draw_comparison(comparison, options.directory);
    write_whole_file(options.directory + "/comparison.json", comparison_json(comparison, plots));
    write_whole_file(options.directory + "/comparison.md", comparison_markdown(comparison, plots));
    const auto n_failed = std::count_if(comparison.runs.begin(), comparison.runs.end(),
                                        [](const ComparedRun& run) { return !run.done(); });
    fmt::print("{}/comparison.md, comparison.json", options.directory);
    for (const std::string& plot : plots) fmt::print(", {}", plot);
    fmt::print("\n");
    return n_failed == 0 ? 0 : SimulationError::exit_code;
}

}  // namespace quern
