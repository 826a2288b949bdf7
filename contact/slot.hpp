// What one grain has around one contact node.
#pragma once

#include "grid/vec.hpp"

namespace quern {

/// One particle in the support of a node.
template <int Dim>
struct Support {
    int particle;
    int surface;  ///< index into Shape::surface, or -1
    double N;     ///< linear shape function
    double w;     ///< weight of the slot: N, or N^2 at the surface and q N^2 inside
    double mw;    ///< m_p w_p [kg]
    Vec<Dim> d;   ///< x_p - x_a [m]
};

/// One grain at one contact node.
template <int Dim>
struct Slot {
    int grain;
    int n_support;
    IntVec<Dim> index;  ///< node, not wrapped: where the grain sees it
    const Support<Dim>* support;
    double m;     ///< sum m_p w_p [kg]
    Vec<Dim> xb;  ///< sum m_p w_p d_p / m, from the node [m]
    Eigen::Matrix<double, n_spin<Dim>, n_spin<Dim>>
        Y;              ///< inverse of sum m_p w_p (|r|^2 1 - r r^T); 0: degenerate
    bool rotates;       ///< Y is usable
    double volume;      ///< sum N_p V_p
    double away = 0.0;  ///< while nodes are chosen: of the nearest surface particle from the support [h]
    Vec<Dim> gradient;  ///< sum V_p grad_a B(x_a - x_p), quadratic B-spline: points into the grain
};

/// Inverse of the inertia sum m (|r|^2 1 - r r^T), from second = sum m r r^T; false, and 0, for a point or a
/// line: if the least moment is below 1e-3 m length^2.
bool invert_inertia(const Mat<2>& second, double m, double length, Eigen::Matrix<double, 1, 1>& Y);
bool invert_inertia(const Mat<3>& second, double m, double length, Mat<3>& Y);

}  // namespace quern
