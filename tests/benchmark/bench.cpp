// What a step costs: ns per bond and per particle and step, stage by stage, on packings of touching grains.
//
// One thread on one core. Times are medians over blocks of steps; on a shared machine read the ratios of one
// run, not the absolute values. The memory bandwidth beside them (triad a = b + s c) says what the machine
// gave.
#include <fmt/format.h>
#include <sched.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>

#include "grid/parallel.hpp"
#include "src/deck/read_deck.hpp"
#include "src/results/output_file.hpp"
#include "src/sim/step.hpp"

namespace quern {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

double median(std::vector<double> values) {
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    return values[values.size() / 2];
}

void stay_on_this_core() {
    cpu_set_t set;
    CPU_ZERO(&set);
    CPU_SET(static_cast<unsigned>(sched_getcpu()), &set);
    sched_setaffinity(0, sizeof set, &set);
}

/// Memory bandwidth of a = b + s c on arrays of 32 MB [GB/s].
double triad_bandwidth() {
    const std::size_t n = std::size_t{4} << 20;
    std::vector<double> a(n), b(n, 1.0), c(n, 2.0);
    std::vector<double> times;
    for (int k = 0; k < 7; ++k) {
        const auto start = Clock::now();
        for (std::size_t i = 0; i < n; ++i) a[i] = b[i] + 3.0 * c[i];
        times.push_back(seconds_since(start));
        std::swap(a, b);
    }
    return 24.0 * static_cast<double>(n) / median(times) * 1e-9;
}

struct Case {
    std::string name, deck;
    std::vector<std::string> overrides;
};

struct Result {
    std::string name;
    double n_grains = 0, n_particles = 0, n_bonds = 0;
    double force_per_bond = 0;                                     ///< [ns]
    double force = 0, kick = 0, contact = 0, drift = 0, step = 0;  ///< ns per particle and step
    double contact_nodes = 0;                                      ///< a step
};

template <int Dim>
Result measure(const Case& test, const Deck& deck) {
    const auto scene = make_scene<Dim>(deck);
    set_initial_velocities(deck, *scene);
    StepContext<Dim> now;
    now.dt = 0.6 * scene->stable_step();
    now.grain_impulse.assign(scene->grains.size(), Vec<Dim>::Zero());
    now.wall_impulse.assign(scene->walls.size(), Vec<Dim>::Zero());
    const double n = scene->particles.size();
    const auto advance = [&](int steps) {
        for (int k = 0; k < steps; ++k) {
            kick(*scene, now);
            drift(*scene, now);
        }
    };
    advance(20);
    const int steps = std::max(3, static_cast<int>(2e6 / n));
    std::vector<double> force, kick_time, contact, drift_time, step;
    for (int block = 0; block < 7; ++block) {
        now.stages = {};
        now.contact_nodes = 0;
        const auto start = Clock::now();
        advance(steps);
        const double scale = 1e9 / (n * steps);
        step.push_back(scale * seconds_since(start));
        force.push_back(scale * now.stages.internal_forces);
        kick_time.push_back(scale * (now.stages.kick + now.stages.loads));
        contact.push_back(scale * now.stages.contact);
        drift_time.push_back(scale * now.stages.drift);
    }
    Result result;
    result.name = test.name;
    result.n_grains = static_cast<double>(scene->grains.size());
    result.n_particles = n;
    result.n_bonds = static_cast<double>(scene->n_bonds);
    result.force = median(force);
    result.force_per_bond = result.force * n / result.n_bonds;
    result.kick = median(kick_time);
    result.contact = median(contact);
    result.drift = median(drift_time);
    result.step = median(step);
    result.contact_nodes = static_cast<double>(now.contact_nodes) / steps;
    return result;
}

std::vector<Case> cases(const std::string& folder, bool long_mode) {
    const std::string disks = folder + "/packing.yaml", spheres = folder + "/spheres.yaml";
    const auto square = [](int n) {
        return std::vector<std::string>{fmt::format("params.columns={}", n),
                                        fmt::format("params.rows={}", n)};
    };
    const auto with = [](std::vector<std::string> list, const std::string& more) {
        list.push_back(more);
        return list;
    };
    std::vector<Case> list{
        {"disks, LPS, pair rule", disks, square(5)},
        {"disks, LPS, pair rule", disks, square(10)},
        {"disks, LPS, pair rule", disks, square(22)},
        {"disks, LPS, seed rule", disks, with(square(22), "params.rule=seed")},
        {"disks, LPS, no contact", disks, with(square(22), "contact.rule=none")},
        {"disks, bond-based, pair rule", disks, with(square(22), "params.model=bond_based")},
        {"spheres, LPS, pair rule", spheres, {}},
        {"spheres, bond-based, pair rule", spheres, {"params.model=bond_based"}}};
    if (long_mode) {
        list.push_back({"disks, LPS, pair rule", disks, square(100)});
        list.push_back({"disks, LPS, pair rule", disks, square(316)});
    }
    return list;
}

std::string json(const std::vector<Result>& results, double bandwidth) {
    std::string text = fmt::format("{{\n  \"triad_gb_per_s\": {:.3f},\n  \"cases\": [\n", bandwidth);
    for (std::size_t i = 0; i < results.size(); ++i) {
        const Result& r = results[i];
        text += fmt::format(
            "    {{\"name\": \"{}\", \"n_grains\": {:.0f}, \"n_particles\": {:.0f}, \"n_bonds\": {:.0f}, "
            "\"force_ns_per_bond\": {:.3f}, \"ns_per_particle_step\": {{\"force\": {:.3f}, \"kick\": {:.3f}, "
            "\"contact\": {:.3f}, \"drift\": {:.3f}, \"step\": {:.3f}}}, \"contact_nodes\": {:.1f}}}{}\n",
            r.name, r.n_grains, r.n_particles, r.n_bonds, r.force_per_bond, r.force, r.kick, r.contact,
            r.drift, r.step, r.contact_nodes, i + 1 < results.size() ? "," : "");
    }
    return text + "  ]\n}\n";
}

int bench(const std::string& directory, bool long_mode) {
    parallel::set_threads(1);
    stay_on_this_core();
    const double bandwidth = triad_bandwidth();
    fmt::print("memory bandwidth (triad, one core): {:.1f} GB/s\n\n", bandwidth);
    fmt::print("{:31}{:>8}{:>10}{:>9} | ns per particle and step\n", "", "", "", "ns per");
    fmt::print("{:31}{:>8}{:>10}{:>9} |{:>8}{:>8}{:>9}{:>8}{:>8}\n", "case", "grains", "particles", "bond",
               "force", "kick", "contact", "drift", "step");
    std::vector<Result> results;
    for (const Case& test : cases(BENCH_DIR, long_mode)) {
        const Deck deck = read_deck(test.deck, test.overrides);
        const Result r = deck.dimension == 2 ? measure<2>(test, deck) : measure<3>(test, deck);
        fmt::print("{:31}{:8.0f}{:10.0f}{:9.2f} |{:8.1f}{:8.1f}{:9.1f}{:8.1f}{:8.1f}\n", r.name, r.n_grains,
                   r.n_particles, r.force_per_bond, r.force, r.kick, r.contact, r.drift, r.step);
        std::fflush(stdout);
        results.push_back(r);
    }
    create_directory(directory);
    write_whole_file(directory + "/bench.json", json(results, bandwidth));
    fmt::print("\nwritten to {}/bench.json\n", directory);
    return 0;
}

}  // namespace

}  // namespace quern

int main(int argc, char** argv) {
    std::string directory = "out/bench";
    bool long_mode = false;
    CLI::App app("Cost of a step, stage by stage, one thread");
    app.add_option("-o,--output", directory, "Folder of bench.json")->capture_default_str();
    app.add_flag("--long", long_mode, "Also 10^4 and 10^5 grains");
    CLI11_PARSE(app, argc, argv);
    try {
        return quern::bench(directory, long_mode);
    } catch (const std::exception& error) {
        fmt::print(stderr, "quern_bench: error: {}\n", error.what());
        return 1;
    }
}
