// The bodies of grid contact: whole grains, and the pieces of those that are broken.
//
// Inside a grain nothing changes when it breaks: bonds, forces and arrays stay as they were. Contact sees
// arrays of its own, in which the particles of each piece stand next to each other: a piece is then a grain
// like any other (its shape: piece_shape.hpp), and no rule has to know of pieces. Positions and velocities
// are copied there in every step and velocities back; as long as all grains are in one piece nothing is
// copied. Arrays are made anew when a piece comes apart; a bond that breaks inside one only adds to `cracks`.
//
// Pieces of fewer particles than a bound are debris: too small to have a surface on the grid. They belong to
// no body; loose_contact.hpp moves them.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "contact/contact.hpp"

namespace quern {

/// A particle of debris, by its place in the arrays of the bodies.
struct LooseParticle {
    int particle, body;  ///< body: one number a piece, behind those of the bodies
};
/// Two particles on both sides of a crack inside one piece.
struct CrackPair {
    int first, second;
    double range;  ///< distance at which they touch [m]
};

template <int Dim>
class ContactBodies {
  public:
    /// `debris`: pieces of fewer particles than this are debris.
    explicit ContactBodies(int debris) : debris_below_(debris) {}

    /// What has become of a grain: piece [n] as of particles/pieces.hpp (empty: as before), and all its
    /// broken bonds.
    void set_pieces(const ContactScene<Dim>& scene, int grain, std::span<const int> piece,
                    std::span<const BrokenBond> broken);
    /// Whether bodies have changed since the last call.
    bool changed() { return std::exchange(changed_, false); }
    /// Shapes that no body has any more.
    std::vector<std::unique_ptr<Shape<Dim>>> take_old_shapes() { return std::exchange(old_shapes_, {}); }
    /// No grain has a broken bond.
    bool whole() const { return torn_.empty(); }

    /// What contact works on, until the next call of set_pieces.
    ContactScene<Dim> gather(const ContactScene<Dim>& grains);
    ContactTrial<Dim> gather(const ContactTrial<Dim>& grains);
    /// Velocities to where they came from.
    void give_back(const ContactTrial<Dim>& grains) const;

    /// [n] particle of the grains at each place.
    std::span<const int> order() const { return order_; }
    int body_of(int particle) const { return body_of_[particle]; }
    int grain_of(int body) const { return grain_of_[body]; }
    /// The grain that a body or a piece of debris is of, with `first` 0: shape, scale and material.
    const Grain<Dim>& owner(int body) const { return owners_[body]; }
    /// Node of the owner's shape at a place, and the place of a node of the owner of a body.
    int node_at(int place) const { return order_[place] - first_of_[body_of_[place]]; }
    int place_of(int body, int node) const { return place_of_[first_of_[body] + node]; }
    const std::vector<LooseParticle>& debris() const { return debris_; }
    const std::vector<CrackPair>& cracks() const { return cracks_; }
    /// Particles of the pieces that are bodies, by their places.
    const std::vector<int>& in_pieces() const { return in_pieces_; }

  private:
    struct Piece {
        std::unique_ptr<Shape<Dim>> shape;  ///< none: debris
        std::vector<int> nodes;
    };
    struct Torn {
        int grain = -1;
        std::vector<int> piece;          ///< empty: all in one
        std::vector<Piece> pieces;       ///< empty: all in one
        std::vector<BrokenBond> cracks;  ///< inside pieces
        bool in_pieces() const { return !pieces.empty(); }
    };
    /// Particles [first, last): all of whole grains, which stand where they stood, or all of torn ones.
    struct Run {
        int first, last;
        bool moved;
    };
    Torn& torn(int grain);
    void make_bodies(const ContactScene<Dim>& grains);
    void make_cracks(const ContactScene<Dim>& grains);
    template <class T>
    void pick(std::span<const T> from, std::vector<T>& to) const;

    int debris_below_;
    std::vector<Torn> torn_;  // by grain
    std::vector<std::unique_ptr<Shape<Dim>>> old_shapes_;
    bool changed_ = false;
    bool bodies_outdated_ = true, cracks_outdated_ = true;

    bool in_order_ = true;  // no grain is in pieces
    std::vector<int> order_;
    std::vector<int> place_of_;  // the inverse of order_
    std::vector<Run> runs_;
    std::vector<Grain<Dim>> bodies_;
    std::vector<int> grain_of_;  // [n_bodies + pieces of debris]
    std::vector<Grain<Dim>> owners_;
    std::vector<int> first_of_;  // of owners_, in the arrays of the grains
    std::vector<int> body_of_;   // [n]
    std::vector<LooseParticle> debris_;
    std::vector<CrackPair> cracks_;
    std::vector<int> in_pieces_;
    std::vector<Vec<Dim>> x_, v_, v_before_, drift_;
    std::vector<double> mass_, volume_;
};

}  // namespace quern
