// Small shapes for the tests of this room: lattices, cut to a disk or a ball, and shaken ones.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>

#include "particles/shape.hpp"

namespace quern::test {

/// Box of counts[d] nodes an axis at spacing dx, in the frame of its centre.
template <int Dim>
Shape<Dim> make_lattice(const IntVec<Dim>& counts, double dx) {
    Shape<Dim> shape;
    shape.name = "lattice";
    shape.dx = dx;
    for (int id = 0; id < counts.prod(); ++id) {
        Vec<Dim> X;
        int rest = id;
        for (int d = 0; d < Dim; ++d) {
            X[d] = dx * (rest % counts[d] - 0.5 * (counts[d] - 1));
            rest /= counts[d];
        }
        shape.X.push_back(X);
        shape.volume.push_back(std::pow(dx, Dim));
        shape.radius = std::max(shape.radius, X.norm());
        for (int d = 0; d < Dim; ++d) {
            const double edge = 0.5 * dx * (counts[d] - 1);
            if (std::abs(std::abs(X[d]) - edge) > 0.1 * dx) continue;
            shape.surface.push_back(
                {.node = id, .nu = std::copysign(1.0, X[d]) * Vec<Dim>::Unit(d), .delta = 0.5 * dx});
            break;
        }
    }
    return shape;
}

/// Lattice nodes within `radius` of the centre: a disk or a ball.
template <int Dim>
Shape<Dim> make_round(double radius, double dx) {
    const int count = 2 * static_cast<int>(radius / dx) + 2;
    Shape<Dim> shape = make_lattice<Dim>(IntVec<Dim>::Constant(count), dx);
    std::erase_if(shape.X, [&](const Vec<Dim>& X) { return X.norm() > radius; });
    shape.volume.resize(shape.X.size());
    shape.surface.clear();
    for (int i = 0; i < shape.n_nodes(); ++i) {
        const double below = radius - shape.X[i].norm();
        if (below < dx)
            shape.surface.push_back(
                {.node = i, .nu = shape.X[i].normalized(), .delta = below, .kappa = 1.0 / radius});
    }
    shape.name = "round";
    shape.radius = radius;
    return shape;
}

/// Every node moved and every volume changed by up to `share` of itself; the seed is fixed.
template <int Dim>
Shape<Dim> make_shaken(Shape<Dim> shape, double share) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(-share, share);
    for (Vec<Dim>& X : shape.X)
        for (int d = 0; d < Dim; ++d) X[d] += shape.dx * any(random);
    for (double& volume : shape.volume) volume *= 1.0 + any(random);
    shape.name = "shaken";
    return shape;
}

}  // namespace quern::test
