#include "tests/benchmark/kernels.hpp"

#include <random>

#include "src/deck/read_deck.hpp"

namespace quern::bench {

namespace {

/// Hands the time of every repetition to a function.
class Collector : public benchmark::BenchmarkReporter {
  public:
    explicit Collector(std::function<void(double)> take) : take_(std::move(take)) {}
    bool ReportContext(const Context&) override { return true; }
    void ReportRuns(const std::vector<Run>& runs) override {
        for (const Run& run : runs)
            if (run.run_type == Run::RT_Iteration)
                take_(run.GetAdjustedRealTime() / benchmark::GetTimeUnitMultiplier(run.time_unit) * 1e9);
    }

  private:
    std::function<void(double)> take_;
};

}  // namespace

void KernelSet::add(const Entry& what, Body body, Timing timing) {
    kernels_.push_back({what, std::move(body), timing});
    kernels_.back().entry.kind = "kernel";
}

std::vector<Entry> KernelSet::run(const std::string& only, double min_time, int repetitions) {
    std::vector<Entry> entries;
    for (Kernel& kernel : kernels_) {
        if (kernel.entry.name.find(only) == std::string::npos) continue;
        benchmark::internal::Benchmark* const one =
            benchmark::RegisterBenchmark(kernel.entry.name.c_str(), kernel.body);
        one->Repetitions(repetitions);
        if (kernel.timing.calls > 0)
            one->Iterations(kernel.timing.calls);
        else
            one->MinTime(min_time);
        if (kernel.timing.manual)
            one->UseManualTime();
        else
            one->UseRealTime();
        Collector collector([&](double ns) { kernel.entry.ns.push_back(ns / kernel.entry.count); });
        benchmark::RunSpecifiedBenchmarks(&collector);
        benchmark::ClearRegisteredBenchmarks();
        entries.push_back(kernel.entry);
    }
    kernels_.clear();
    return entries;
}

template <int Dim>
std::shared_ptr<Stage<Dim>> make_stage(const std::string& deck_file,
                                       const std::vector<std::string>& overrides, int steps) {
    const Deck deck = read_deck(deck_file, overrides);
    auto stage = std::make_shared<Stage<Dim>>();
    stage->scene = make_scene<Dim>(deck);
    set_initial_velocities(deck, *stage->scene);
    stage->now = make_context(*stage->scene, 0.6 * stage->scene->stable_step());
    for (int k = 0; k < steps; ++k) {
        kick(*stage->scene, stage->now);
        drift(*stage->scene, stage->now);
    }
    return stage;
}

template <int Dim>
void stir(Stage<Dim>& stage) {
    Scene<Dim>& scene = *stage.scene;
    const double sound = scene.grains.front().shape->dx / stage.now.dt;
    std::mt19937_64 random(1);
    for (const Grain<Dim>& grain : scene.grains) {
        Vec<Dim> v;
        for (int a = 0; a < Dim; ++a)
            v[a] = 0.01 * sound * (0x1p-63 * static_cast<double>(random() >> 1) * 2.0 - 1.0);
        for (int p = grain.first; p < grain.first + grain.count; ++p) scene.particles.v[p] += v;
    }
}

template std::shared_ptr<Stage<2>> make_stage<2>(const std::string&, const std::vector<std::string>&, int);
template std::shared_ptr<Stage<3>> make_stage<3>(const std::string&, const std::vector<std::string>&, int);
template void stir<2>(Stage<2>&);
template void stir<3>(Stage<3>&);

}  // namespace quern::bench
