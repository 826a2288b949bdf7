// Solids with a closed form: ball (disk in the plane) and cuboid. Same interface as Polygon.
#pragma once

#include <vector>

#include "grid/vec.hpp"
#include "particles/polygon.hpp"

namespace quern {

/// Disk (Dim 2) or ball (Dim 3) about the origin.
template <int Dim>
class Ball {
  public:
    explicit Ball(double radius) : radius_(radius) {}

    bool cornered() const { return false; }
    double radius_about(const Vec<Dim>& centre) const { return radius_ + centre.norm(); }
    Vec<Dim> low() const { return Vec<Dim>::Constant(-radius_); }
    Vec<Dim> high() const { return Vec<Dim>::Constant(radius_); }
    /// Area [m^2] or volume [m^3].
    double measure() const;
    /// 64 points of the circle; none in 3D.
    std::vector<Vec<Dim>> outline() const;
    double distance(const Vec<Dim>& x) const { return radius_ - x.norm(); }
    SurfaceView<Dim> view(const Vec<Dim>& x) const;

    /// Area or volume of the part inside the box [lo, hi]. 2D: exact. 3D: exact in the plane z = const,
    /// Gauss-Legendre along z between all kinks of the integrand (error below 1e-9 of the box).
    double overlap(const Vec<Dim>& lo, const Vec<Dim>& hi) const;

  private:
    double radius_;
};

/// Box with edges along the axes, centred at the origin.
class Cuboid {
  public:
    explicit Cuboid(const Vec<3>& size) : half_(0.5 * size) {}

    bool cornered() const { return true; }
    double radius_about(const Vec<3>& centre) const { return (half_ + centre.cwiseAbs()).norm(); }
    Vec<3> low() const { return -half_; }
    Vec<3> high() const { return half_; }
    double measure() const { return 8.0 * half_.prod(); }
    /// The eight corners.
    std::vector<Vec<3>> outline() const;
    double distance(const Vec<3>& x) const;

    /// Faces no further than 1.25 times the nearest one count as one edge or corner: the normal is their
    /// bisector and the distance their mean.
    SurfaceView<3> view(const Vec<3>& x) const;
    double overlap(const Vec<3>& lo, const Vec<3>& hi) const;

  private:
    Vec<3> half_;
};

extern template class Ball<2>;
extern template class Ball<3>;

}  // namespace quern
