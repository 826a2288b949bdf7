#include "contact/tile.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quern {

namespace {

constexpr double fit_regularisation = 1e-3;  ///< variance [h^2] below which a slope is not believed
constexpr double flat_on_flat = 0.2;         ///< curvature [1/h] that centres two flat faces
constexpr double flattest = 0.1;  ///< curvature [1/h] of a pair below which its closest point rocks
constexpr double max_slope = 0.5;
constexpr double max_interface_distance = 0.75;  ///< from the node [h]
constexpr double anywhere = std::numeric_limits<double>::infinity();
constexpr double least_filling = 0.1;  ///< volume [cells] that a slot needs to have a surface
/// The fit of a grain with corners jumps when particles of another face join it: by this much [h], twice as
/// much where the slot is filled less than this.
constexpr double corner_jump = 0.25, trusted_filling = 0.35;
/// Fits to a few particles at the rim of a slot may be far off: no node sleeps longer than this [h].
constexpr double longest_path = 0.1, longest_path_with_corners = 0.03;
/// Two bodies that move close a gap twice as fast as one; the rest is for what the fit does not know.
constexpr double gap_of_path = 4.0;
/// Least cosine between a particle's normal and that of the contact, for cornered grains: keeps the corners
/// of a box (0.577), drops the next face of a hexagon (0.5).
constexpr double corner_filter = 0.55;

/// y(s) = c0 + c1.s + c2 |s|^2, in units of h.
template <int Dim>
struct Profile {
    using Tangential = Eigen::Matrix<double, Dim - 1, 1>;
    double c0 = 0.0;
    Tangential c1 = Tangential::Zero();
    double c2 = 0.0;

    double operator()(const Tangential& s) const { return c0 + c1.dot(s) + c2 * s.squaredNorm(); }

    /// Where it is level; nothing for a plane, or if that is more than a cell away, where a fit knows little.
    std::optional<Tangential> apex() const {
        if (c2 == 0.0) return std::nullopt;
        const Tangential s = -c1 / (2.0 * c2);
        if (s.cwiseAbs().maxCoeff() > 1.0) return std::nullopt;
        return s;
    }
};

/// What a circle of curvature k drops at distance u from its apex beyond the parabola k u^2/2.
double beyond_parabola(double k, double u) {
    const double z = std::min(k * k * u * u, 0.9);
    return k > 0.0 ? (1.0 - std::sqrt(1.0 - z) - 0.5 * z) / k : 0.0;
}

/// `apex`: where the profile of an earlier fit is level, if there was one.
template <int Dim>
std::optional<Profile<Dim>> fit(const TileSide<Dim>& side, double sigma, const Vec<Dim>& n,
                                const Eigen::Matrix<double, Dim, Dim - 1>& T, double h,
                                const GridContactOptions& options,
                                const std::optional<typename Profile<Dim>::Tangential>& apex) {
    using Tangential = typename Profile<Dim>::Tangential;
    const Slot<Dim>& slot = *side.slot;
    const Grain<Dim>& grain = *side.grain;
    double S = 0.0, kappa = 0.0, y_mean = 0.0;
    Tangential s_mean = Tangential::Zero(), sy = Tangential::Zero(), s_squared = Tangential::Zero();
    Eigen::Matrix<double, Dim - 1, Dim - 1> ss = Eigen::Matrix<double, Dim - 1, Dim - 1>::Zero();
    double squared_mean = 0.0;
    for (int k = 0; k < slot.n_support; ++k) {
        const Support<Dim>& e = slot.support[k];
        if (e.surface < 0) continue;
        const SurfacePoint<Dim>& point = grain.shape->surface[e.surface];
        const Vec<Dim> nu = *side.rotation * point.nu;
        if (grain.shape->cornered && sigma * n.dot(nu) < corner_filter) continue;
        // The nearest point of the true surface; at a corner, the face that the contact is with.
        const Vec<Dim> d =
            e.d + point.delta * grain.scale * (grain.shape->cornered ? Vec<Dim>(sigma * n) : nu);
        const Tangential s = T.transpose() * d / h;
        double y = n.dot(d) / h;
        if (apex) y += sigma * beyond_parabola(point.kappa / grain.scale * h, (s - *apex).norm());
        S += e.N;
        kappa += e.N * point.kappa;
        s_mean += e.N * s;
        y_mean += e.N * y;
        sy += e.N * y * s;
        ss += e.N * s * s.transpose();
        squared_mean += e.N * s.squaredNorm();
        s_squared += e.N * s.squaredNorm() * s;
    }
    if (!(S > 0.0)) return std::nullopt;
    Profile<Dim> profile;
    if (options.curvature) profile.c2 = -sigma * kappa / S / grain.scale * h / 2.0;
    s_mean /= S;
    // Moments of y - c2 |s|^2, from those of y: one pass over the particles for both.
    y_mean = y_mean / S - profile.c2 * squared_mean / S;
    if (options.tile) {
        const Tangential covariance = sy / S - profile.c2 * s_squared / S - y_mean * s_mean;
        Eigen::Matrix<double, Dim - 1, Dim - 1> variance = ss / S - s_mean * s_mean.transpose();
        variance.diagonal().array() += fit_regularisation;
        profile.c1 = variance.inverse() * covariance;
    }
    profile.c0 = y_mean - profile.c1.dot(s_mean);
    if (!options.tile) {  // mean positions: a flat profile at the mean height
        profile.c0 += profile.c2 * squared_mean / S;
        profile.c2 = 0.0;
    }
    return profile;
}

template <int Dim>
Tile<Dim> closest_approach(const Profile<Dim>& A, const Profile<Dim>& B, const Vec<Dim>& n,
                           const Eigen::Matrix<double, Dim, Dim - 1>& T, double h, double least_curvature,
                           typename Profile<Dim>::Tangential& s) {
    const typename Profile<Dim>::Tangential q1 = B.c1 - A.c1;
    const double q2 = B.c2 - A.c2;
    const bool flat = A.c2 == 0.0 && B.c2 == 0.0;
    const double curvature = flat ? flat_on_flat : (q2 > 0.0 ? std::max(q2, least_curvature) : q2);
    for (int a = 0; a < Dim - 1; ++a) {
        if (curvature > 0.0)
            s[a] = std::clamp(-q1[a] / (2.0 * curvature), -0.5, 0.5);
        else  // a hollow: the gap is least at an end of the cell
            s[a] = q1[a] > 0.0 ? -0.5 : (q1[a] < 0.0 ? 0.5 : 0.0);
    }
    Tile<Dim> tile;
    tile.normal = n;
    tile.gap = h * (B(s) - A(s));
    tile.point = h * (T * s) + h * 0.5 * (A(s) + B(s)) * n;
    return tile;
}

}  // namespace

