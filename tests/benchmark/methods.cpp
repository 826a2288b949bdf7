#include "tests/benchmark/methods.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <nanoflann.hpp>

#include "tests/benchmark/kernels.hpp"
#include "tests/benchmark/machine.hpp"

namespace quern::bench {

namespace {

using Clock = std::chrono::steady_clock;

constexpr int blocks = 7, least_steps = 3, warm_up = 10;
constexpr double particle_steps = 1e6;  ///< of a block

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

struct Method {
    std::string name;
    std::vector<std::string> overrides;
};

std::vector<Method> methods() {
    return {{"grid, pair rule", {"contact.rule=pair"}},
            {"grid, surface rule", {"contact.rule=surface"}},
            {"grid, seed rule", {"contact.rule=seed"}},
            {"node pairs", {"contact.method=node_pair"}}};
}

/// Points as nanoflann wants to see them.
struct Cloud {
    const std::vector<Vec<2>>& x;
    std::size_t kdtree_get_point_count() const { return x.size(); }
    double kdtree_get_pt(std::size_t i, std::size_t axis) const { return x[i][static_cast<int>(axis)]; }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};

/// All pairs nearer than `radius`: the tree is built, and asked once a particle.
class TreeSearch {
  public:
    explicit TreeSearch(double radius) : radius_squared_(radius * radius) {}

    /// Number of neighbours found.
    std::size_t operator()(const std::vector<Vec<2>>& x) {
        using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud,
                                                         2, std::uint32_t>;
        const Cloud cloud{x};
        Tree tree(2, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
        tree.buildIndex();
        nanoflann::SearchParams params;
        params.sorted = false;
        std::size_t n = 0;
        for (const Vec<2>& point : x) n += tree.radiusSearch(point.data(), radius_squared_, found_, params);
        return n;
    }

  private:
    double radius_squared_;
    std::vector<std::pair<std::uint32_t, double>> found_;
};

/// One method on one packing.
class Runner {
  public:
    Runner(const Method& method, const std::string& deck, int side, bool moving) {
        std::vector<std::string> overrides = method.overrides;
        overrides.push_back(fmt::format("params.columns={}", side));
        overrides.push_back(fmt::format("params.rows={}", side));
        stage_ = make_stage<2>(deck, overrides, 0);
        if (moving) stir(*stage_);
        step(warm_up);
        entry_.kind = "method";
        entry_.name = method.name;
        entry_.unit = "particle";
        entry_.count = stage_->scene->particles.size();
        steps_ = std::max(least_steps, static_cast<int>(particle_steps / entry_.count));
        entry_.sizes = {{"grains", static_cast<double>(stage_->scene->grains.size())},
                        {"moving", moving ? 1.0 : 0.0},
                        {"time_step", stage_->now.dt}};
    }

    void measure_block() {
        stage_->now.stages = {};
        const auto start = Clock::now();
        step(steps_);
        const double scale = 1e9 / (entry_.count * steps_);
        whole_.push_back(scale * seconds_since(start));
        entry_.ns.push_back(scale * stage_->now.stages.contact);
    }

    Entry finished() {
        Entry whole;
        whole.ns = whole_;
        entry_.sizes.emplace_back("step_ns", whole.median());
        return entry_;
    }
    const Scene<2>& scene() const { return *stage_->scene; }

  private:
    void step(int n) {
        for (int k = 0; k < n; ++k) {
            kick(*stage_->scene, stage_->now);
            drift(*stage_->scene, stage_->now);
        }
    }

    std::shared_ptr<Stage<2>> stage_;
    Entry entry_;
    std::vector<double> whole_;
    int steps_ = 0;
};

Entry measure_tree(const Scene<2>& scene, bool moving) {
    Entry entry;
    entry.kind = "method";
    entry.name = "k-d tree every step, search only";
    entry.unit = "particle";
    entry.count = scene.particles.size();
    entry.sizes = {{"grains", static_cast<double>(scene.grains.size())}, {"moving", moving ? 1.0 : 0.0}};
    TreeSearch search(scene.grains.front().shape->dx);
    for (int block = 0; block < least_steps; ++block) {
        const auto start = Clock::now();
        benchmark::DoNotOptimize(search(scene.particles.x));
        entry.ns.push_back(1e9 / entry.count * seconds_since(start));
    }
    return entry;
}

}  // namespace

std::vector<Entry> run_methods(const std::string& folder, bool all) {
    set_threads(1);
    std::vector<int> sides{10, 32, 100};
    if (all) sides.push_back(316);
    std::vector<Entry> entries;
    for (const bool moving : {false, true})
        for (const int side : sides) {
            std::vector<Runner> runners;
            for (const Method& method : methods())
                runners.emplace_back(method, folder + "/packing.yaml", side, moving);
            for (int block = 0; block < blocks; ++block)
                for (Runner& runner : runners) runner.measure_block();
            entries.push_back(measure_tree(runners.front().scene(), moving));
            for (Runner& runner : runners) entries.push_back(runner.finished());
        }
    return entries;
}

std::vector<Slope> slopes(const std::vector<Entry>& entries) {
    std::vector<Slope> list;
    for (const Entry& e : entries) {
        const bool moving = e.size("moving") > 0.0;
        if (std::any_of(list.begin(), list.end(),
                        [&](const Slope& s) { return s.method == e.name && s.moving == moving; }))
            continue;
        double n = 0, x = 0, y = 0, xx = 0, xy = 0;
        for (const Entry& other : entries) {
            if (other.name != e.name || (other.size("moving") > 0.0) != moving) continue;
            const double a = std::log(other.size("grains")), b = std::log(other.median() * other.count);
            n += 1;
            x += a;
            y += b;
            xx += a * a;
            xy += a * b;
        }
        if (n > 1) list.push_back({e.name, moving, (n * xy - x * y) / (n * xx - x * x)});
    }
    return list;
}

}  // namespace quern::bench
