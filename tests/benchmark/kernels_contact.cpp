// Contact: slots, search, tiles, sweeps, on packings of touching grains.
#include <fmt/format.h>

#include <chrono>

#include "tests/benchmark/kernels.hpp"

namespace quern::bench {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// One call of the whole contact on a copy of the velocities, and its report.
template <int Dim>
class Contact {
  public:
    Contact(std::shared_ptr<Stage<Dim>> stage, const GridContactOptions& options)
        : stage_(std::move(stage)), contact_(stage_->scene->grid, options), v_(stage_->scene->particles.v) {}

    /// Seconds of the call; the copy is not timed.
    double call() {
        const Scene<Dim>& scene = *stage_->scene;
        std::copy(scene.particles.v.begin(), scene.particles.v.end(), v_.begin());
        const auto start = Clock::now();
        const StepContext<Dim>& now = stage_->now;
        report_ = &contact_.add_impulses(scene.contact_scene(),
                                         {now.dt, scene.arrays.v_before, v_, {}, now.largest_speed});
        return seconds_since(start);
    }
    const ContactReport<Dim>& report() const { return *report_; }

  private:
    std::shared_ptr<Stage<Dim>> stage_;
    GridContact<Dim> contact_;
    std::vector<Vec<Dim>> v_;
    const ContactReport<Dim>* report_ = nullptr;
};

template <int Dim>
Entry named(const std::string& what, const std::string& unit, double count) {
    Entry entry;
    entry.name = fmt::format("contact {}D {}", Dim, what);
    entry.unit = unit;
    entry.count = count;
    return entry;
}

template <int Dim>
void add_whole(const std::shared_ptr<Stage<Dim>>& stage, const std::string& what, double skin, bool seed,
               KernelSet& set) {
    GridContactOptions options;
    options.skin = skin;
    if (seed) options.rule = GridRule::seed;
    const auto contact = std::make_shared<Contact<Dim>>(stage, options);
    set.add(named<Dim>(what, "particle", stage->scene->particles.size()),
            [contact](benchmark::State& state) {
                for (auto _ : state) state.SetIterationTime(contact->call());
            },
            {.manual = true});
}

/// Forty sweeps more or less, all else being equal.
template <int Dim>
void add_sweeps(const std::shared_ptr<Stage<Dim>>& stage, KernelSet& set) {
    constexpr int more = 40;
    GridContactOptions options;
    options.tolerance = 1e-300;
    options.max_sweeps = 1;
    const auto few = std::make_shared<Contact<Dim>>(stage, options);
    options.max_sweeps += more;
    const auto many = std::make_shared<Contact<Dim>>(stage, options);
    few->call();
    many->call();
    set.add(named<Dim>("sweep", "row", static_cast<double>(many->report().n_contacts)),
            [few, many](benchmark::State& state) {
                for (auto _ : state)
                    state.SetIterationTime(std::max(1e-9, (many->call() - few->call()) / more));
            },
            {.manual = true});
}

template <int Dim>
void add_slots(const std::shared_ptr<Stage<Dim>>& stage, const std::string& what, double skin,
               KernelSet& set) {
    ContactNodeOptions options;
    options.skin = skin;
    const auto nodes = std::make_shared<ContactNodes<Dim>>(stage->scene->grid, options);
    const auto fill = [nodes, stage] {
        const ContactScene<Dim> scene = stage->scene->contact_scene();
        nodes->find(scene, 0.0);
        if (nodes->searched()) nodes->choose_all();
        nodes->fill(scene);
    };
    fill();
    set.add(named<Dim>(what, "slot", static_cast<double>(nodes->slots().size())),
            [fill](benchmark::State& state) {
                for (auto _ : state) fill();
            });
}

template <int Dim>
void add_tiles(const std::shared_ptr<Stage<Dim>>& stage, KernelSet& set) {
    const auto nodes = std::make_shared<ContactNodes<Dim>>(stage->scene->grid, ContactNodeOptions{});
    nodes->find(stage->scene->contact_scene(), 0.0);
    nodes->choose_all();
    nodes->fill(stage->scene->contact_scene());
    std::vector<std::pair<int, int>> pairs;
    for (int node = 0; node < nodes->n_nodes(); ++node) {
        const std::span<const int> slots = nodes->slots_of(node);
        for (std::size_t k = 0; k < slots.size(); ++k)
            for (std::size_t l = k + 1; l < slots.size(); ++l) pairs.emplace_back(slots[k], slots[l]);
    }
    set.add(named<Dim>("tile", "pair", static_cast<double>(pairs.size())), [nodes, stage,
                                                                            pairs](benchmark::State& state) {
        const GridContactOptions options;
        const Mat<Dim> upright = Mat<Dim>::Identity();
        const auto side = [&](int s) {
            const Slot<Dim>& slot = nodes->slots()[s];
            return TileSide<Dim>{&slot, &stage->scene->grains[slot.grain], &upright};
        };
        for (auto _ : state)
            for (const auto& [a, b] : pairs)
                benchmark::DoNotOptimize(make_tile<Dim>(side(a), side(b), nodes->grid().h(), options));
    });
}

template <int Dim>
void add_all(const std::string& deck, const std::vector<std::string>& packing, KernelSet& set) {
    const auto stage = make_stage<Dim>(deck, packing, 20);
    add_whole<Dim>(stage, "pair rule, nodes kept", GridContactOptions{}.skin, false, set);
    add_whole<Dim>(stage, "pair rule, search", 0.0, false, set);
    add_whole<Dim>(stage, "seed rule", 0.0, true, set);
    add_slots<Dim>(stage, "slots filled", GridContactOptions{}.skin, set);
    add_slots<Dim>(stage, "slots searched and filled", 0.0, set);
    add_tiles<Dim>(stage, set);
    add_sweeps<Dim>(stage, set);
}

}  // namespace

void add_contact_kernels(const std::string& folder, KernelSet& set) {
    add_all<2>(folder + "/packing.yaml", {"params.columns=22", "params.rows=22"}, set);
    add_all<3>(folder + "/spheres.yaml", {}, set);
}

}  // namespace quern::bench