template <>
Eigen::Matrix<double, 2, 1> tangents<2>(const Vec<2>& n) {
    return {-n[1], n[0]};
}

template <>
Eigen::Matrix<double, 3, 2> tangents<3>(const Vec<3>& n) {
    int least = 0;
    for (int a = 1; a < 3; ++a)
        if (std::abs(n[a]) < std::abs(n[least])) least = a;
    const Vec<3> t = n.cross(Vec<3>::Unit(least)).normalized();
    Eigen::Matrix<double, 3, 2> T;
    T.col(0) = t;
    T.col(1) = n.cross(t);
    return T;
}

namespace {

/// Tile of two grains whose interface is not further than `reach` [h] from the node.
template <int Dim>
std::optional<Tile<Dim>> tile_within(double reach, const TileSide<Dim>& A, const TileSide<Dim>& B, double h,
                                     const GridContactOptions& options) {
    Vec<Dim> n = B.slot->gradient - A.slot->gradient;
    const double length = n.norm();
    if (!(length > 0.0)) return std::nullopt;
    n /= length;
    Tile<Dim> tile;
    std::optional<typename Profile<Dim>::Tangential> apex_a, apex_b;
    for (int pass = 0; pass < 2; ++pass) {
        const Eigen::Matrix<double, Dim, Dim - 1> T = tangents<Dim>(n);
        const auto a = fit<Dim>(A, 1.0, n, T, h, options, apex_a);
        const auto b = fit<Dim>(B, -1.0, n, T, h, options, apex_b);
        if (!a || !b) return std::nullopt;
        typename Profile<Dim>::Tangential s;
        tile = closest_approach<Dim>(*a, *b, n, T, h, flattest, s);
        if (std::abs(tile.point.dot(n)) > reach * h) return std::nullopt;
        if (pass == 0 && options.tile) {
            typename Profile<Dim>::Tangential m = 0.5 * (a->c1 + b->c1) + (a->c2 + b->c2) * s;
            m = m.cwiseMax(-max_slope).cwiseMin(max_slope);
            n = (n - T * m).normalized();
            // Turning the normal moves the level point of both profiles to where they come closest.
            apex_a = a->c2 != 0.0 ? std::optional(s) : std::nullopt;
            apex_b = b->c2 != 0.0 ? std::optional(s) : std::nullopt;
        }
    }
    return tile;
}

template <int Dim>
std::optional<Tile<Dim>> wall_tile_within(double reach, const TileSide<Dim>& A, const Wall<Dim>& wall,
                                          double wall_offset, double h, const GridContactOptions& options) {
    const Vec<Dim> n = -wall.normal;
    const Eigen::Matrix<double, Dim, Dim - 1> T = tangents<Dim>(n);
    auto a = fit<Dim>(A, 1.0, n, T, h, options, std::nullopt);
    if (a && a->apex()) a = fit<Dim>(A, 1.0, n, T, h, options, a->apex());
    if (!a) return std::nullopt;
    Profile<Dim> plane;
    plane.c0 = wall_offset / h;
    typename Profile<Dim>::Tangential s;
    const Tile<Dim> tile = closest_approach<Dim>(*a, plane, n, T, h, 0.0, s);
    if (std::abs(tile.point.dot(n)) > reach * h) return std::nullopt;
    return tile;
}

/// What a grain fills of a cell at the node, or of the smaller of both grains.
template <int Dim>
double filling(const TileSide<Dim>& side, double h, double other_volume) {
    return side.slot->volume / std::min({power(h, Dim), side.grain->volume, other_volume});
}

/// `least`: filling of the side that has less; `jumps`: fits may jump.
template <int Dim>
double path_to_meet(const std::optional<Tile<Dim>>& tile, double away, double least, bool jumps, double h) {
    // A surface that moves by s sweeps s h^(Dim-1) of the cell at most, sqrt(Dim) as much askew.
    const double to_fill = (least_filling - least) / 2.0;
    if (!tile) return std::max(away, to_fill);
    const double jump = jumps ? (least < trusted_filling ? 2.0 * corner_jump : corner_jump) : 0.0;
    const double gap = tile->gap / h - jump;
    const double beyond = std::abs(tile->point.dot(tile->normal)) / h - max_interface_distance - jump;
    const double path = std::max({gap / gap_of_path, beyond / 2.0, to_fill, 0.0});
    return std::min(path, jumps ? longest_path_with_corners : longest_path);
}

}  // namespace

