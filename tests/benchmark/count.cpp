// A small fixed set of work for callgrind, which counts what runs inside of quern_counted and dumps at its
// end.
//
// instructions.py starts this program and divides each dump by the units that the program prints in the same
// order, a line "kind|name|unit|units" each.
#include <fmt/format.h>

#include "grid/error.hpp"
#include "grid/parallel.hpp"
#include "src/sim/internal_forces.hpp"
#include "src/sim/observe.hpp"
#include "tests/benchmark/kernels.hpp"

using Work = std::function<void()>;

// Found by this name, hence neither mangled nor inlined.
extern "C" __attribute__((noinline)) void quern_counted(const Work& work) {
    work();
}

namespace quern::bench {

namespace {

/// Once for the caches and buffers of the program, once to be counted.
void count(const std::string& kind, const std::string& name, const std::string& unit, double units,
           const Work& work) {
    work();
    quern_counted(work);
    fmt::print("{}|{}|{}|{:.0f}\n", kind, name, unit, units);
}

template <int Dim>
void count_forces(const std::string& name, const std::string& deck, std::vector<std::string> overrides) {
    overrides.push_back("contact.rule=none");
    const auto stage = make_stage<Dim>(deck, overrides, 0);
    count("kernel", name, "bond", static_cast<double>(stage->scene->n_bonds),
          [&] { compute_internal_forces(*stage->scene, stage->now); });
}

template <int Dim>
void count_contact(const std::string& kind, const std::string& name, Stage<Dim>& stage,
                   const GridContactOptions& options) {
    Scene<Dim>& scene = *stage.scene;
    GridContact<Dim> contact(scene.grid, options);
    std::vector<Vec<Dim>> v = scene.particles.v;
    const ContactScene<Dim> view = scene.contact_scene();
    count(kind, name, "particle", scene.particles.size(), [&] {
        std::copy(scene.particles.v.begin(), scene.particles.v.end(), v.begin());
        contact.add_impulses(view, {stage.now.dt, scene.arrays.v_before, v, {}, stage.now.largest_speed});
    });
}

/// Whole steps, then single stages; what is missing to the step is the kick.
template <int Dim>
void count_problem(const std::string& name, Stage<Dim>& stage) {
    constexpr int steps = 10;
    const double n = stage.scene->particles.size();
    count("problem", name, "particle", steps * n, [&] {
        for (int k = 0; k < steps; ++k) {
            kick(*stage.scene, stage.now);
            drift(*stage.scene, stage.now);
        }
    });
    count("stage", name + ": force", "particle", n,
          [&] { compute_internal_forces(*stage.scene, stage.now); });
    if (stage.scene->contact) count_contact("stage", name + ": contact", stage, {});
    count("stage", name + ": drift", "particle", n, [&] { drift(*stage.scene, stage.now); });
}

void count_all() {
    const std::string disks = BENCH_DIR "/packing.yaml", spheres = BENCH_DIR "/spheres.yaml",
                      compression = BENCH_DIR "/compression_502";
    const std::vector<std::string> square{"params.columns=8", "params.rows=8"};
    const auto with = [&](const std::string& more) {
        std::vector<std::string> overrides = square;
        overrides.push_back(more);
        return overrides;
    };
    count_forces<2>("force 2D LPS batch", disks, square);
    count_forces<2>("force 2D LPS single", disks, with("compute.kernel=single"));
    count_forces<2>("force 2D LPS breakable", disks, with("materials.grain.critical_stretch=0.05"));
    count_forces<2>("force 2D bond-based batch", disks, with("params.model=bond_based"));
    count_forces<3>("force 3D LPS batch", spheres, {"params.layers=2"});

    const auto plane = make_stage<2>(disks, square, 5);
    GridContactOptions options;
    count_contact<2>("kernel", "contact 2D pair rule, nodes kept", *plane, options);
    options.skin = 0.0;
    count_contact<2>("kernel", "contact 2D pair rule, search", *plane, options);
    options.rule = GridRule::seed;
    count_contact<2>("kernel", "contact 2D seed rule", *plane, options);
    const auto space = make_stage<3>(spheres, {"params.shells=5"}, 5);
    count_contact<3>("kernel", "contact 3D pair rule, nodes kept", *space, {});

    const double n = plane->scene->particles.size();
    count("kernel", "state hash 2D", "particle", n, [&] { state_hash(*plane->scene); });
    Frame frame;
    count("kernel", "frame 2D", "particle", n, [&] { make_frame(*plane->scene, plane->now, frame); });
    count_problem<2>("disks 64, no contact", *make_stage<2>(disks, with("contact.rule=none"), 5));
    count_problem<2>("disks 64", *plane);
    count_problem<3>("spheres 12", *space);
    count_problem<2>("compression 502, start", *make_stage<2>(compression + "/compression.yaml", {}, 0));
    count_problem<2>("compression 502, packed", *make_stage<2>(compression + "/packed.yaml", {}, 0));
}

}  // namespace

}  // namespace quern::bench

int main() {
    quern::parallel::set_threads(1);
    try {
        quern::bench::count_all();
        return 0;
    } catch (const quern::InputError& error) {
        fmt::print(stderr, "quern_count: error: {}\n", error.what());
        return quern::InputError::exit_code;
    }
}
