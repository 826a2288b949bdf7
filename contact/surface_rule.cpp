#include "contact/surface_rule.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quern {

namespace {

constexpr double fit_reach = 2.5;            ///< [dx]
constexpr double fit_regularisation = 1e-3;  ///< variance [dx^2] below which a slope is not believed
constexpr double max_slope = 0.5;
/// Further along a surface than this from its nearest particle there is none [dx].
constexpr double furthest_beside = 1.5;
/// Least cosine between the normal of a particle and the direction in which it may meet something.
constexpr double facing = 0.3;
constexpr double deepest = 2.0;  ///< overlap that is still felt [dx]
/// How far from its own point a particle stands for the surface [dx]. A contact between several particles is
/// then at one point of all of them; at ends apart it would turn the sweeps against each other.
template <int Dim>
constexpr double piece = Dim == 2 ? 0.6 : 0.72;
constexpr double gap_of_path = 4.0;  ///< both bodies move; the rest is for what a distance does not know
constexpr double longest_path = 0.1;

template <int Dim>
using Tangential = Eigen::Matrix<double, Dim - 1, 1>;

/// What a circle of curvature k drops at distance u from its apex beyond the parabola k u^2/2.
double beyond_parabola(double k, double u) {
    const double z = std::min(k * k * u * u, 0.9);
    return k > 0.0 ? (1.0 - std::sqrt(1.0 - z) - 0.5 * z) / k : 0.0;
}

/// Surface particle of B in the support of its slot whose true surface point is nearest to one of A.
template <int Dim>
int nearest_of(const SurfaceSide<Dim>& B, const Vec<Dim>& s_a) {
    double least = std::numeric_limits<double>::infinity();
    int nearest = -1;
    for (int k = 0; k < B.slot->n_support; ++k) {
        const int surface = B.slot->support[k].surface;
        if (surface < 0) continue;
        const double squared = (B.on_surface(surface) - s_a).squaredNorm();
        if (squared < least) {
            least = squared;
            nearest = surface;
        }
    }
    return nearest;
}

/// No point of A next to s_a is nearer to B than this: surface points of B stand a spacing apart, and b is
/// the nearest one.
template <int Dim>
double least_distance(const SurfaceSide<Dim>& A, const Vec<Dim>& s_a, const SurfaceSide<Dim>& B, int b) {
    const double dx = std::max(A.dx(), B.dx());
    return std::sqrt(std::max((B.on_surface(b) - s_a).squaredNorm() - dx * dx, 0.0));
}

/// Where two heights come closest over what a particle of A stands for.
template <int Dim>
Tangential<Dim> closest(const Height<Dim>& A, const Height<Dim>& B, double reach) {
    const double curvature = A.kappa + B.kappa;
    // Two planes, or a hollow that is no wider: the particle itself.
    if (!(curvature > 0.0)) return Tangential<Dim>::Zero();
    const Tangential<Dim> t = (A.c1 - B.c1) / curvature;
    return t * std::min(1.0, reach / std::max(t.norm(), 1e-9 * reach));
}

template <int Dim>
double height_at(const Height<Dim>& y, const Tangential<Dim>& t, double sigma) {
    return y.c0 + y.c1.dot(t) - 0.5 * sigma * y.kappa * t.squaredNorm();
}

template <int Dim>
Vec<Dim> turned(const Vec<Dim>& n, const Tangential<Dim>& slope) {
    const Tangential<Dim> m = slope.cwiseMax(-max_slope).cwiseMin(max_slope);
    return (n - tangents<Dim>(n) * m).normalized();
}

/// Where a height is level over a plane that is turned by `slope`; not further than a fit knows.
template <int Dim>
Tangential<Dim> apex(const Height<Dim>& y, const Tangential<Dim>& slope, double sigma, double dx) {
    const Tangential<Dim> t = sigma * (y.c1 - slope) / std::max(y.kappa, 1e-9 / dx);
    return t * std::min(1.0, fit_reach * dx / std::max(t.norm(), 1e-9 * dx));
}

/// A piece of smooth surface against the height of B.
template <int Dim>
std::optional<Tile<Dim>> meet_piece(const SurfaceSide<Dim>& A, int a, const SurfaceSide<Dim>& B, int b) {
    Vec<Dim> n = (A.normal(a) - B.normal(b)).normalized();
    const Vec<Dim> s_a = A.on_surface(a);
    Tile<Dim> tile;
    Vec<Dim> level_a = Vec<Dim>::Zero(), level_b = level_a;
    for (int pass = 0; pass < 2; ++pass) {
        const auto y_a = fit_height<Dim>(A, a, s_a, n, 1.0, pass > 0 ? &level_a : nullptr);
        const auto y_b = fit_height<Dim>(B, b, s_a, n, -1.0, pass > 0 ? &level_b : nullptr);
        if (!y_a || !y_b) return std::nullopt;
        const Tangential<Dim> t = closest<Dim>(*y_a, *y_b, piece<Dim> * A.dx());
        const double at_a = height_at<Dim>(*y_a, t, 1.0), at_b = height_at<Dim>(*y_b, t, -1.0);
        tile.normal = n;
        tile.gap = at_b - at_a;
        tile.point = s_a + tangents<Dim>(n) * t + 0.5 * (at_a + at_b) * n;
        if (pass > 0) continue;
        const Tangential<Dim> slope = 0.5 * (y_a->c1 + y_b->c1) + 0.5 * (y_b->kappa - y_a->kappa) * t;
        level_a = tangents<Dim>(n) * apex<Dim>(*y_a, slope, 1.0, A.dx());
        level_b = tangents<Dim>(n) * apex<Dim>(*y_b, slope, -1.0, B.dx());
        n = turned<Dim>(n, slope);
    }
    return tile;
}

/// A ball, or a tip, against the height of B.
template <int Dim>
std::optional<Tile<Dim>> meet_ball(const SurfaceSide<Dim>& A, int a, const SurfaceSide<Dim>& B, int b) {
    Vec<Dim> n = -B.normal(b);
    const Tip<Dim>* tip = A.footprints->tip(a);
    const Vec<Dim> x_a = tip ? A.place(a, *tip) : A.position(a);
    const double r = tip ? 0.0 : A.depth(a);
    const auto askew = fit_height<Dim>(B, b, x_a, n, -1.0);
    if (!askew) return std::nullopt;
    n = turned<Dim>(n, askew->c1);
    const Vec<Dim> below = Vec<Dim>::Zero();  // n is B's normal
    const auto level = fit_height<Dim>(B, b, x_a, n, -1.0, &below);
    if (!level) return std::nullopt;
    Tile<Dim> tile;
    tile.normal = n;
    tile.gap = level->c0 - r;
    tile.point = x_a + (r + 0.5 * tile.gap) * n;
    return tile;
}

/// Two edges or corners: balls, which touch late rather than early.
template <int Dim>
std::optional<Tile<Dim>> meet_corner(const SurfaceSide<Dim>& A, int a, const SurfaceSide<Dim>& B, int b) {
    const Vec<Dim> between = B.position(b) - A.position(a);
    const double distance = between.norm();
    if (!(distance > 0.0)) return std::nullopt;
    Tile<Dim> tile;
    tile.normal = between / distance;
    tile.gap = distance - A.depth(a) - B.depth(b);
    tile.point = A.position(a) + (A.depth(a) + 0.5 * tile.gap) * tile.normal;
    return tile;
}

}  // namespace

