#include "src/sim/fragments.hpp"

#include <algorithm>
#include <iterator>
#include <numeric>

#include "particles/pieces.hpp"
#include "src/sim/step.hpp"

namespace quern {

namespace {

template <int Dim>
std::vector<int> pieces_of(const Scene<Dim>& scene, int g) {
    std::vector<int> piece;
    std::visit([&](const auto& model) { find_pieces<Dim>(model.bonds(), scene.view(g).alive, piece); },
               scene.group_of(g).model);
    return piece;
}

/// Whether bonds that are broken now, but not in `known`, can have parted what was one piece.
template <int Dim>
bool may_have_parted(const Scene<Dim>& scene, int g, const std::vector<BrokenBond>& known,
                     const std::vector<BrokenBond>& broken) {
    std::vector<BrokenBond> fresh;
    std::set_difference(broken.begin(), broken.end(), known.begin(), known.end(), std::back_inserter(fresh));
    return std::visit(
        [&](const auto& model) {
            return !std::all_of(fresh.begin(), fresh.end(), [&](const BrokenBond& bond) {
                return joined_by_two<Dim>(model.bonds(), scene.view(g).alive, bond.first, bond.second);
            });
        },
        scene.group_of(g).model);
}

/// Identities of the pieces of a grain.
template <int Dim>
void name_pieces(Scene<Dim>& scene, std::int64_t step, double time, int g, const std::vector<int>& piece) {
    Fragments& fragments = scene.fragments;
    const Grain<Dim>& grain = scene.grains[g];
    std::int32_t* name = fragments.of_particle.data() + grain.first;
    const std::size_t n_pieces = static_cast<std::size_t>(*std::max_element(piece.begin(), piece.end())) + 1;
    std::vector<std::int64_t> size(n_pieces, 0);
    std::vector<std::int32_t> old(n_pieces), own(n_pieces, -1);
    for (int i = 0; i < grain.count; ++i) {
        const std::size_t k = static_cast<std::size_t>(piece[i]);
        if (size[k]++ == 0) old[k] = name[i];
    }
    std::vector<std::size_t> order(n_pieces);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return old[a] != old[b] ? old[a] < old[b] : size[a] > size[b];
    });
    for (std::size_t k = 0; k < n_pieces; ++k)
        if (k == 0 || old[order[k]] != old[order[k - 1]]) own[order[k]] = old[order[k]];
    for (std::size_t k = 0; k < n_pieces; ++k) {
        if (own[k] < 0) {
            own[k] = static_cast<std::int32_t>(fragments.all.size());
            fragments.all.push_back({old[k], grain.id, 0, step, time});
        }
        fragments.all[static_cast<std::size_t>(own[k])].particles = size[k];
    }
    for (int i = 0; i < grain.count; ++i) name[i] = own[static_cast<std::size_t>(piece[i])];
}

/// Tells contact (no piece: pieces as before); returns the energy with which springs of new cracks begin [J;
/// 2D: J/m].
template <int Dim>
double tell_contact(Scene<Dim>& scene, int g, const std::vector<int>& piece, std::vector<BrokenBond> broken) {
    if (!scene.contact) return 0.0;
    if (auto* pairs = std::get_if<NodePairContact<Dim>>(&*scene.contact))
        return pairs->self_contact() ? pairs->set_broken(scene.contact_scene(), g, std::move(broken)) : 0.0;
    if (scene.contact_in_pieces)
        std::get<GridContact<Dim>>(*scene.contact).set_pieces(scene.contact_scene(), g, piece, broken);
    return 0.0;
}

}  // namespace

std::int64_t Fragments::n_debris() const {
    return std::count_if(all.begin(), all.end(), [&](const Fragment& f) { return is_debris(f); });
}

std::int64_t Fragments::n_fragments() const {
    return static_cast<std::int64_t>(all.size()) - n_debris();
}

std::int64_t Fragments::n_broken() const {
    return std::accumulate(broken.begin(), broken.end(), std::int64_t{0});
}

template <int Dim>
void start_fragments(Scene<Dim>& scene, int debris_below) {
    const bool breakable = std::any_of(scene.groups.begin(), scene.groups.end(),
                                       [](const auto& group) { return group.breakable; });
    if (!breakable) return;
    Fragments& fragments = scene.fragments;
    fragments.debris_below = debris_below;
    fragments.broken.assign(scene.grains.size(), 0);
    fragments.cut.assign(scene.grains.size(), 0);
    fragments.known.resize(scene.grains.size());
    fragments.of_particle.resize(scene.particles.x.size());
    for (const int g : scene.grain_of_id) {
        const Grain<Dim>& grain = scene.grains[g];
        fragments.all.push_back({-1, grain.id, grain.count, 0, 0.0});
        std::fill_n(fragments.of_particle.begin() + grain.first, grain.count,
                    static_cast<std::int32_t>(grain.id));
    }
    scene.torn.assign(scene.grains.size(), 0);
}

template <int Dim>
void hand_over_cracks(Scene<Dim>& scene) {
    if (scene.n_cut == 0) return;
    for (std::size_t k = 0; k < scene.grains.size(); ++k) {
        const int g = static_cast<int>(k);
        std::vector<BrokenBond>& cut = scene.fragments.known[k];
        cut = scene.broken_bonds(g);
        scene.fragments.cut[k] = static_cast<std::int64_t>(cut.size());
        if (cut.empty()) continue;
        const std::vector<int> piece = pieces_of(scene, g);
        name_pieces(scene, 0, 0.0, g, piece);
        tell_contact(scene, g, piece, cut);
    }
}

template <int Dim>
void update_fragments(Scene<Dim>& scene, StepContext<Dim>& now) {
    for (std::size_t g = 0; g < scene.torn.size(); ++g) {
        if (!scene.torn[g]) continue;
        scene.torn[g] = 0;
        const int grain = static_cast<int>(g);
        std::vector<BrokenBond> broken = scene.broken_bonds(grain);
        std::vector<int> piece;
        if (may_have_parted(scene, grain, scene.fragments.known[g], broken)) {
            piece = pieces_of(scene, grain);
            name_pieces(scene, now.step, now.time, grain, piece);
        }
        scene.fragments.known[g] = broken;
        scene.fragments.broken[g] = static_cast<std::int64_t>(broken.size()) - scene.fragments.cut[g];
        // What the springs of a new crack begin with comes from what its bonds have set free.
        now.ledger.past.fracture -= tell_contact(scene, grain, piece, std::move(broken));
    }
}

template <int Dim>
void recall_broken_bonds(Scene<Dim>& scene) {
    for (std::size_t k = 0; k < scene.fragments.broken.size(); ++k) {
        if (scene.fragments.broken[k] == 0) continue;
        const int g = static_cast<int>(k);
        scene.fragments.known[k] = scene.broken_bonds(g);
        tell_contact(scene, g, pieces_of(scene, g), scene.fragments.known[k]);
    }
}

template void start_fragments<2>(Scene<2>&, int);
template void start_fragments<3>(Scene<3>&, int);
template void hand_over_cracks<2>(Scene<2>&);
template void hand_over_cracks<3>(Scene<3>&);
template void update_fragments<2>(Scene<2>&, StepContext<2>&);
template void update_fragments<3>(Scene<3>&, StepContext<3>&);
template void recall_broken_bonds<2>(Scene<2>&);
template void recall_broken_bonds<3>(Scene<3>&);

}  // namespace quern
