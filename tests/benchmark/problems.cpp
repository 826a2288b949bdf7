#include "tests/benchmark/problems.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>

#include "src/deck/read_deck.hpp"
#include "tests/benchmark/kernels.hpp"
#include "tests/benchmark/machine.hpp"

namespace quern::bench {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int blocks = 7, least_steps = 3;
constexpr double particle_steps = 2e6;  ///< of a block

template <int Dim>
std::vector<Entry> measure(const Problem& problem, int threads) {
    const MemoryPeak memory;
    const auto stage = make_stage<Dim>(problem.deck, problem.overrides, problem.stirred ? 0 : 20);
    if (problem.stirred) stir(*stage);
    Scene<Dim>& scene = *stage->scene;
    StepContext<Dim>& now = stage->now;
    const double n = scene.particles.size();
    const bool bonded = !scene.groups.empty();

    Entry step, force, kick_stage, contact, points, drift_stage;
    step.kind = "problem";
    step.name = problem.name;
    force.kind = kick_stage.kind = contact.kind = drift_stage.kind = "stage";
    force.name = problem.name + ": force";
    kick_stage.name = problem.name + ": kick";
    contact.name = problem.name + ": contact";
    drift_stage.name = problem.name + ": drift";
    points.kind = "stage";
    points.name = problem.name + ": points";
    if (bonded) count_bonds(scene, std::holds_alternative<Lps<Dim>>(scene.groups.front().model), force);
    kick_stage.bytes = 32.0 * Dim + 8.0;  // x, v, internal in, v out; mass
    contact.bytes = 32.0 * Dim + 8.0;     // x, x of the search, v in, v out; mass
    drift_stage.bytes = 24.0 * Dim;       // x, v in, x out
    drift_stage.flops = 2.0 * Dim;
    for (Entry* e : {&step, &kick_stage, &contact, &points, &drift_stage}) {
        e->unit = "particle";
        e->count = n;
    }
    if (!bonded) {
        force.unit = "particle";
        force.count = n;
    }

    double all_seconds = 0.0;
    const std::clock_t cpu_start = std::clock();
    const int steps = std::max(least_steps, static_cast<int>(particle_steps / n));
    for (int block = 0; block < blocks; ++block) {
        now.stages = {};
        now.contact_nodes = now.contacts = now.sweeps = now.searches = 0;
        const auto start = Clock::now();
        for (int k = 0; k < steps; ++k) {
            kick(scene, now);
            drift(scene, now);
        }
        const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        all_seconds += seconds;
        const double scale = 1e9 / (n * steps);
        step.ns.push_back(scale * seconds);
        force.ns.push_back(scale * n / force.count * now.stages.internal_forces);
        kick_stage.ns.push_back(scale * (now.stages.kick + now.stages.loads));
        contact.ns.push_back(scale * now.stages.contact);
        points.ns.push_back(scale * now.stages.points);
        drift_stage.ns.push_back(scale * now.stages.drift);
    }
    const double cpu_seconds = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
    const double per_step = 1.0 / steps;
    step.memory = memory.bytes() / n;
    step.sizes = {{"grains", static_cast<double>(scene.grains.size())},
                  {"particles", n},
                  {"bonds", static_cast<double>(scene.n_bonds)},
                  {"contact_nodes", per_step * static_cast<double>(now.contact_nodes)},
                  {"rows", per_step * static_cast<double>(now.contacts)},
                  {"sweeps", per_step * static_cast<double>(now.sweeps)},
                  {"searches", per_step * static_cast<double>(now.searches)},
                  {"cpu_share", cpu_seconds / (threads * all_seconds)}};
    std::vector<Entry> entries{step, force, kick_stage};
    if (scene.contact) {
        step.bytes += contact.bytes;
        entries.push_back(contact);
    }
    if (scene.points) entries.push_back(points);
    entries.push_back(drift_stage);
    entries.front().bytes = force.bytes * force.count / n + step.bytes + kick_stage.bytes + drift_stage.bytes;
    entries.front().flops = force.flops * force.count / n;
    for (Entry& e : entries) e.threads = threads;
    return entries;
}

std::vector<std::string> disks(int columns, int rows) {
    return {fmt::format("params.columns={}", columns), fmt::format("params.rows={}", rows)};
}

}  // namespace

std::vector<Problem> make_problems(const std::string& folder, bool all) {
    const std::string packing = folder + "/packing.yaml", spheres = folder + "/spheres.yaml",
                      compression = folder + "/compression_502";
    const auto variant = [](std::vector<std::string> list, const std::string& more) {
        list.push_back(more);
        return list;
    };
    std::vector<Problem> list;
    for (const int side : {5, 10, 22, 32})
        list.push_back({fmt::format("disks {}", side * side), packing, disks(side, side)});
    list.push_back({"disks 484, seed rule", packing, variant(disks(22, 22), "params.rule=seed")});
    list.push_back({"disks 484, no contact", packing, variant(disks(22, 22), "contact.rule=none")});
    list.push_back({"disks 484, bond-based", packing, variant(disks(22, 22), "params.model=bond_based")});
    const std::vector<std::string> points{"params.columns=20", "params.rows=20", "params.rings=8",
                                          "params.model=material_points"};
    list.push_back({"points 400", packing, points});
    list.push_back({"points 400, stirred", packing, points, true});
    list.push_back({"compression 502, start", compression + "/compression.yaml", {}});
    list.push_back({"compression 502, packed", compression + "/packed.yaml", {}});
    list.push_back({"spheres 12", spheres, {}});
    list.push_back({"spheres 12, bond-based", spheres, {"params.model=bond_based"}});
    if (!all) return list;
    list.push_back({"spheres 1000", spheres, {"params.columns=10", "params.rows=10", "params.layers=10"}});
    list.push_back({"disks 10000", packing, disks(100, 100)});
    list.push_back({"disks 99856", packing, disks(316, 316)});
    return list;
}

std::vector<Entry> run_problem(const Problem& problem, int threads) {
    set_threads(threads);
    const Deck deck = read_deck(problem.deck, problem.overrides);
    return deck.dimension == 2 ? measure<2>(problem, threads) : measure<3>(problem, threads);
}

}  // namespace quern::bench
