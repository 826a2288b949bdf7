// Shape functions of the grid: products of linear hats, and of quadratic B-splines (de Boor 1978).
//
//     linear, support 2 h:      N(r) = 1 - |r|
//     quadratic, support 3 h:   B(r) = 3/4 - r^2 (|r| < 1/2),  (3/2 - |r|)^2 / 2 (|r| < 3/2)
//
// r = (x - x_a)/h on one axis. Both sum to one over the nodes a.
#pragma once

#include <array>

#include "grid/cartesian_grid.hpp"

namespace quern {

template <class T>
constexpr T power(T base, int exponent) {
    return exponent == 0 ? T{1} : base * power(base, exponent - 1);
}

/// The 2^Dim nodes whose linear functions a point sees. Node k = base + bits of k.
template <int Dim>
struct LinearStencil {
    static constexpr int size = power(2, Dim);
    IntVec<Dim> base;
    std::array<double, size> N;

    explicit LinearStencil(const Vec<Dim>& in_cells) : base(CartesianGrid<Dim>::cell(in_cells)) {
        const Vec<Dim> f = in_cells - base.template cast<double>();
        for (int k = 0; k < size; ++k) {
            double w = 1.0;
            for (int a = 0; a < Dim; ++a) w *= (k >> a & 1) ? f[a] : 1.0 - f[a];
            N[k] = w;
        }
    }
    IntVec<Dim> node(int k) const {
        IntVec<Dim> n = base;
        for (int a = 0; a < Dim; ++a) n[a] += k >> a & 1;
        return n;
    }
};

/// Gradient of the quadratic B-spline of one node with respect to the point, in units 1/h; t: from the node
/// to the point, |t| <= 3/2 on every axis.
template <int Dim>
[[gnu::always_inline]] inline Vec<Dim> quadratic_gradient(const Vec<Dim>& t) {
    Vec<Dim> B, dB;
    for (int a = 0; a < Dim; ++a) {
        const double r = std::abs(t[a]), outer = 1.5 - r;
        B[a] = r < 0.5 ? 0.75 - r * r : 0.5 * outer * outer;
        dB[a] = r < 0.5 ? -2.0 * t[a] : (t[a] > 0.0 ? -outer : outer);
    }
    Vec<Dim> g;
    for (int a = 0; a < Dim; ++a) {
        g[a] = dB[a];
        for (int b = 0; b < Dim; ++b)
            if (b != a) g[a] *= B[b];
    }
    return g;
}

}  // namespace quern
