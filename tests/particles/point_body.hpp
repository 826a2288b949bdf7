// One grain of material points for the tests of this room.
#pragma once

#include <limits>
#include <span>
#include <vector>

#include "particles/material_points.hpp"
#include "tests/particles/lattice.hpp"

namespace quern::test {

inline constexpr double point_density = 3000.0;
inline const VonMises elastic{10e6, 2.5e6, std::numeric_limits<double>::infinity(), 0.0};
inline const VonMises yielding{10e6, 2.5e6, 2e4, 5e5};

/// One grain of a shape on a grid of twice its spacing, in the middle of a box, off the nodes.
template <int Dim>
struct PointBody {
    PointBody(const Shape<Dim>& from, const PointOptions& options, const VonMises& law)
        : shape(from),
          grid(Vec<Dim>::Zero(), 2.0 * from.dx, IntVec<Dim>::Constant(60), {}),
          points(grid, options, false) {
        Grain<Dim> grain;
        grain.shape = &shape;
        grain.count = shape.n_nodes();
        for (int i = 0; i < grain.count; ++i) {
            particles.x.push_back(shape.X[i] + Vec<Dim>::Constant(30.17 * grid.h()));
            particles.volume.push_back(shape.volume[i]);
            particles.mass.push_back(point_density * shape.volume[i]);
        }
        particles.v.assign(particles.x.size(), Vec<Dim>::Zero());
        points.add_grain(grain, particles.volume, law);
        forces.resize(particles.x.size());
        drift.resize(particles.x.size());
    }
    void step(double dt) {
        points.compute_forces(particles, forces);
        points.move(particles, dt, drift);
        for (std::size_t p = 0; p < drift.size(); ++p) particles.x[p] += dt * drift[p];
    }
    /// Velocities A (x - centre).
    void set_gradient(const Mat<Dim>& A) {
        for (std::size_t p = 0; p < drift.size(); ++p)
            particles.v[p] = A * (particles.x[p] - Vec<Dim>::Constant(30.17 * grid.h()));
    }
    Shape<Dim> shape;
    CartesianGrid<Dim> grid;
    MaterialPoints<Dim> points;
    Particles<Dim> particles;
    std::vector<Vec<Dim>> forces, drift;
};

}  // namespace quern::test
