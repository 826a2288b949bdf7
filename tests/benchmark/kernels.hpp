// Single kernels, timed by Google Benchmark.
#pragma once

#include <benchmark/benchmark.h>

#include <functional>
#include <string>
#include <vector>

#include "src/sim/step.hpp"
#include "tests/benchmark/entry.hpp"

namespace quern::bench {

/// A list of kernels to be run one after the other.
class KernelSet {
  public:
    using Body = std::function<void(benchmark::State&)>;
    /// Whether the body sets the time of each call itself, and how many calls are a repetition; 0: enough.
    struct Timing {
        bool manual = false;
        int calls = 0;
    };
    /// `what`: everything but the times; the body is one call.
    void add(const Entry& what, Body body, Timing timing);
    void add(const Entry& what, Body body) { add(what, std::move(body), {}); }
    /// Kernels with `only` in their names: `repetitions` of at least `min_time` [s] each. Empties the set.
    std::vector<Entry> run(const std::string& only, double min_time, int repetitions);

  private:
    struct Kernel {
        Entry entry;
        Body body;
        Timing timing;
    };
    std::vector<Kernel> kernels_;
};

/// The state in which the kernels of the step find a scene.
template <int Dim>
struct Stage {
    std::unique_ptr<Scene<Dim>> scene;
    StepContext<Dim> now;
};

/// Builds the scene of a deck and takes `steps` steps.
template <int Dim>
std::shared_ptr<Stage<Dim>> make_stage(const std::string& deck, const std::vector<std::string>& overrides,
                                       int steps);

/// Throws grains in all directions, at a hundredth of the speed of sound at most: neighbours part and meet.
template <int Dim>
void stir(Stage<Dim>& stage);

/// Bonds of one evaluation: bytes and flops of one bond (README.md says what is counted).
template <int Dim>
void count_bonds(const Scene<Dim>& scene, bool dilating, Entry& entry);

/// `folder`: where the decks are.
void add_force_kernels(const std::string& folder, KernelSet& set);
void add_contact_kernels(const std::string& folder, KernelSet& set);
void add_step_kernels(const std::string& folder, KernelSet& set);

}  // namespace quern::bench
