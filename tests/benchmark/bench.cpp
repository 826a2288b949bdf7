// What a step costs: roofline of the machine, kernels, stages and whole problems in one table and one file.
//
// One thread stays on one core. Times are medians over repetitions; README.md says how bytes and flops are
// counted, docs/performance.md how to read the numbers.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>

#include "grid/error.hpp"
#include "src/results/output_file.hpp"
#include "tests/benchmark/kernels.hpp"
#include "tests/benchmark/machine.hpp"
#include "tests/benchmark/methods.hpp"
#include "tests/benchmark/plots.hpp"
#include "tests/benchmark/problems.hpp"
#include "tests/benchmark/roofline.hpp"

namespace quern::bench {

namespace {

struct Options {
    std::string directory = "out/bench", revision = "unknown";
    std::string only;  ///< part of a name; empty: everything
    bool all = false;
    bool methods = false;
};

class Bench {
  public:
    explicit Bench(const Options& options) : options_(options) {
        report_.machine = describe_machine(options.revision);
    }

    void run() {
        for (const auto& [key, value] : report_.machine) fmt::print("{:16}{}\n", key, value);
        const std::vector<int> threads = options_.all && n_cores() > 1 ? std::vector{1, 2} : std::vector{1};
        for (const int n : threads) measure_roof(n);
        if (n_cores() > threads.back()) measure_roof(n_cores());
        fmt::print("\n{}", table_head());
        if (options_.methods) {
            compare_methods();
        } else {
            run_kernels();
            for (const Problem& problem : make_problems(BENCH_DIR, options_.all))
                if (problem.name.find(options_.only) != std::string::npos)
                    for (const int n : threads) add(with_speed_up(run_problem(problem, n)));
        }
        const std::string file = options_.directory + (options_.methods ? "/methods" : "/bench");
        create_directory(options_.directory);
        write_whole_file(file + ".json", report_json(report_));
        draw_report(report_, file + ".png");
        fmt::print("\n{0}.json, {0}.png\n", file);
    }

  private:
    void measure_roof(int threads) {
        const Roofline roof = measure_roofline(threads);
        report_.rooflines.push_back(roof);
        fmt::print("{:16}triad {:.1f} GB/s in memory, {:.1f} in cache; FMA {:.1f} GFlop/s\n",
                   fmt::format("{} thread{}", threads, threads > 1 ? "s" : ""), roof.triad, roof.triad_cache,
                   roof.fma);
    }

    void compare_methods() {
        add(run_methods(BENCH_DIR, options_.all));
        fmt::print("\nslope of log(contact in a step) over log(grains)\n");
        for (const Slope& slope : slopes(report_.entries))
            fmt::print("{:38}{:9}{:6.3f}\n", slope.method, slope.moving ? "moving" : "at rest", slope.value);
    }

    void run_kernels() {
        set_threads(1);
        KernelSet set;
        for (const auto add_kernels : {add_force_kernels, add_contact_kernels, add_step_kernels}) {
            add_kernels(BENCH_DIR, set);
            add(set.run(options_.only, 0.03, 7));
        }
    }

    /// Over the same problem with one thread, if that has been run.
    std::vector<Entry> with_speed_up(std::vector<Entry> entries) const {
        for (Entry& e : entries)
            for (const Entry& one : report_.entries)
                if (e.threads > 1 && one.threads == 1 && one.name == e.name)
                    e.sizes.emplace_back("speed_up", one.median() / e.median());
        return entries;
    }

    void add(const std::vector<Entry>& entries) {
        for (const Entry& e : entries) {
            fmt::print("{}", table_row(e, report_.rooflines));
            report_.entries.push_back(e);
        }
        std::fflush(stdout);
    }

    Options options_;
    Report report_;
};

}  // namespace

}  // namespace quern::bench

int main(int argc, char** argv) {
    quern::bench::Options options;
    CLI::App app("Cost of a step: kernels, stages, whole problems");
    app.add_option("-o,--output", options.directory, "Folder of bench.json and bench.png")
        ->capture_default_str();
    app.add_option("--revision", options.revision, "Of the source, to be written into bench.json")
        ->capture_default_str();
    app.add_option("--only", options.only, "Kernels and problems with this in their names");
    app.add_flag("--methods", options.methods,
                 "Instead: contact by all methods against the number of grains");
    app.add_flag("--long", options.all, "Also 10^4 and 10^5 disks, 1000 spheres, and two threads");
    CLI11_PARSE(app, argc, argv);
    try {
        quern::bench::Bench(options).run();
        return 0;
    } catch (const quern::InputError& error) {
        fmt::print(stderr, "quern_bench: error: {}\n", error.what());
        return quern::InputError::exit_code;
    } catch (const quern::OutputError& error) {
        fmt::print(stderr, "quern_bench: error: {}\n", error.what());
        return quern::OutputError::exit_code;
    }
}
