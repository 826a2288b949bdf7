// Forces inside the grains: every model, instruction set and way of evaluation.
#include <fmt/format.h>

#include "src/sim/internal_forces.hpp"
#include "tests/benchmark/kernels.hpp"

namespace quern::bench {

template <int Dim>
void count_bonds(const Scene<Dim>& scene, bool dilating, Entry& entry) {
    // Topology: length, three constants and the partner of a bond; first bond and stiffness of a node.
    double bytes = 16.0 * Dim * scene.particles.size();
    for (const auto& shape : scene.shapes) bytes += 12.0 * shape->n_nodes();
    for (const MaterialGroup<Dim>& group : scene.groups)
        bytes += 36.0 * std::visit([](const auto& model) { return model.n_bonds(); }, group.model);
    bytes += 2.0 * static_cast<double>(scene.alive.size());
    entry.unit = "bond";
    entry.count = static_cast<double>(scene.n_bonds);
    entry.bytes = bytes / entry.count;
    // y and |y|^2: Dim + 2 Dim - 1; 1/|y|: 2. First pass: k xi (|y| - xi) to both ends, 5. Second: the sum of
    // P and k xi, 2; c - c xi/|y|, 3 (2 without P); the force to both ends, 3 Dim.
    const double bond = 3.0 * Dim - 1.0 + 2.0;
    entry.flops = dilating ? 2.0 * bond + 5.0 + 5.0 + 3.0 * Dim : bond + 2.0 + 3.0 * Dim;
}

namespace {

template <int Dim>
void add_forces(const std::string& name, const std::string& deck, std::vector<std::string> overrides,
                const std::string& model, KernelSet& set) {
    overrides.push_back("contact.rule=none");
    overrides.push_back("params.model=" + model);
    const auto stage = make_stage<Dim>(deck, overrides, 0);
    Entry entry;
    entry.name = name;
    count_bonds(*stage->scene, model == "lps", entry);
    set.add(entry, [stage](benchmark::State& state) {
        for (auto _ : state) compute_internal_forces(*stage->scene, stage->now);
    });
}

template <int Dim>
void add_all(const std::string& deck, const std::vector<std::string>& packing, KernelSet& set) {
    const auto with = [&](const std::string& more) {
        std::vector<std::string> overrides = packing;
        overrides.push_back(more);
        return overrides;
    };
    for (const std::string model : {"lps", "bond_based"}) {
        const std::string name = fmt::format("force {}D {}", Dim, model == "lps" ? "LPS" : "bond-based");
        for (const auto& [text, instructions] : {std::pair{"avx512", Instructions::avx512},
                                                 {"avx2", Instructions::avx2},
                                                 {"plain", Instructions::plain}})
            if (has_instructions(instructions))
                add_forces<Dim>(fmt::format("{} batch {}", name, text), deck,
                                with(fmt::format("compute.instructions={}", text)), model, set);
        add_forces<Dim>(name + " single", deck, with("compute.kernel=single"), model, set);
        add_forces<Dim>(name + " breakable", deck, with("materials.grain.critical_stretch=0.05"), model, set);
    }
    add_forces<Dim>(fmt::format("force {}D LPS and damping", Dim), deck,
                    with("materials.grain.bond_damping=1e-7"), "lps", set);
}

}  // namespace

void add_force_kernels(const std::string& folder, KernelSet& set) {
    add_all<2>(folder + "/packing.yaml", {"params.columns=8", "params.rows=8"}, set);
    add_all<3>(folder + "/spheres.yaml", {"params.layers=2"}, set);
}

template void count_bonds<2>(const Scene<2>&, bool, Entry&);
template void count_bonds<3>(const Scene<3>&, bool, Entry&);

}  // namespace quern::bench