template <int Dim>
std::optional<Height<Dim>> fit_height(const SurfaceSide<Dim>& side, int nearest, const Vec<Dim>& centre,
                                      const Vec<Dim>& n, double sigma, const Vec<Dim>* apex) {
    const Eigen::Matrix<double, Dim, Dim - 1> T = tangents<Dim>(n);
    const double dx = side.dx();
    const Vec<Dim> x_centre = side.origin + centre;
    Height<Dim> height;
    height.kappa = side.point(nearest).kappa / side.grain->scale;
    const Tangential<Dim> t_apex =
        apex ? Tangential<Dim>(T.transpose() * *apex) : Tangential<Dim>(Tangential<Dim>::Zero());
    double S = 0.0, y_mean = 0.0;
    Tangential<Dim> t_mean = Tangential<Dim>::Zero(), ty = Tangential<Dim>::Zero();
    Eigen::Matrix<double, Dim - 1, Dim - 1> tt = Eigen::Matrix<double, Dim - 1, Dim - 1>::Zero();
    for (const Neighbour& neighbour : side.footprints->around(nearest)) {
        if (!neighbour.beside) continue;
        const Vec<Dim> d = side.s[side.grain->first + neighbour.node] - x_centre;
        const Tangential<Dim> t = T.transpose() * d / dx;
        const double z = 1.0 - t.squaredNorm() / (fit_reach * fit_reach);
        if (neighbour.surface == nearest && t.norm() > furthest_beside) return std::nullopt;
        if (!(z > 0.0)) continue;
        const double w = z * z;
        double y = n.dot(d) + 0.5 * sigma * height.kappa * dx * dx * t.squaredNorm();
        if (apex) y += sigma * beyond_parabola(height.kappa, (dx * t - t_apex).norm());
        S += w;
        t_mean += w * t;
        y_mean += w * y;
        ty += w * y * t;
        tt += w * t * t.transpose();
    }
    t_mean /= S;
    y_mean /= S;
    tt = tt / S - t_mean * t_mean.transpose();
    tt.diagonal().array() += fit_regularisation;
    height.c1 = tt.inverse() * Tangential<Dim>(ty / S - y_mean * t_mean) / dx;
    height.c0 = y_mean - height.c1.dot(t_mean) * dx;
    return height;
}

