// The command line: quern run | sweep | compare | check | schema | render | plot | import | pack.
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <new>

#include "grid/error.hpp"
#include "quern_version.hpp"
#include "src/deck/read_deck.hpp"
#include "src/import/import_peridem.hpp"
#include "src/pack/pack.hpp"
#include "src/pack/pack_spec.hpp"
#include "src/results/render.hpp"
#include "src/sim/run.hpp"
#include "src/study/compare.hpp"
#include "src/study/plot.hpp"
#include "src/study/sweep.hpp"

namespace {

using namespace quern;

/// A run stopped by the user: what the shell reports for SIGINT.
constexpr int interrupted_code = 130;

struct Arguments {
    std::string deck;
    std::vector<std::string> overrides;
    RunOptions run;
    RenderOptions render;
    ImportOptions import;
    SweepOptions sweep;
    CompareOptions compare;
    PackOptions pack;
    PlotOptions plot;
    bool list_plots = false;
    std::vector<double> range;  ///< of the colours
    bool of_packings = false;
    bool markdown = false, profile = false;
    std::string resumed;  ///< folder of a run
};

int report(std::string message, int code) {
    std::replace(message.begin(), message.end(), '\n', ' ');
    fmt::print(stderr, "quern: error: {}\n", message);
    return code;
}

/// Stages of the step: seconds, share of all stages, and ns per particle and step.
void print_profile(const Summary& summary) {
    double total = 0.0;
    for (const auto& [stage, seconds] : summary.stages) total += seconds;
    const double particle_steps = static_cast<double>(summary.n_particles) *
                                  static_cast<double>(std::max<std::int64_t>(1, summary.steps));
    fmt::print("\n{:<16} {:>10} {:>8} {:>22}\n", "stage", "seconds", "share", "ns/particle and step");
    for (const auto& [stage, seconds] : summary.stages)
        fmt::print("{:<16} {:10.3f} {:7.1f}% {:22.1f}\n", stage, seconds,
                   total > 0.0 ? 100.0 * seconds / total : 0.0, 1e9 * seconds / particle_steps);
    fmt::print("{:<16} {:10.3f} beside the steps, on a thread of its own\n", "writer",
               summary.writer_seconds);
    for (const auto& [what, mean] : summary.contact_per_step)
        fmt::print("contact {:<8} {:10.4g} a step\n", what, mean);
    fmt::print("memory {:20.3f} kB a particle at its peak, instructions {}\n\n",
               1e-3 * summary.peak_memory_bytes / static_cast<double>(summary.n_particles),
               summary.instructions);
}

RunOutcome resume(const Arguments& arguments, RunOptions& options, RunRecord& record) {
    options.directory = arguments.resumed;
    return resume_run(options, &record);
}

RunOutcome start(const Arguments& arguments, RunOptions& options, RunRecord& record) {
    const Deck deck = read_deck(arguments.deck, arguments.overrides);
    if (options.directory.empty()) {
        options.directory =
            (std::filesystem::path("out") / std::filesystem::path(arguments.deck).stem()).string();
    }
    return run_deck(deck, options, &record);
}

int run(const Arguments& arguments) {
    RunOptions options = arguments.run;
    options.progress_terminal = isatty(STDERR_FILENO) != 0;
    RunRecord record;
    const RunOutcome outcome =
        arguments.resumed.empty() ? start(arguments, options, record) : resume(arguments, options, record);
    const Summary& summary = record.summary;
    fmt::print("{}: {} grains, {} particles, {} bonds\n",
               outcome == RunOutcome::done ? "done" : "interrupted", summary.n_grains, summary.n_particles,
               summary.n_bonds);
    fmt::print("steps            {} of {:.4g} s to t = {:.6g} s\n", summary.steps, summary.time_step,
               summary.simulated_time);
    fmt::print("wall time        {:.3f} s, {:.1f} ns per particle and step, {} threads\n",
               summary.wall_seconds, summary.ns_per_particle_step, summary.threads);
    fmt::print("energy residual  {:.2e} of the energy that changed hands\n", summary.residual_relative);
    fmt::print("momentum error   {:.2e} linear", summary.momentum_error_linear);
    if (!std::isnan(summary.momentum_error_angular))
        fmt::print(", {:.2e} angular", summary.momentum_error_angular);
    fmt::print("\n");
    for (const auto& [text, count] : summary.warnings)
        fmt::print("warning          {} ({} times)\n", text, count);
    if (arguments.profile) print_profile(summary);
    fmt::print("results          {}\n", options.directory);
    return outcome == RunOutcome::done ? 0 : interrupted_code;
}

int draw(const Arguments& arguments) {
    RenderOptions options = arguments.render;
    if (arguments.range.size() == 2) {
        options.low = arguments.range[0];
        options.high = arguments.range[1];
    }
    for (const std::string& file : render(options)) fmt::print("{}\n", file);
    return 0;
}

int draw_plots(const Arguments& arguments) {
    if (arguments.list_plots) {
        for (const auto& [name, about] : plot_names()) fmt::print("{:<16} {}\n", name, about);
        return 0;
    }
    if (arguments.plot.directory.empty())
        return report("plot: a folder of results is required (quern plot --help)", InputError::exit_code);
    const PlotReport done = plot(arguments.plot);
    for (const std::string& file : done.files) fmt::print("{}\n", file);
    for (const auto& [name, missing] : done.left_out) fmt::print("left out         {}: {}\n", name, missing);
    if (!done.left_out.empty())
        fmt::print("what is observed is drawn of runs with observe in the deck: docs/observers.md\n");
    return 0;
}

int import(const Arguments& arguments) {
    const ImportReport report = import_peridem(arguments.import);
    fmt::print("imported         {} bodies, {} shapes\n", report.n_bodies, report.n_shapes);
    for (const std::string& text : report.differs) fmt::print("differs          {}\n", text);
    for (const std::string& file : report.files) fmt::print("written          {}\n", file);
    return 0;
}

int make_pack(const Arguments& arguments) {
    PackOptions options = arguments.pack;
    options.terminal = isatty(STDERR_FILENO) != 0;
    const PackReport report = pack(options);
    fmt::print("packed           {} grains, solid fraction {:.4f}, {:.2f} contacts a grain\n",
               report.n_grains, report.fraction, report.coordination);
    fmt::print("deepest overlap  {:.1e} of the size\n", report.deepest);
    fmt::print("sizes            {:.5f} times those drawn\n", report.size_factor);
    for (const std::string& file : report.files) fmt::print("written          {}\n", file);
    return 0;
}

void add_import(CLI::App& app, Arguments& arguments) {
    CLI::App& command = *app.add_subcommand("import", "Make a deck from that of another program");
    command.require_subcommand(0, 1);
    CLI::App& peridem = *command.add_subcommand(
        "peridem",
        "A PeriDEM deck (YAML, meshes, table of grains); docs/import.md says what becomes of its keys");
    peridem.add_option("input", arguments.import.input, "PeriDEM's YAML file, e.g. inp/input_0.yaml")
        ->required()
        ->type_name("FILE");
    peridem
        .add_option("-o,--output", arguments.import.output,
                    "Deck to write; meshes and tables of grains go beside it")
        ->required()
        ->type_name("DECK");
    peridem
        .add_option_function<std::string>(
            "--horizon",
            [&arguments](const std::string& word) {
                arguments.import.horizon =
                    word == "scaled" ? ImportedHorizon::scaled : ImportedHorizon::absolute;
            },
            "absolute (default): as in PeriDEM, a shape for each size of grain; scaled: grows with the "
            "grain, "
            "one shape a zone, which runs faster")
        ->type_name("absolute|scaled")
        ->check(CLI::IsMember({"absolute", "scaled"}));
    peridem.add_flag("--force", arguments.import.force, "Overwrite files that exist");
}

CLI::App& add_plot(CLI::App& app, Arguments& arguments) {
    PlotOptions& options = arguments.plot;
    CLI::App& command = *app.add_subcommand("plot", "Draw all plots of a run; docs/observers.md");
    command.add_option("directory", options.directory, "Folder of the results")->type_name("DIR");
    command
        .add_option("names", options.names,
                    "Plots, as --list names them; default: all that there is data for")
        ->type_name("PLOT");
    command.add_flag("--list", arguments.list_plots, "Names of the plots and what they show");
    command.add_option("-o,--output", options.output, "Folder of the pictures; default: DIR/plots")
        ->type_name("FOLDER");
    command
        .add_option(
            "--frame", options.frames,
            "Frames of the profiles, the last of them for the other plots: numbers from 0, or last; default: "
            "four of them")
        ->type_name("K,...")
        ->delimiter(',');
    command.add_option("--region", options.region, "Region of the plot 'stress'")
        ->type_name("NAME")
        ->capture_default_str();
    return command;
}

void add_overrides(CLI::App& command, Arguments& arguments) {
    command
        .add_option("--set", arguments.overrides,
                    "Set a key of the deck, e.g. --set params.theta=45; repeatable")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
}

CLI::App& add_pack(CLI::App& app, Arguments& arguments) {
    PackOptions& options = arguments.pack;
    CLI::App& command = *app.add_subcommand("pack", "Make a dense packing of grains for decks; docs/pack.md");
    command.add_option("spec", options.spec, "What to pack (YAML)")->required()->type_name("SPEC");
    command.add_option("-o,--output", options.output, "Table of grains (.csv); .json and .png lie beside it")
        ->required()
        ->type_name("FILE");
    command.add_option("--set", options.overrides, "Set a key of the file, e.g. --set seed=2; repeatable")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    return command;
}

CLI::App& add_sweep(CLI::App& app, Arguments& arguments) {
    SweepOptions& options = arguments.sweep;
    CLI::App& command = *app.add_subcommand("sweep", "Run a deck under all combinations of some values");
    command.add_option("deck", options.base.deck, "Deck (YAML)")->required()->type_name("DECK");
    command.add_option("-o,--output", options.directory, "Folder of the table and of runs/")
        ->required()
        ->type_name("DIR");
    command
        .add_option("--set", options.settings,
                    "A key of the deck and its values, e.g. --set params.mu=0.1,0.3; repeatable")
        ->type_name("KEY=VALUE,...")
        ->allow_extra_args(false);
    command
        .add_option(
            "--value", options.values,
            "A column of the table, e.g. grains.0.x.last or loss=history.contact_loss.max; repeatable")
        ->type_name("[NAME=]FORMULA")
        ->allow_extra_args(false);
    command.add_option("-j,--jobs", options.at_once, "Runs at a time")
        ->type_name("N")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    command.add_option("--threads", options.base.threads, "Threads of each run")
        ->type_name("T")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    return command;
}

CLI::App& add_compare(CLI::App& app, Arguments& arguments) {
    CompareOptions& options = arguments.compare;
    CLI::App& command = *app.add_subcommand("compare", "Run variants of a deck and report how they differ");
    command.add_option("deck", options.base.deck, "Deck (YAML)")->required()->type_name("DECK");
    command.add_option("-o,--output", options.directory, "Folder of the report and of runs/")
        ->required()
        ->type_name("DIR");
    command
        .add_option(
            "--variant", options.variants,
            "A variant, e.g. --variant \"flip: contact.rule=seed, contact.coupling=flip\"; repeatable; "
            "'default' stands for pair, surface, seed and node_pair, which are taken if none is given")
        ->type_name("'NAME: KEY=VALUE, ...'")
        ->allow_extra_args(false);
    command.add_option("--over", options.over, "A key and its values, each for all variants")
        ->type_name("KEY=VALUE,...");
    command.add_option("--set", options.settings, "Set a key of the deck in all runs; repeatable")
        ->type_name("KEY=VALUE")
        ->allow_extra_args(false);
    command
        .add_option(
            "--reference", options.reference,
            "What differences are to: a variant (at the last value of --over), or a table as grains.csv; "
            "default: the first variant")
        ->type_name("NAME|FILE.csv");
    command.add_option("--repeat", options.n_repeats, "Runs of each variant, in turns, for the times")
        ->type_name("N")
        ->check(CLI::Range(1, 1000))
        ->capture_default_str();
    command.add_flag("--reuse", options.reuse,
                     "Take runs that are done already; their times are those of then");
    command.add_option("--threads", options.base.threads, "Threads of each run")
        ->type_name("T")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    return command;
}

/// Path of this program, to start its runs by.
std::string own_path() {
    return std::filesystem::read_symlink("/proc/self/exe").string();
}

/// Declares all commands and returns what the chosen one does.
int parse_and_run(int argc, char** argv) {
    Arguments arguments;
    CLI::App app(
        "Quern simulates deformable grains: peridynamic particles that touch through a background grid.",
        "quern");
    app.require_subcommand(0, 1);
    app.set_version_flag("--version", "quern " QUERN_VERSION);
    app.footer("Exit codes: 0 done, 2 bad input, 3 simulation failed, 4 output failed, 130 interrupted.");

    CLI::App& run_command = *app.add_subcommand("run", "Run a deck");
    CLI::Option* const deck_option =
        run_command.add_option("deck", arguments.deck, "Deck (YAML)")->type_name("DECK");
    CLI::Option* const output_option =
        run_command
            .add_option("-o,--output", arguments.run.directory, "Folder of the results; default: out/<deck>")
            ->type_name("DIR");
    run_command
        .add_option("--resume", arguments.resumed,
                    "Go on with the run in this folder from its last checkpoint, instead of a deck")
        ->type_name("DIR")
        ->excludes(deck_option, output_option);
    run_command.add_option("--threads", arguments.run.threads, "Number of threads; default: all cores")
        ->type_name("N")
        ->check(CLI::Range(1, 4096));
    run_command.add_flag("--profile", arguments.profile, "Print what each stage of the step took");
    add_overrides(run_command, arguments);

    CLI::App& sweep_command = add_sweep(app, arguments);
    CLI::App& compare_command = add_compare(app, arguments);
    CLI::App& pack_command = add_pack(app, arguments);
    CLI::App& plot_command = add_plot(app, arguments);

    CLI::App& check_command = *app.add_subcommand("check", "Check a deck and print it resolved, in SI units");
    check_command.add_option("deck", arguments.deck, "Deck (YAML)")->required()->type_name("DECK");
    add_overrides(check_command, arguments);

    CLI::App& schema_command = *app.add_subcommand("schema", "Print the JSON Schema of decks");
    schema_command.add_flag("--markdown", arguments.markdown,
                            "The reference of all keys as Markdown instead");
    schema_command.add_flag("--pack", arguments.of_packings, "Of packings instead of decks");

    CLI::App& render_command = *app.add_subcommand("render", "Draw frames of a run");
    render_command.add_option("directory", arguments.render.directory, "Folder of the results")
        ->required()
        ->type_name("DIR");
    render_command.add_option("-o,--output", arguments.render.file, "Picture (.png)")
        ->required()
        ->type_name("FILE");
    render_command
        .add_option(
            "--field", arguments.render.field,
            "speed, velocity_x, damage, damage_z, plastic_strain, grain, fragment, von_mises, pressure, "
            "stress_xx, "
            "principal_difference, "
            "displacement...")
        ->type_name("NAME")
        ->capture_default_str();
    render_command
        .add_option("--range", arguments.range,
                    "Ends of the colours, the same in every frame; default: by the data")
        ->type_name("LOW HIGH")
        ->expected(2);
    render_command.add_flag("--dark", arguments.render.dark,
                            "Black where nothing is; fields from zero up glow, as photoelastic grains do");
    render_command.add_option("--frame", arguments.render.frame, "last, all, or a number from 0")
        ->type_name("last|K|all")
        ->capture_default_str();

    add_import(app, arguments);
    for (CLI::App* command : app.get_subcommands({}))
        command->set_version_flag("--version", "quern " QUERN_VERSION);

    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);
        return report(std::string(error.what()) + " (quern --help)", InputError::exit_code);
    }
    if (app.get_subcommands().empty()) {
        return report(
            "a command is required: run, sweep, compare, check, schema, render, plot, import or pack (quern "
            "--help)",
            InputError::exit_code);
    }
    if (run_command.parsed() && arguments.deck.empty() && arguments.resumed.empty())
        return report("run: a deck, or --resume and a folder, is required (quern run --help)",
                      InputError::exit_code);
    if (!arguments.resumed.empty() && !arguments.overrides.empty())
        return report("run: --set does not go with --resume: the run goes on with its own deck",
                      InputError::exit_code);
    if (run_command.parsed()) return run(arguments);
    if (sweep_command.parsed()) {
        arguments.sweep.base.program = own_path();
        arguments.sweep.terminal = isatty(STDERR_FILENO) != 0;
        return sweep(arguments.sweep);
    }
    if (compare_command.parsed()) {
        arguments.compare.base.program = own_path();
        arguments.compare.terminal = isatty(STDERR_FILENO) != 0;
        return compare(arguments.compare);
    }
    if (pack_command.parsed()) return make_pack(arguments);
    if (render_command.parsed()) return draw(arguments);
    if (plot_command.parsed()) return draw_plots(arguments);
    if (app.got_subcommand("import")) {
        if (app.get_subcommand("import")->get_subcommands().empty())
            return report("a format is required: peridem (quern import --help)", InputError::exit_code);
        return import(arguments);
    }
    std::string text;
    if (check_command.parsed())
        text = resolved_yaml(read_deck(arguments.deck, arguments.overrides));
    else if (arguments.of_packings)
        text = arguments.markdown ? pack_reference() : pack_schema();
    else
        text = arguments.markdown ? deck_reference() : deck_schema();
    const bool written = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
    return written ? 0 : report("cannot write to standard output", OutputError::exit_code);
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return parse_and_run(argc, argv);
    } catch (const InputError& error) {
        return report(error.what(), InputError::exit_code);
    } catch (const SimulationError& error) {
        return report(error.what(), SimulationError::exit_code);
    } catch (const OutputError& error) {
        return report(error.what(), OutputError::exit_code);
    } catch (const std::filesystem::filesystem_error& error) {
        return report(error.what(), OutputError::exit_code);
    } catch (const std::bad_alloc&) {
        return report("out of memory", SimulationError::exit_code);
    } catch (const std::exception& error) {
        return report(error.what(), SimulationError::exit_code);
    }
}
