#include "src/study/sweep.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "grid/error.hpp"
#include "src/deck/read_deck.hpp"
#include "src/results/json.hpp"
#include "src/results/output_file.hpp"
#include "src/results/stop_signals.hpp"
#include "src/study/run_values.hpp"
#include "src/study/settings.hpp"
#include "src/study/study_progress.hpp"
#include "src/study/table.hpp"

namespace quern {

namespace {

struct Numbers {
    const char *column, *path;  ///< of the table, of summary.json
};
constexpr Numbers summary_numbers[] = {{"steps", "steps"},
                                       {"time_step", "time_step"},
                                       {"simulated_time", "simulated_time"},
                                       {"n_particles", "n_particles"},
                                       {"wall_seconds", "wall_seconds"},
                                       {"ns_per_particle_step", "ns_per_particle_step"},
                                       {"peak_memory_bytes", "peak_memory_bytes"},
                                       {"kinetic", "energy.kinetic"},
                                       {"elastic", "energy.elastic"},
                                       {"gravity", "energy.gravity"},
                                       {"damping", "energy.damping"},
                                       {"friction", "energy.friction"},
                                       {"contact_loss", "energy.contact_loss"},
                                       {"fracture", "energy.fracture"},
                                       {"plastic", "energy.plastic"},
                                       {"transfer_loss", "energy.transfer_loss"},
                                       {"external_work", "energy.external_work"},
                                       {"residual", "energy.residual"},
                                       {"throughput", "energy.throughput"},
                                       {"residual_relative", "energy.residual_relative"},
                                       {"momentum_error_linear", "momentum_error.linear"},
                                       {"momentum_error_angular", "momentum_error.angular"}};

struct Plan {
    std::vector<SweptKey> keys;
    std::vector<StudyCase> cases;
    std::vector<StudyRun> runs;  ///< of the cases
    std::vector<RunValue> values;
};

/// Reads every deck of the sweep: a mistake in any of them is told before the first run.
Plan make_plan(const SweepOptions& options) {
    Plan plan;
    for (const std::string& text : options.settings) plan.keys.push_back(parse_swept(text, "--set"));
    plan.cases = product(plan.keys);
    for (const StudyCase& one : plan.cases) {
        const Deck deck = read_deck(options.base.deck, one.overrides);
        plan.runs.push_back(
            {one.name, options.directory + "/runs/" + one.name, one.overrides, deck_hash(deck)});
        plan.values.clear();
        for (const std::string& text : options.values) plan.values.emplace_back(text, deck);
    }
    return plan;
}

Table make_table(const Plan& plan, const std::vector<RunEnd>& ends) {
    std::vector<std::string> columns = {"run"};
    for (const SweptKey& swept : plan.keys) columns.push_back(swept.key);
    columns.insert(columns.end(), {"outcome", "message"});
    for (const Numbers& number : summary_numbers) columns.emplace_back(number.column);
    columns.insert(columns.end(), {"n_warnings", "warnings", "state_hash", "deck_hash"});
    for (const RunValue& value : plan.values) columns.push_back(value.name());
    Table table(columns);
    for (std::size_t i = 0; i < plan.runs.size(); ++i) {
        const bool started = ends[i].outcome != "missing";
        const RunFiles run = started ? read_run(plan.runs[i].directory) : RunFiles();
        std::vector<Cell> row = {plan.runs[i].name};
        for (const std::string& value : plan.cases[i].values) row.emplace_back(value);
        row.emplace_back(ends[i].outcome);
        row.emplace_back(ends[i].message);
        for (const Numbers& number : summary_numbers) row.emplace_back(run.summary.number(number.path));
        row.emplace_back(run.summary.exists() ? run.summary.n_warnings()
                                              : std::numeric_limits<double>::quiet_NaN());
        row.emplace_back(run.summary.warnings());
        row.emplace_back(run.summary.text("state_hash"));
        row.emplace_back(plan.runs[i].hash);
        for (const RunValue& value : plan.values) row.emplace_back(value.of(run));
        table.add(std::move(row));
    }
    return table;
}

std::size_t count(const std::vector<RunEnd>& ends, const std::string& outcome) {
    return static_cast<std::size_t>(
        std::count_if(ends.begin(), ends.end(), [&](const RunEnd& end) { return end.outcome == outcome; }));
}

}  // namespace

int sweep(const SweepOptions& options) {
    const Plan plan = make_plan(options);
    const FolderLock lock(options.directory);
    const StopSignals signals;
    std::vector<RunEnd> ends(plan.runs.size());
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < plan.runs.size(); ++i) {
        if (is_done(plan.runs[i]))
            ends[i].outcome = "done";
        else
            missing.push_back(i);
    }
    fmt::print("{} runs, {} of them done before\n", plan.runs.size(), plan.runs.size() - missing.size());
    std::fflush(stdout);
    StudyProgress progress(missing.size(), options.terminal);
    std::vector<ProcessJob> jobs;
    for (const std::size_t i : missing) jobs.push_back(make_job(options.base, plan.runs[i]));
    run_processes(jobs, options.at_once, [&](std::size_t job, const ProcessEnd& end) {
        const std::size_t i = missing[job];
        ends[i] = end_of(plan.runs[i], end);
        progress.ended(plan.runs[i].name, ends[i], end.seconds);
    });
    progress.finish();
    const Table table = make_table(plan, ends);
    write_whole_file(options.directory + "/sweep.csv", table.csv());
    write_whole_file(
        options.directory + "/sweep.json",
        fmt::format("{{\"deck\": {}, \"runs\": {}}}\n", json_string(options.base.deck), table.json()));
    const std::size_t n_left = count(ends, "missing") + count(ends, "interrupted");
    const std::size_t n_failed = count(ends, "failed");
    fmt::print("done {}, failed {}, left {}: {}/sweep.csv\n", count(ends, "done"), n_failed, n_left,
               options.directory);
    if (n_left > 0) fmt::print("the same command runs what is left\n");
    return stop_requested() ? interrupted_exit_code : n_failed + n_left > 0 ? SimulationError::exit_code : 0;
}

}  // namespace quern
