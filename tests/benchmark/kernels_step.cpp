// The rest of a step, and what output takes.
#include <fmt/format.h>

#include "src/sim/observe.hpp"
#include "tests/benchmark/kernels.hpp"

namespace quern::bench {

namespace {

template <int Dim>
Entry named(const std::string& what, const Scene<Dim>& scene, double bytes) {
    Entry entry;
    entry.name = fmt::format("{} {}D", what, Dim);
    entry.unit = "particle";
    entry.count = scene.particles.size();
    entry.bytes = bytes;
    return entry;
}

template <int Dim>
void add_all(const std::string& deck, std::vector<std::string> packing, KernelSet& set) {
    packing.push_back("contact.rule=none");
    packing.push_back("params.model=lps");
    const auto stage = make_stage<Dim>(deck, packing, 1);
    Scene<Dim>& scene = *stage->scene;
    std::fill(scene.particles.v.begin(), scene.particles.v.end(), Vec<Dim>::Zero());
    // Vectors read and written, 8 Dim bytes each: x, v, internal in, v out, and the mass.
    set.add(named("kick", scene, 32.0 * Dim + 8.0),
            [stage](benchmark::State& state) {
                for (auto _ : state) {
                    const double before = stage->now.stages.kick;
                    kick(*stage->scene, stage->now);
                    state.SetIterationTime(stage->now.stages.kick - before);
                }
            },
            {.manual = true});
    Entry moved = named("drift", scene, 24.0 * Dim);
    moved.flops = 2.0 * Dim;
    set.add(moved, [stage](benchmark::State& state) {
        std::fill(stage->scene->particles.v.begin(), stage->scene->particles.v.end(), Vec<Dim>::Zero());
        for (auto _ : state) drift(*stage->scene, stage->now);
    });
    set.add(named("state hash", scene, 16.0 * Dim), [stage](benchmark::State& state) {
        for (auto _ : state) benchmark::DoNotOptimize(state_hash(*stage->scene));
    });
    // Both velocities, x in; x, v, damage, stress, grain and volume out.
    const double frame = 24.0 * Dim + 12.0 * Dim + 4.0 * (1 + (Dim == 2 ? 4 : 6)) + 4.0 + 16.0;
    set.add(named("frame", scene, frame), [stage](benchmark::State& state) {
        Frame frame;
        for (auto _ : state) {
            make_frame(*stage->scene, stage->now, frame);
            benchmark::DoNotOptimize(frame.stress.data());
        }
    });
    set.add(named("energy budget", scene, 24.0 * Dim + 8.0), [stage](benchmark::State& state) {
        Observer<Dim> observer;
        observer.start(*stage->scene, stage->now);
        for (auto _ : state) benchmark::DoNotOptimize(observer.history(*stage->scene, stage->now));
    });
}

}  // namespace

void add_step_kernels(const std::string& folder, KernelSet& set) {
    add_all<2>(folder + "/packing.yaml", {"params.columns=22", "params.rows=22"}, set);
    add_all<3>(folder + "/spheres.yaml", {}, set);
}

}  // namespace quern::bench
