// An ellipse about the origin with its axes along x and y. Same interface as Polygon and Ball.
#pragma once

#include <vector>

#include "grid/vec.hpp"
#include "particles/polygon.hpp"

namespace quern {

class Ellipse {
  public:
    /// a, b > 0: half the lengths along x and y [m].
    Ellipse(double a, double b) : axes_(a, b) {}

    bool cornered() const { return false; }
    /// Largest distance [m] of the outline from a point near the centre: the longer half axis and the
    /// distance of the point, which is a bound, exact at the centre.
    double radius_about(const Vec<2>& centre) const { return axes_.maxCoeff() + centre.norm(); }
    Vec<2> low() const { return -axes_; }
    Vec<2> high() const { return axes_; }
    double measure() const;
    /// 64 points at equal steps of the eccentric angle.
    std::vector<Vec<2>> outline() const;

    /// Distance [m] to the outline, positive inside.
    double distance(const Vec<2>& x) const { return view(x).distance; }

    /// Nearest point q of the outline, normal and curvature there:
    ///
    ///     q_i   = a_i^2 x_i/(t + a_i^2)          t: the largest root of  sum (a_i x_i/(t + a_i^2))^2 = 1
    ///     [m^2] n     = (q_1/a_1^2, q_2/a_2^2)/|.| kappa = 1/(a_1 a_2)^2 (q_1^2/a_1^4 + q_2^2/a_2^4)^(-3/2)
    ///     [1/m]
    ///
    /// The root is bracketed and bisected to the last bit (D. Eberly, "Distance from a point to an ellipse",
    /// geometrictools.com, 2013). On the longer axis between the centres of curvature, where two points are
    /// equally near, that with y >= 0 (x >= 0 where b is the longer).
    SurfaceView<2> view(const Vec<2>& x) const;

    /// Exact area [m^2] of the part inside the rectangle [lo, hi]: that of a disk and a stretched rectangle.
    double overlap(const Vec<2>& lo, const Vec<2>& hi) const;

  private:
    Vec<2> axes_;
};

}  // namespace quern