template <int Dim>
std::optional<Tile<Dim>> make_tile(const TileSide<Dim>& A, const TileSide<Dim>& B, double h,
                                   const GridContactOptions& options) {
    if (std::min(filling(A, h, B.grain->volume), filling(B, h, A.grain->volume)) < least_filling)
        return std::nullopt;
    return tile_within(max_interface_distance, A, B, h, options);
}

template <int Dim>
std::optional<Tile<Dim>> make_wall_tile(const TileSide<Dim>& A, const Wall<Dim>& wall, double wall_offset,
                                        double h, const GridContactOptions& options) {
    if (filling(A, h, A.grain->volume) < least_filling) return std::nullopt;
    return wall_tile_within(max_interface_distance, A, wall, wall_offset, h, options);
}

template <int Dim>
double free_path(const TileSide<Dim>& A, const TileSide<Dim>& B, double h,
                 const GridContactOptions& options) {
    const double least = std::min(filling(A, h, B.grain->volume), filling(B, h, A.grain->volume));
    const bool jumps = A.grain->shape->cornered || B.grain->shape->cornered;
    return path_to_meet(tile_within(anywhere, A, B, h, options), std::max(A.slot->away, B.slot->away), least,
                        jumps, h);
}

template <int Dim>
double free_path(const TileSide<Dim>& A, const Wall<Dim>& wall, double wall_offset, double h,
                 const GridContactOptions& options) {
    return path_to_meet(wall_tile_within(anywhere, A, wall, wall_offset, h, options), A.slot->away,
                        filling(A, h, A.grain->volume), A.grain->shape->cornered, h);
}

template double free_path<2>(const TileSide<2>&, const TileSide<2>&, double, const GridContactOptions&);
template double free_path<3>(const TileSide<3>&, const TileSide<3>&, double, const GridContactOptions&);
template double free_path<2>(const TileSide<2>&, const Wall<2>&, double, double, const GridContactOptions&);
template double free_path<3>(const TileSide<3>&, const Wall<3>&, double, double, const GridContactOptions&);
template std::optional<Tile<2>> make_tile<2>(const TileSide<2>&, const TileSide<2>&, double,
                                             const GridContactOptions&);
template std::optional<Tile<3>> make_tile<3>(const TileSide<3>&, const TileSide<3>&, double,
                                             const GridContactOptions&);
template std::optional<Tile<2>> make_wall_tile<2>(const TileSide<2>&, const Wall<2>&, double, double,
                                                  const GridContactOptions&);
template std::optional<Tile<3>> make_wall_tile<3>(const TileSide<3>&, const Wall<3>&, double, double,
                                                  const GridContactOptions&);

}  // namespace quern
