// Shape functions between material points and grid nodes, along one axis.
//
// A point is a box of half width l around x (in cells), a node a the hat H(t) = (1 - |t|)+ around x_a:
//
//     N_a  = 1/(2 l) int_{x-l}^{x+l} H(s - x_a) ds        dN_a/dx = (H(x + l - x_a) - H(x - l - x_a))/(2 l)
//
//     linear      l -> 0      H itself                     2 nodes an axis
//     gimp        l = half the side of the point's reference volume, at most 1/2   3 nodes
//     quadratic   l = 1/2     quadratic B-spline           3 nodes
//
// All sum to one over the nodes, their slopes to zero, and sum N_a x_a = x.
// Source: Bardenhagen & Kober, Comput. Model. Eng. Sci. 5 (2004) 477, eq 30 (uniform GIMP: the box keeps its
// size and its axes). Differs: one form for all three, without cases. Boxes that follow the stretch of the
// point (cpGIMP) are left out: they shrink to nothing when a grain turns by a right angle.
#pragma once

#include <algorithm>

#include "grid/cartesian_grid.hpp"
#include "particles/point_options.hpp"

namespace quern {

/// Nodes around a point and their functions; those of a node in the plane or in space are products.
template <int Dim, PointFunctions functions>
struct PointStencil {
    static constexpr int width = functions == PointFunctions::linear ? 2 : 3;

    IntVec<Dim> base;          ///< lowest node
    Vec<Dim> offset;           ///< of the point from that node [cells]
    double value[Dim][width];  ///< N [-]
    double slope[Dim][width];  ///< dN/dx [1/cell]

    /// in_cells: the point in grid units. half: l [cells], read by gimp alone.
    void set(const Vec<Dim>& in_cells, double half) {
        if constexpr (functions == PointFunctions::linear) {
            base = CartesianGrid<Dim>::cell(in_cells);
            offset = in_cells - base.template cast<double>();
            for (int a = 0; a < Dim; ++a) {
                value[a][0] = 1.0 - offset[a];
                value[a][1] = offset[a];
                slope[a][0] = -1.0;
                slope[a][1] = 1.0;
            }
        } else {
            const double l = functions == PointFunctions::quadratic ? 0.5 : half;
            const double inverse = 0.5 / l;
            const Vec<Dim> low = in_cells - Vec<Dim>::Constant(l);
            base = CartesianGrid<Dim>::cell(low);
            offset = in_cells - base.template cast<double>();
            for (int a = 0; a < Dim; ++a) {
                const double begin = low[a] - base[a], end = begin + 2.0 * l;
                const double to_first = 1.0 - begin, left = std::max(1.0 - end, 0.0);
                const double past = std::max(end - 1.0, 0.0);
                value[a][0] = 0.5 * inverse * (to_first * to_first - left * left);
                value[a][2] = 0.5 * inverse * past * past;
                value[a][1] = 1.0 - value[a][0] - value[a][2];
                slope[a][0] = inverse * (left - to_first);
                slope[a][2] = inverse * past;
                slope[a][1] = -(slope[a][0] + slope[a][2]);
            }
        }
    }
};

}  // namespace quern