template <int Dim>
std::optional<SurfaceContact<Dim>> meet(const SurfaceSide<Dim>& A, int a, const SurfaceSide<Dim>& B,
                                        double reach) {
    const Tip<Dim>* tip = A.footprints->tip(a);
    const Vec<Dim> s_a = tip ? A.place(a, *tip) : A.on_surface(a);
    const int b = nearest_of<Dim>(B, s_a);
    if (b < 0 || least_distance<Dim>(A, s_a, B, b) > reach) return std::nullopt;
    const Vec<Dim> n_a = tip ? Vec<Dim>(*A.rotation * tip->normal) : A.normal(a), n_b = B.normal(b);
    const bool sharp_b = B.footprints->sharp(b);
    std::optional<Tile<Dim>> tile;
    if (sharp_b) {
        if (A.footprints->sharp(a)) tile = meet_corner<Dim>(A, a, B, b);
    } else if (n_a.dot(n_b) < -facing) {
        tile = A.smooth() ? meet_piece<Dim>(A, a, B, b) : meet_ball<Dim>(A, a, B, b);
    }
    if (!tile || tile->gap < -deepest * B.dx() || n_a.dot(tile->normal) < facing ||
        n_b.dot(tile->normal) > -facing)
        return std::nullopt;
    if (const Tip<Dim>* end = B.footprints->tip(b); end && !sharp_b) {  // beyond it B has no surface
        const Vec<Dim> x_end = B.place(b, *end), to_end = x_end - B.position(b), beyond = tile->point - x_end;
        if ((beyond - tile->normal.dot(beyond) * tile->normal).dot(to_end) > 0.0) return std::nullopt;
    }
    return SurfaceContact<Dim>{*tile, a, b};
}

template <int Dim>
std::optional<SurfaceContact<Dim>> meet(const SurfaceSide<Dim>& A, int a, const Wall<Dim>& wall,
                                        double reach) {
    // Nothing of what a particle stands for is nearer than its own point by more.
    if (wall.distance(A.origin + A.on_surface(a)) - A.dx() > reach) return std::nullopt;
    SurfaceContact<Dim> contact;
    contact.a = a;
    contact.b = -1;
    Tile<Dim>& tile = contact.tile;
    tile.normal = -wall.normal;
    if (A.smooth()) {
        const Vec<Dim> s_a = A.on_surface(a);
        const Height<Dim> plane{Tangential<Dim>::Zero(), 0.0, 0.0};
        // Over itself a particle has a surface.
        Height<Dim> y_a = fit_height<Dim>(A, a, s_a, tile.normal, 1.0).value_or(plane);
        const Vec<Dim> level =
            tangents<Dim>(tile.normal) * apex<Dim>(y_a, Tangential<Dim>::Zero(), 1.0, A.dx());
        y_a = fit_height<Dim>(A, a, s_a, tile.normal, 1.0, &level).value_or(y_a);
        const Tangential<Dim> t = closest<Dim>(y_a, plane, piece<Dim> * A.dx());
        tile.point = s_a + tangents<Dim>(tile.normal) * t + height_at<Dim>(y_a, t, 1.0) * tile.normal;
    } else {
        const Tip<Dim>* tip = A.footprints->tip(a);
        tile.point = tip ? A.place(a, *tip) : Vec<Dim>(A.position(a) + A.depth(a) * tile.normal);
    }
    tile.gap = wall.distance(A.origin + tile.point);
    tile.point += 0.5 * tile.gap * tile.normal;
    return contact;
}

