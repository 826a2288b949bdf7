#include "particles/ellipse.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "particles/solids.hpp"

namespace quern {
namespace {

/// Nearest point of the ellipse with half axes a >= b to (x, y) with x, y >= 0.
Vec<2> nearest_in_quadrant(double a, double b, double x, double y) {
    const double aa = a * a, bb = b * b;
    if (y == 0.0) {
        const double q = aa * x;
        if (q >= a * (aa - bb)) return {a, 0.0};
        const double at = q / (aa - bb) / a;
        return {a * at, b * std::sqrt(1.0 - at * at)};
    }
    const auto excess = [&](double t) {
        const double u = a * x / (t + aa), v = b * y / (t + bb);
        return u * u + v * v - 1.0;
    };
    // At the lower end the second term alone is 1, at the upper neither can be more than a half.
    double low = -bb + b * y, high = -bb + std::hypot(a * x, b * y);
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (low + high);
        if (middle == low || middle == high) break;
        (excess(middle) > 0.0 ? low : high) = middle;
    }
    const double t = 0.5 * (low + high);
    return {aa * x / (t + aa), bb * y / (t + bb)};
}

}  // namespace

double Ellipse::measure() const {
    return std::numbers::pi * axes_[0] * axes_[1];
}

std::vector<Vec<2>> Ellipse::outline() const {
    std::vector<Vec<2>> points = Ball<2>(1.0).outline();
    for (Vec<2>& p : points) p = p.cwiseProduct(axes_);
    return points;
}

SurfaceView<2> Ellipse::view(const Vec<2>& x) const {
    const int longer = axes_[0] >= axes_[1] ? 0 : 1, shorter = 1 - longer;
    const Vec<2> q =
        nearest_in_quadrant(axes_[longer], axes_[shorter], std::abs(x[longer]), std::abs(x[shorter]));
    SurfaceView<2> view;
    view.point[longer] = std::copysign(q[0], x[longer]);
    view.point[shorter] = std::copysign(q[1], x[shorter]);
    const Vec<2> gradient = view.point.cwiseQuotient(axes_.cwiseProduct(axes_));
    const double steepness = gradient.norm();
    view.normal = gradient / steepness;
    view.kappa = 1.0 / (std::pow(axes_[0] * axes_[1], 2) * steepness * steepness * steepness);
    const bool inside = x.cwiseQuotient(axes_).squaredNorm() < 1.0;
    view.distance = (inside ? 1.0 : -1.0) * (x - view.point).norm();
    return view;
}

double Ellipse::overlap(const Vec<2>& lo, const Vec<2>& hi) const {
    return axes_.prod() * Ball<2>(1.0).overlap(lo.cwiseQuotient(axes_), hi.cwiseQuotient(axes_));
}

}  // namespace quern
