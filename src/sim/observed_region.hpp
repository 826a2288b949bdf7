// A region of the deck now: which part of a particle lies in it, and its volume.
//
// The box of a region ends at the walls and at the faces of the grid. Walls across an axis cut it exactly;
// oblique walls and formulas by a lattice of points, whose share is the volume's (2e-4 off for a disk of
// a third of the box; tests/sim/observation.cpp). Faces that are no walls of the box cut particles as
// src/observe/bins.hpp says; nothing of a particle is lost behind a wall. With a formula a particle is in or
// out by its centre.
#pragma once

#include <optional>
#include <vector>

#include "src/observe/bins.hpp"
#include "src/sim/scene.hpp"

namespace quern {

/// The box between the walls that stand across an axis, and the faces of the grid where there is none.
template <int Dim>
struct ObservedBox {
    Vec<Dim> low = Vec<Dim>::Zero(), high = Vec<Dim>::Zero();  ///< [m]
};
template <int Dim>
ObservedBox<Dim> box_between_walls(const Scene<Dim>& scene);

template <int Dim>
class ObservedRegion {
  public:
    /// `region`: null for all between the walls.
    ObservedRegion(const Scene<Dim>& scene, const ObserveRegion* region, double time);

    double volume() const { return volume_; }             ///< [m^3; 2D: m^2]
    bool contains(const Vec<Dim>& x) const;               ///< of a point, wrapped along periodic axes
    double part(const Vec<Dim>& x, double volume) const;  ///< of a particle of this volume that lies inside

  private:
    Vec<Dim> wrapped(Vec<Dim> x) const;
    bool formula_holds(const Vec<Dim>& x) const;

    const Scene<Dim>& scene_;
    const std::optional<Expression>* where_ = nullptr;
    double time_;
    ObservedBox<Dim> box_;
    std::array<bool, Dim> cut_low_{}, cut_high_{};  ///< faces that are no walls
    double volume_ = 0.0;
};

}  // namespace quern
