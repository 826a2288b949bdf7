// The surface rule: contact points are the surface particles of one grain against the surface of the other.
//
// Around a surface particle q of a grain its surface is a height y over the tangent plane of n at a point c,
// fitted to the true surface points of its neighbours p, s_p = x_p + delta_p nu_p, by moving least squares
// (sigma = +1 for the grain that n points out of, -1 for the other; kappa: reference curvature at q):
//
//     d_p = s_p - c,   t_p = T^T d_p,   w_p = K(|t_p|/(2.5 dx)),   K(z) = (1 - z^2)^2 below 1, else 0
//     y(t) = c0 + c1.t - sigma kappa |t|^2/2,    c0, c1 from  y_p = n.d_p + sigma b(|t_p - t_0|)
//     b(u) = (1 - sqrt(1 - kappa^2 u^2))/kappa - kappa u^2/2,  t_0 = sigma c1/kappa of a first fit without b
//
// so a surface is where its particles are now and as round as it was made (b: what a circle drops beyond the
// parabola of its apex t_0). A particle p of grain A meets the surface of B around its particle q that is
// nearest to s_p:
//
//     smooth A    closest approach of both heights over |t| <= 0.6 dx (space: 0.72 dx), what p stands for:
//                 t* = clamp((c1_A - c1_B)/(kappa_A + kappa_B)),  g = y_B(t*) - y_A(t*),  x_c midway;
//                 n starts as nu_p - nu_q, and is turned once by the mean slope there
//     A cornered  p is a ball of radius delta_p:  g = y_B(0) - delta_p with c = x_p, n turned to B's normal;
//                 next to an edge or corner it is that point (footprint.hpp: tip) instead
//     q an edge or corner of B: two balls if p is one, too; else nothing, for q itself meets A's face
//     wall        the same with y_B the plane itself, n fixed: exact, and no node has a part in it
//
// Particles of the finer grain look for the coarser one, and edges and corners of the coarser one for the
// finer, so that no corner gets into a face. (All in both directions say everything twice: restitution of
// oblique disks 0.970 in the place of 0.975, and sweeps that take twice as long to agree.) A contact belongs
// to the node nearest to s_p; each side takes the impulse with a patch (patch.hpp). Allowed approach, cone
// and sweeps: pair_rule.hpp.
//
// Guendelman, Bridson, Fedkiw 2003 have points of one body on a signed distance of the other, stored on a
// grid of its own; here the distance is fitted where it is asked for, nodes only tell who is near, and a
// point is a piece of surface, so that a disk rolls as a disk and not as the polygon of its particles.
#pragma once

#include "contact/footprint.hpp"
#include "contact/tile.hpp"

namespace quern {

/// What one side of a contact is made of. `origin` [m]: where its positions see the node.
template <int Dim>
struct SurfaceSide {
    const Slot<Dim>* slot;
    const Grain<Dim>* grain;
    const Mat<Dim>* rotation;  ///< of the grain, from the reference to now
    const Footprints<Dim>* footprints;
    std::span<const Vec<Dim>> x;  ///< positions of all particles [m]
    std::span<const Vec<Dim>> s;  ///< of those at the surface: the nearest point of the true surface [m]
    Vec<Dim> origin;

    const SurfacePoint<Dim>& point(int surface) const { return grain->shape->surface[surface]; }
    Vec<Dim> normal(int surface) const { return *rotation * point(surface).nu; }
    double depth(int surface) const { return point(surface).delta * grain->scale; }
    double dx() const { return grain->shape->dx * grain->scale; }
    bool smooth() const { return !grain->shape->cornered; }
    Vec<Dim> position(int surface) const { return x[grain->first + point(surface).node] - origin; }
    /// Its nearest point of the true surface, from the node [m].
    Vec<Dim> on_surface(int surface) const { return s[grain->first + point(surface).node] - origin; }
    Vec<Dim> place(int surface, const Tip<Dim>& tip) const {
        return position(surface) + grain->scale * (*rotation * tip.offset);
    }
};

/// The surface of a grain over a plane.
template <int Dim>
struct Height {
    Eigen::Matrix<double, Dim - 1, 1> c1;
    double c0, kappa;  ///< [m], [1/m]
};

/// Height of the surface around its particle `nearest`, over the plane through `centre` (from the node, [m])
/// across n. sigma: +1 if n points out of the grain, -1 into it. Nothing if
/// that particle is more than 1.5 dx away along the plane: there the surface is no height. apex: where it is
/// level, by an earlier fit, from the centre.
template <int Dim>
std::optional<Height<Dim>> fit_height(const SurfaceSide<Dim>& side, int nearest, const Vec<Dim>& centre,
                                      const Vec<Dim>& n, double sigma, const Vec<Dim>* apex = nullptr);

template <int Dim>
struct SurfaceContact {
    Tile<Dim> tile;  ///< normal from A to B
    int a, b;        ///< surface particles; b = -1: a wall
};

/// True surface points of a grain, s[first ...] of its particles at the surface.
template <int Dim>
void find_surface(const Grain<Dim>& grain, const Mat<Dim>& rotation, std::span<const Vec<Dim>> x,
                  std::span<Vec<Dim>> s);

/// Surface particle `a` of A against B; nothing if B is not facing, or surely further than `reach` [m].
template <int Dim>
std::optional<SurfaceContact<Dim>> meet(const SurfaceSide<Dim>& A, int a, const SurfaceSide<Dim>& B,
                                        double reach);

/// Surface particle `a` of A against a wall; nothing if it is surely further than `reach` [m].
template <int Dim>
std::optional<SurfaceContact<Dim>> meet(const SurfaceSide<Dim>& A, int a, const Wall<Dim>& wall,
                                        double reach);

/// Which surface particles of A look for B: all of the finer grain, of alike ones all of the one whose first
/// particle is lower on the first axis (then the next); of the other one only edges and corners.
template <int Dim>
bool all_look_for(const SurfaceSide<Dim>& A, const SurfaceSide<Dim>& B);

/// Calls visit(surface) for the surface particles in the support of a slot that belong to its node.
template <int Dim, class Visit>
void for_each_owned(const SurfaceSide<Dim>& side, const CartesianGrid<Dim>& grid, Visit&& visit) {
    for (int k = 0; k < side.slot->n_support; ++k) {
        const Support<Dim>& e = side.slot->support[k];
        if (e.surface < 0) continue;
        const Vec<Dim> half_up = grid.in_cells(side.s[e.particle]) + Vec<Dim>::Constant(0.5);
        if (CartesianGrid<Dim>::cell(half_up) == side.slot->index) visit(e.surface);
    }
}

/// How far each of two bodies may move before a particle that belongs to a node, or will within that way, can
/// touch something [h]: a quarter of the least gap, half of it from a wall, at most 1/10. Where surfaces are
/// near but say no gap, 0.
template <int Dim>
double surface_free_path(const SurfaceSide<Dim>& A, const SurfaceSide<Dim>& B, double h);
template <int Dim>
double surface_free_path(const SurfaceSide<Dim>& A, const Wall<Dim>& wall, double h);

}  // namespace quern
