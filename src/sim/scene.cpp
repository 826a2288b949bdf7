#include "src/sim/scene.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quern {

namespace {

/// Works of the bonds of a grain.
template <int Dim, class Works>
auto works_in(const Scene<Dim>& scene, Works& works, int g) {
    using Span = std::span<std::remove_reference_t<decltype(works[0])>>;
    if (works.empty() || !scene.group_of(g).breaks_by_work) return Span();
    const int n_bonds =
        std::visit([](const auto& model) { return model.n_bonds(); }, scene.group_of(g).model);
    return Span(works.data() + scene.bond_bytes[static_cast<std::size_t>(g)].first_work,
                static_cast<std::size_t>(n_bonds));
}

}  // namespace

template <int Dim>
GrainView<Dim> Scene<Dim>::view(int grain) const {
    const std::size_t first = static_cast<std::size_t>(grains[grain].first);
    const std::size_t count = static_cast<std::size_t>(grains[grain].count);
    const BondBytes& bytes = bond_bytes[static_cast<std::size_t>(grain)];
    const auto bits = [&](const std::vector<std::uint8_t>& all) {
        if (all.empty()) return BondBits();
        return BondBits({all.data() + bytes.begin, bytes.count}, bytes.bit, bytes.place);
    };
    return {
        grains[grain].scale,
        {particles.x.data() + first, count},
        {particles.v.data() + first, count},
        bits(alive),
        bits(whole),
        bits(kept),
        grains[grain].strength,
        works_in(*this, works, grain),
        plastic.empty() ? std::span<const PlasticStrain<Dim>>() : std::span(plastic).subspan(first, count)};
}

template <int Dim>
std::span<BondWork> Scene<Dim>::works_of(int grain) {
    return works_in(*this, works, grain);
}

template <int Dim>
std::span<PlasticStrain<Dim>> Scene<Dim>::plastic_of(int grain) {
    return std::span(plastic).subspan(static_cast<std::size_t>(grains[grain].first),
                                      static_cast<std::size_t>(grains[grain].count));
}

template <int Dim>
std::span<std::uint8_t> Scene<Dim>::alive_of(int grain) {
    const BondBytes& bytes = bond_bytes[static_cast<std::size_t>(grain)];
    return {alive.data() + bytes.begin, bytes.count};
}

template <int Dim>
const MaterialGroup<Dim>& Scene<Dim>::group_of(int grain) const {
    return *std::partition_point(groups.begin(), groups.end(),
                                 [&](const auto& group) { return group.last_grain <= grain; });
}

template <int Dim>
std::vector<BrokenBond> Scene<Dim>::broken_bonds(int grain) const {
    const BondBits intact = view(grain).alive;
    std::vector<BrokenBond> broken;
    if (intact.empty()) return broken;
    std::visit(
        [&](const auto& model) {
            const Bonds<Dim>& bonds = model.bonds();
            for (int i = 0; i < bonds.n_nodes(); ++i)
                for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b)
                    if (!intact[b]) broken.push_back({i, bonds.partner[b]});
        },
        group_of(grain).model);
    return broken;
}

template <int Dim>
double Scene<Dim>::elastic_energy() const {
    double energy = points ? points->elastic_energy(particles) : 0.0;
    for (const MaterialGroup<Dim>& group : groups)
        energy += std::visit(
            [&](const auto& model) {
                return parallel::sum(
                    static_cast<std::size_t>(group.last_grain - group.first_grain), 0.0,
                    [&](std::size_t i) {
                        return model.elastic_energy(view(group.first_grain + static_cast<int>(i)));
                    },
                    1);
            },
            group.model);
    return energy;
}

template <int Dim>
ContactScene<Dim> Scene<Dim>::contact_scene() const {
    return {grains,           particles.x, contact_mass.empty() ? particles.mass : contact_mass,
            particles.volume, walls,       &friction,
            travelled};
}

template <int Dim>
bool Scene<Dim>::moves_with_grid() const {
    const auto* method = contact ? std::get_if<GridContact<Dim>>(&*contact) : nullptr;
    return method != nullptr && method->moves_with_grid();
}

template <int Dim>
double Scene<Dim>::stable_step() const {
    double least = std::numeric_limits<double>::infinity();
    for (const MaterialGroup<Dim>& group : groups) {
        const double omega = std::visit([](const auto& model) { return model.max_frequency(); }, group.model);
        const double zeta = 0.5 * omega * group.bond_damping;  // critical fraction of the fastest mode
        for (int g = group.first_grain; g < group.last_grain; ++g)
            least = std::min(least, 2.0 * grains[g].scale / omega *
                                        (std::sqrt(1.0 + zeta * zeta / (grains[g].scale * grains[g].scale)) -
                                         zeta / grains[g].scale));
    }
    for (const double omega : point_frequency) least = std::min(least, 2.0 / omega);
    if (const auto* pairs = contact ? std::get_if<NodePairContact<Dim>>(&*contact) : nullptr)
        least = std::min(least, pairs->stable_step());
    return least;
}

template struct Scene<2>;
template struct Scene<3>;

}  // namespace quern
