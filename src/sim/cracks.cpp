#include "src/sim/cracks.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "grid/error.hpp"
#include "particles/crack.hpp"

namespace quern {

namespace {

/// visit(grain) for the grains that a crack or a zone speaks of.
template <int Dim, class Target, class Visit>
void for_each_target(const Deck& deck, const Scene<Dim>& scene, const Target& target, Visit&& visit) {
    for (std::size_t g = 0; g < scene.grains.size(); ++g) {
        const int id = scene.grains[g].id;
        const bool listed = std::find(target.grains.begin(), target.grains.end(), id) != target.grains.end();
        if (!target.grains.empty() && !listed) continue;
        if (!target.shape.empty() && deck.grains[static_cast<std::size_t>(id)].shape != target.shape)
            continue;
        visit(static_cast<int>(g));
    }
}

/// Places of the nodes of a grain in the frame that a crack or a zone is given in.
template <int Dim>
std::span<const Vec<Dim>> places(const Scene<Dim>& scene, int g, PlaceFrame frame) {
    const Grain<Dim>& grain = scene.grains[g];
    if (frame == PlaceFrame::shape) return grain.shape->X;
    return {scene.particles.x.data() + grain.first, static_cast<std::size_t>(grain.count)};
}

/// visit(i, j, byte, bit) for every bond of a grain.
template <int Dim, class Visit>
void for_each_bit(const Scene<Dim>& scene, int g, Visit&& visit) {
    const BondBytes& bytes = scene.bond_bytes[static_cast<std::size_t>(g)];
    std::visit(
        [&](const auto& model) {
            const Bonds<Dim>& bonds = model.bonds();
            for (int i = 0; i < bonds.n_nodes(); ++i)
                for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
                    const int place = bytes.place == nullptr ? b : bytes.place[b];
                    visit(i, bonds.partner[b], bytes.begin + static_cast<std::size_t>(place),
                          static_cast<std::uint8_t>(1U << bytes.bit));
                }
        },
        scene.group_of(g).model);
}

template <int Dim>
Crack<Dim> make_crack(const CrackDeck& from) {
    Crack<Dim> crack;
    for (int a = 0; a < Dim; ++a) {
        crack.corner[a] = from.from[a];
        crack.edge[0][a] = from.to[a] - from.from[a];
        if constexpr (Dim == 3) crack.edge[1][a] = from.edge[a];
    }
    return crack;
}

}  // namespace

template <int Dim>
void mark_cracked(const Deck& deck, Scene<Dim>& scene) {
    std::vector<bool> cracked(deck.materials.size(), false);
    for (const CrackDeck& crack : deck.cracks)
        for_each_target(deck, scene, crack, [&](int g) {
            const Material& material = deck.materials[scene.grains[g].material];
            if (material.model == ForceModel::correspondence)
                throw InputError(
                    crack.place.text(),
                    fmt::format("a crack in grains of '{}', model: correspondence", material.name),
                    "grains of another model", "name them by crack.grains");
            cracked[scene.grains[g].material] = true;
        });
    for (MaterialGroup<Dim>& group : scene.groups)
        group.breakable |= cracked[scene.grains[group.first_grain].material];
}

template <int Dim>
void set_cracks(const Deck& deck, Scene<Dim>& scene) {
    for (const CrackDeck& from : deck.cracks) {
        const Crack<Dim> crack = make_crack<Dim>(from);
        bool crossed = false;
        for_each_target(deck, scene, from, [&](int g) {
            const std::span<const Vec<Dim>> X = places(scene, g, from.frame);
            for_each_bit(scene, g, [&](int i, int j, std::size_t byte, std::uint8_t bit) {
                if (!crack.cuts(X[i], X[j])) return;
                crossed = true;
                if ((scene.alive[byte] & bit) == 0) return;
                scene.alive[byte] = static_cast<std::uint8_t>(scene.alive[byte] & ~bit);
                ++scene.n_cut;
            });
        });
        if (!crossed)
            throw InputError(from.place.text(), "a crack that crosses no bond",
                             "a crack through a grain that it is meant for");
    }
    if (scene.n_cut > 0) scene.whole = scene.alive;
}

template <int Dim>
void set_no_fail(const Deck& deck, Scene<Dim>& scene) {
    for (const NoFailDeck& zone : deck.no_fail) {
        bool found = false;
        for_each_target(deck, scene, zone, [&](int g) {
            std::vector<bool> inside;
            for (const Vec<Dim>& x : places(scene, g, zone.frame))
                inside.push_back((*zone.region)(x[0], x[1], Dim == 3 ? x[Dim - 1] : 0.0, 0.0) != 0.0);
            if (std::find(inside.begin(), inside.end(), true) == inside.end()) return;
            found = true;
            if (!scene.group_of(g).breakable) return;
            if (scene.kept.empty()) scene.kept.assign(scene.alive.size(), 0);
            for_each_bit(scene, g, [&](int i, int j, std::size_t byte, std::uint8_t bit) {
                if (inside[i] || inside[j]) scene.kept[byte] |= bit;
            });
        });
        if (!found)
            throw InputError(zone.place.text(), "a region without particles", "at least one particle in it");
    }
}

template void mark_cracked(const Deck&, Scene<2>&);
template void mark_cracked(const Deck&, Scene<3>&);
template void set_cracks(const Deck&, Scene<2>&);
template void set_cracks(const Deck&, Scene<3>&);
template void set_no_fail(const Deck&, Scene<2>&);
template void set_no_fail(const Deck&, Scene<3>&);

}  // namespace quern
