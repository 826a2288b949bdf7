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

constexpr int power(int base, int exponent) {
    return exponent == 0 ? 1 : base * power(base, exponent - 1);
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

/// The 3^Dim nodes of the quadratic B-spline with its gradient with respect to the point, in units 1/h.
template <int Dim>
struct QuadraticStencil {
    static constexpr int size = power(3, Dim);
    IntVec<Dim> base;
    std::array<std::array<double, 3>, Dim> B, dB;

    explicit QuadraticStencil(const Vec<Dim>& in_cells) {
        const IntVec<Dim> cell = CartesianGrid<Dim>::cell(in_cells);
        for (int a = 0; a < Dim; ++a) {
            const double f = in_cells[a] - cell[a];
            const bool upper = f >= 0.5;
            base[a] = cell[a] + (upper ? 0 : -1);
            const double r = upper ? f - 1.0 : f;  // from the nearest node, in [-1/2, 1/2)
            B[a] = {0.5 * (0.5 - r) * (0.5 - r), 0.75 - r * r, 0.5 * (0.5 + r) * (0.5 + r)};
            dB[a] = {r - 0.5, -2.0 * r, r + 0.5};
        }
    }
    IntVec<Dim> node(int k) const {
        IntVec<Dim> n = base;
        for (int a = 0; a < Dim; ++a, k /= 3) n[a] += k % 3;
        return n;
    }
    Vec<Dim> gradient(int k) const {
        std::array<int, Dim> i;
        for (int a = 0; a < Dim; ++a, k /= 3) i[a] = k % 3;
        Vec<Dim> g;
        for (int a = 0; a < Dim; ++a) {
            g[a] = dB[a][i[a]];
            for (int b = 0; b < Dim; ++b)
                if (b != a) g[a] *= B[b][i[b]];
        }
        return g;
    }
    double value(int k) const {
        double w = 1.0;
        for (int a = 0; a < Dim; ++a, k /= 3) w *= B[a][k % 3];
        return w;
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