template <int Dim>
bool all_look_for(const SurfaceSide<Dim>& A, const SurfaceSide<Dim>& B) {
    constexpr double as_fine = 1.0 + 1e-9;
    if (A.dx() > as_fine * B.dx()) return false;
    if (B.dx() > as_fine * A.dx()) return true;
    const Vec<Dim> x_a = A.x[A.grain->first] - A.origin, x_b = B.x[B.grain->first] - B.origin;
    return std::lexicographical_compare(x_a.data(), x_a.data() + Dim, x_b.data(), x_b.data() + Dim);
}

template <int Dim>
void find_surface(const Grain<Dim>& grain, const Mat<Dim>& rotation, std::span<const Vec<Dim>> x,
                  std::span<Vec<Dim>> s) {
    for (const SurfacePoint<Dim>& point : grain.shape->surface) {
        const int p = grain.first + point.node;
        s[p] = x[p] + point.delta * grain.scale * (rotation * point.nu);
    }
}

namespace {

/// Calls visit(surface) for the particles of a side that may belong to its node before the longest path.
template <int Dim, class Visit>
void for_each_near(const SurfaceSide<Dim>& side, double h, Visit&& visit) {
    for (int k = 0; k < side.slot->n_support; ++k) {
        const Support<Dim>& e = side.slot->support[k];
        if (e.surface < 0) continue;
        if (side.on_surface(e.surface).cwiseAbs().maxCoeff() <= (0.5 + longest_path) * h) visit(e.surface);
    }
}

}  // namespace

template <int Dim>
double surface_free_path(const SurfaceSide<Dim>& A, const SurfaceSide<Dim>& B, double h) {
    double least = gap_of_path * longest_path * h;
    const auto one_on_other = [&](const SurfaceSide<Dim>& one, const SurfaceSide<Dim>& other) {
        const bool all = all_look_for<Dim>(one, other);
        for_each_near<Dim>(one, h, [&](int surface) {
            if (!all && !one.footprints->tip(surface)) return;
            const int nearest = nearest_of<Dim>(other, one.on_surface(surface));
            if (nearest < 0) return;
            double gap = least_distance<Dim>(one, one.on_surface(surface), other, nearest);
            if (gap >= least) return;
            // Only of round ones a fit knows more than the distance of two particles.
            if (one.smooth() && other.smooth())
                if (const auto contact = meet<Dim>(one, surface, other, least))
                    gap = std::max(gap, contact->tile.gap);
            least = std::min(least, gap);
        });
    };
    one_on_other(A, B);
    one_on_other(B, A);
    return std::max(least, 0.0) / (gap_of_path * h);
}

template <int Dim>
double surface_free_path(const SurfaceSide<Dim>& A, const Wall<Dim>& wall, double h) {
    double least = 2.0 * longest_path * h;
    for_each_near<Dim>(A, h, [&](int surface) {
        if (const auto contact = meet<Dim>(A, surface, wall, least))
            least = std::min(least, contact->tile.gap);
    });
    return std::max(least, 0.0) / (2.0 * h);
}

template std::optional<Height<2>> fit_height<2>(const SurfaceSide<2>&, int, const Vec<2>&, const Vec<2>&,
                                                double, const Vec<2>*);
template std::optional<Height<3>> fit_height<3>(const SurfaceSide<3>&, int, const Vec<3>&, const Vec<3>&,
                                                double, const Vec<3>*);
template std::optional<SurfaceContact<2>> meet<2>(const SurfaceSide<2>&, int, const SurfaceSide<2>&, double);
template std::optional<SurfaceContact<3>> meet<3>(const SurfaceSide<3>&, int, const SurfaceSide<3>&, double);
template std::optional<SurfaceContact<2>> meet<2>(const SurfaceSide<2>&, int, const Wall<2>&, double);
template std::optional<SurfaceContact<3>> meet<3>(const SurfaceSide<3>&, int, const Wall<3>&, double);
template bool all_look_for<2>(const SurfaceSide<2>&, const SurfaceSide<2>&);
template void find_surface<2>(const Grain<2>&, const Mat<2>&, std::span<const Vec<2>>, std::span<Vec<2>>);
template void find_surface<3>(const Grain<3>&, const Mat<3>&, std::span<const Vec<3>>, std::span<Vec<3>>);
template bool all_look_for<3>(const SurfaceSide<3>&, const SurfaceSide<3>&);
template double surface_free_path<2>(const SurfaceSide<2>&, const SurfaceSide<2>&, double);
template double surface_free_path<3>(const SurfaceSide<3>&, const SurfaceSide<3>&, double);
template double surface_free_path<2>(const SurfaceSide<2>&, const Wall<2>&, double);
template double surface_free_path<3>(const SurfaceSide<3>&, const Wall<3>&, double);

}  // namespace quern
