// Neighbourhoods on the surface of a shape: which particles stand around each of its surface particles.
//
// Known once and for all from the reference positions, so contact follows a surface without a search. Of a
// shape with corners a surface particle knows only those of its own face: of an edge the others of that edge,
// of a corner itself alone.
#pragma once

#include <span>
#include <vector>

#include "particles/shape.hpp"

namespace quern {

/// A particle beside a surface particle.
struct Neighbour {
    int node;     ///< index into Shape::X
    int surface;  ///< index into Shape::surface, or -1: inside
    bool beside;  ///< at the surface and of the same face
};

/// An edge or corner, in the reference frame.
template <int Dim>
struct Tip {
    Vec<Dim> offset;  ///< from the particle [m]
    Vec<Dim> normal;  ///< bisector of the faces, outward
};

template <int Dim>
class Footprints {
  public:
    /// Reach of the neighbourhoods [dx]: that of the widest kernel, and how far its middle is from a
    /// particle.
    static constexpr double reach = 3.25;

    explicit Footprints(const Shape<Dim>& shape);

    std::span<const Neighbour> around(int surface) const {
        return {neighbours_.data() + begin_[surface], neighbours_.data() + begin_[surface + 1]};
    }
    /// Whether the particle is at an edge or corner: the others of its face tell no plane.
    bool sharp(int surface) const { return sharp_[surface] != 0; }
    /// The edge or corner of which a particle is the nearest; nothing for most. In the plane corners of the
    /// outline, which need not have a particle of their own; in space those of sharp particles, at
    ///
    ///     X + delta nu / c,   c = least nu.nu_q of the faces q next to it
    const Tip<Dim>* tip(int surface) const {
        return tip_of_[surface] < 0 ? nullptr : &tips_[static_cast<std::size_t>(tip_of_[surface])];
    }

  private:
    void find_tips(const Shape<Dim>& shape);

    std::vector<int> begin_;  ///< [n_surface + 1]
    std::vector<Neighbour> neighbours_;
    std::vector<char> sharp_;  ///< [n_surface]
    std::vector<int> tip_of_;  ///< [n_surface] -1: none
    std::vector<Tip<Dim>> tips_;
};

extern template class Footprints<2>;
extern template class Footprints<3>;

}  // namespace quern
