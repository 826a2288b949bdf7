// Fragments: the pieces that grains have come apart into, each with an identity and a history.
//
// A grain as placed is the fragment of its number in the deck. When bonds break, or cracks of the start cut
// them, the pieces of what was one fragment are found anew (particles/pieces.hpp): the one of most particles
// stays the old fragment (of equal ones that with the lowest particle), the others are born, numbered on from
// the number of grains, in the order of the grains and of their lowest particles. Pieces of fewer particles
// than `contact.debris` are counted as debris.
#pragma once

#include <cstdint>
#include <vector>

#include "contact/contact.hpp"

namespace quern {

struct Fragment {
    std::int64_t parent = -1;  ///< fragment that it broke off; -1: as placed
    std::int64_t grain = 0;    ///< number in the deck
    std::int64_t particles = 0;
    std::int64_t step = 0;  ///< of its birth
    double born = 0.0;      ///< [s]
};

/// Of all grains; empty where none can break.
struct Fragments {
    std::vector<Fragment> all;                   ///< by number
    std::vector<std::int32_t> of_particle;       ///< [n]
    std::vector<std::int64_t> broken;            ///< [n_grains] bonds, of Scene::grains; not those of `cut`
    std::vector<std::int64_t> cut;               ///< [n_grains] bonds that cracks of the start cross
    std::vector<std::vector<BrokenBond>> known;  ///< [n_grains] broken when pieces were last found, ascending
    int debris_below = 0;                        ///< particles

    bool is_debris(const Fragment& fragment) const { return fragment.particles < debris_below; }
    std::int64_t n_fragments() const;  ///< that are no debris
    std::int64_t n_debris() const;     ///< pieces
    std::int64_t n_broken() const;     ///< bonds
};

template <int Dim>
struct Scene;
template <int Dim>
struct StepContext;

/// Every grain is one fragment.
template <int Dim>
void start_fragments(Scene<Dim>& scene, int debris_below);

/// Fragments of grains that cracks of the start cut, and what contact has to know of these. Once contact is
/// there.
template <int Dim>
void hand_over_cracks(Scene<Dim>& scene);

/// After bonds have broken: fragments of the grains that are torn, and what contact has to know of it. Pieces
/// are looked for only if a new broken bond has no detour over a third node (joined_by_two).
template <int Dim>
void update_fragments(Scene<Dim>& scene, StepContext<Dim>& now);

/// Contact of a scene whose bonds have been loaded.
template <int Dim>
void recall_broken_bonds(Scene<Dim>& scene);

}  // namespace quern
