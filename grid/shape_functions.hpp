// Shape functions of the grid along one axis: linear hats, and quadratic B-splines (de Boor 1978). Those of a
// node in the plane or in space are products over the axes.
//
//     linear, support 2 h:      N(t) = (1 - |t|)+
//     quadratic, support 3 h:   B(t) = (o^2 - 3 i^2)/2,  o = (3/2 - |t|)+,  i = (1/2 - |t|)+
//                               dB/dt = N(t + 1/2) - N(t - 1/2)
//
// t = (x - x_a)/h; ( )+ is 0 where the bracket is negative. Both sum to one over the nodes a. Four points at
// once, without branches.
#pragma once

#include "grid/vec.hpp"

namespace quern {

/// A number of each of four points.
using Pack = Eigen::Array<double, 4, 1>;
constexpr int pack_size = 4;

/// Always in this order.
inline double sum(const Pack& pack) {
    return (pack[0] + pack[1]) + (pack[2] + pack[3]);
}

inline Pack linear_shape(const Pack& t) {
    return (1.0 - t.abs()).max(0.0);
}

inline Pack quadratic_shape(const Pack& t) {
    const Pack r = t.abs();
    const Pack outer = (1.5 - r).max(0.0), inner = (0.5 - r).max(0.0);
    return 0.5 * (outer * outer - 3.0 * inner * inner);
}

inline Pack quadratic_slope(const Pack& t) {
    return linear_shape(t + 0.5) - linear_shape(t - 0.5);
}

}  // namespace quern
