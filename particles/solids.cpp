#include "particles/solids.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace quern {
namespace {

using std::numbers::pi;

/// Area between the origin and the directed chord a -> b, cut by the disk of radius r about the origin.
///
/// Parts of the chord inside the disk give triangles, parts outside give sectors; the sum over a closed ring
/// is the area of ring and disk in common.
double wedge_area(const Vec<2>& a, const Vec<2>& b, double r) {
    const auto triangle = [](const Vec<2>& p, const Vec<2>& q) { return 0.5 * (p[0] * q[1] - p[1] * q[0]); };
    const auto sector = [r](const Vec<2>& p, const Vec<2>& q) {
        return 0.5 * r * r * std::atan2(p[0] * q[1] - p[1] * q[0], p.dot(q));
    };
    const Vec<2> along = b - a;
    const double aa = along.squaredNorm(), ab = a.dot(along), cc = a.squaredNorm() - r * r;
    const double root = ab * ab - aa * cc;
    if (aa == 0.0) return 0.0;
    if (root <= 0.0) return sector(a, b);
    const double s = std::sqrt(root);
    const double t_in = std::clamp((-ab - s) / aa, 0.0, 1.0), t_out = std::clamp((-ab + s) / aa, 0.0, 1.0);
    if (t_in >= t_out) return sector(a, b);
    const Vec<2> p = a + t_in * along, q = a + t_out * along;
    return (t_in > 0.0 ? sector(a, p) : 0.0) + triangle(p, q) + (t_out < 1.0 ? sector(q, b) : 0.0);
}

double disk_rectangle_area(double r, const Vec<2>& lo, const Vec<2>& hi) {
    const std::array<Vec<2>, 4> ring{lo, Vec<2>(hi[0], lo[1]), hi, Vec<2>(lo[0], hi[1])};
    double area = 0.0;
    for (int i = 0; i < 4; ++i) area += wedge_area(ring[i], ring[(i + 1) % 4], r);
    return std::max(0.0, area);
}

constexpr std::array<double, 6> gauss_x{0.1252334085114689, 0.3678314989981802, 0.5873179542866175,
                                        0.7699026741943047, 0.9041172563704749, 0.9815606342467192};
constexpr std::array<double, 6> gauss_w{0.2491470458134028, 0.2334925365383548, 0.2031674267230659,
                                        0.1600783285433462, 0.1069393259953184, 0.0471753363865118};

double ball_box_volume(double radius, const Vec<3>& lo, const Vec<3>& hi) {
    // The slice at height z is a disk of radius sqrt(R^2 - z^2) cut by a rectangle; it has a kink wherever
    // the circle passes a side or a corner of the rectangle.
    const double bottom = std::max(lo[2], -radius), top = std::min(hi[2], radius);
    if (bottom >= top) return 0.0;
    const Vec<2> a = lo.head<2>(), b = hi.head<2>();
    const std::array<double, 8> special{
        std::abs(a[0]), std::abs(a[1]), std::abs(b[0]),         std::abs(b[1]),
        a.norm(),       b.norm(),       std::hypot(a[0], b[1]), std::hypot(b[0], a[1])};
    std::array<double, 19> cuts{bottom, top};
    int n_cuts = 2;
    for (const double r : special) {
        if (r >= radius) continue;
        const double z = std::sqrt(radius * radius - r * r);
        if (z > bottom && z < top) cuts[n_cuts++] = z;
        if (-z > bottom && -z < top) cuts[n_cuts++] = -z;
    }
    if (bottom < 0.0 && top > 0.0) cuts[n_cuts++] = 0.0;
    std::sort(cuts.begin(), cuts.begin() + n_cuts);

    double volume = 0.0;
    for (int i = 0; i + 1 < n_cuts; ++i) {
        const double length = cuts[i + 1] - cuts[i];
        for (int side = -1; side <= 1; side += 2)
            for (std::size_t g = 0; g < gauss_x.size(); ++g) {
                // z = u^2 (3 - 2u): its zero slope at both ends tames the square roots there.
                const double u = 0.5 * (1.0 + side * gauss_x[g]);
                const double z = cuts[i] + length * u * u * (3.0 - 2.0 * u);
                const double r = std::sqrt(std::max(0.0, radius * radius - z * z));
                volume += 0.5 * gauss_w[g] * length * 6.0 * u * (1.0 - u) * disk_rectangle_area(r, a, b);
            }
    }
    return volume;
}

}  // namespace

template <int Dim>
double Ball<Dim>::measure() const {
    if constexpr (Dim == 2)
        return pi * radius_ * radius_;
    else
        return 4.0 / 3.0 * pi * radius_ * radius_ * radius_;
}

template <int Dim>
std::vector<Vec<Dim>> Ball<Dim>::outline() const {
    std::vector<Vec<Dim>> points;
    if constexpr (Dim == 2) {
        constexpr int n = 64;
        for (int i = 0; i < n; ++i)
            points.emplace_back(radius_ * std::cos(2.0 * pi * i / n), radius_ * std::sin(2.0 * pi * i / n));
    }
    return points;
}

template <int Dim>
SurfaceView<Dim> Ball<Dim>::view(const Vec<Dim>& x) const {
    SurfaceView<Dim> view;
    const double r = x.norm();
    view.normal = r > 0.0 ? Vec<Dim>(x / r) : Vec<Dim>(Vec<Dim>::Unit(0));
    view.point = radius_ * view.normal;
    view.distance = radius_ - r;
    view.kappa = 1.0 / radius_;
    return view;
}

template <int Dim>
double Ball<Dim>::overlap(const Vec<Dim>& lo, const Vec<Dim>& hi) const {
    if constexpr (Dim == 2)
        return disk_rectangle_area(radius_, lo, hi);
    else
        return ball_box_volume(radius_, lo, hi);
}

std::vector<Vec<3>> Cuboid::outline() const {
    std::vector<Vec<3>> corners;
    for (int i = 0; i < 8; ++i)
        corners.emplace_back(i & 1 ? half_[0] : -half_[0], i & 2 ? half_[1] : -half_[1],
                             i & 4 ? half_[2] : -half_[2]);
    return corners;
}

double Cuboid::distance(const Vec<3>& x) const {
    const Vec<3> inside = half_ - x.cwiseAbs();
    if (inside.minCoeff() >= 0.0) return inside.minCoeff();
    return -inside.cwiseMin(0.0).norm();
}

SurfaceView<3> Cuboid::view(const Vec<3>& x) const {
    const Vec<3> inside = half_ - x.cwiseAbs();
    const double nearest = inside.minCoeff();
    const double reach = 1.25 * std::max(0.0, nearest) + 1e-9 * half_.norm();
    SurfaceView<3> view;
    view.point = x;
    double sum = 0.0;
    int n_faces = 0;
    for (int a = 0; a < 3; ++a) {
        if (inside[a] > reach) continue;
        view.normal[a] = x[a] < 0.0 ? -1.0 : 1.0;
        view.point[a] = view.normal[a] * half_[a];
        sum += inside[a];
        ++n_faces;
    }
    view.normal.normalize();
    view.distance = sum / n_faces;
    return view;
}

double Cuboid::overlap(const Vec<3>& lo, const Vec<3>& hi) const {
    return (hi.cwiseMin(half_) - lo.cwiseMax(-half_)).cwiseMax(0.0).prod();
}

template class Ball<2>;
template class Ball<3>;

}  // namespace quern
