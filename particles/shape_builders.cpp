#include "particles/shape_builders.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace quern {
namespace {

using std::numbers::pi;

/// Cells of a lattice over the bounding box of a solid, with one more layer all around.
template <int Dim>
struct Lattice {
    Vec<Dim> origin;  ///< centre of cell (0, 0, 0)
    Vec<Dim> spacing;
    IntVec<Dim> n;
    std::vector<int> node;  ///< [cell] its node, -1 when the centre is outside

    Lattice(const Vec<Dim>& low, const Vec<Dim>& high, const Vec<Dim>& edge) : spacing(edge) {
        std::size_t n_cells = 1;
        for (int a = 0; a < Dim; ++a) {
            n[a] = std::max(1, static_cast<int>(std::lround((high[a] - low[a]) / spacing[a]))) + 2;
            origin[a] = 0.5 * (low[a] + high[a]) - 0.5 * (n[a] - 1) * spacing[a];
            n_cells *= static_cast<std::size_t>(n[a]);
        }
        node.assign(n_cells, -1);
    }

    int n_cells() const { return static_cast<int>(node.size()); }

    IntVec<Dim> index(int cell) const {
        IntVec<Dim> i;
        for (int a = 0; a < Dim; ++a) {
            i[a] = cell % n[a];
            cell /= n[a];
        }
        return i;
    }

    Vec<Dim> centre(int cell) const {
        return origin + index(cell).template cast<double>().cwiseProduct(spacing);
    }

    /// Node of a cell; -1 outside the lattice too.
    int node_at(const IntVec<Dim>& i) const {
        int cell = 0;
        for (int a = Dim - 1; a >= 0; --a) {
            if (i[a] < 0 || i[a] >= n[a]) return -1;
            cell = cell * n[a] + i[a];
        }
        return node[cell];
    }

    /// Calls f(node) for the nodes of the cells across the faces of a cell.
    template <class F>
    void for_face_neighbours(const IntVec<Dim>& i, F f) const {
        for (int a = 0; a < Dim; ++a)
            for (int step = -1; step <= 1; step += 2) {
                IntVec<Dim> j = i;
                j[a] += step;
                f(node_at(j));
            }
    }

    /// Calls f(node) for the nodes of all cells around a cell.
    template <class F>
    void for_all_neighbours(const IntVec<Dim>& i, F f) const {
        constexpr int n_around = Dim == 2 ? 9 : 27;
        for (int k = 0; k < n_around; ++k) {
            IntVec<Dim> j = i;
            for (int a = 0, rest = k; a < Dim; ++a, rest /= 3) j[a] += rest % 3 - 1;
            f(node_at(j));
        }
    }
};

template <int Dim>
int nearest_node(const std::vector<Vec<Dim>>& X, const Vec<Dim>& x) {
    int nearest = 0;
    for (int i = 1; i < static_cast<int>(X.size()); ++i)
        if ((X[i] - x).squaredNorm() < (X[nearest] - x).squaredNorm()) nearest = i;
    return nearest;
}

/// The nodes that inherit the solid's part of a cell without a node.
template <int Dim>
std::vector<int> find_heirs(const Lattice<Dim>& lattice, int cell, const std::vector<Vec<Dim>>& X) {
    std::vector<int> heirs;
    const auto keep = [&heirs](int node) {
        if (node >= 0) heirs.push_back(node);
    };
    const IntVec<Dim> i = lattice.index(cell);
    lattice.for_face_neighbours(i, keep);
    if (heirs.empty()) lattice.for_all_neighbours(i, keep);
    if (heirs.empty()) heirs.push_back(nearest_node<Dim>(X, lattice.centre(cell)));
    return heirs;
}

/// Spreads n points over the unit sphere, mean zero and second moment 1/3 to round-off.
std::vector<Vec<3>> spread_on_sphere(int n, const Mat<3>& turn) {
    std::vector<Vec<3>> points(n);
    const double golden_angle = pi * (3.0 - std::sqrt(5.0));
    for (int i = 0; i < n; ++i) {
        const double z = 1.0 - (2.0 * i + 1.0) / n, r = std::sqrt(1.0 - z * z), phi = golden_angle * i;
        points[i] = turn * Vec<3>(r * std::cos(phi), r * std::sin(phi), z);
    }
    constexpr int max_passes = 500;
    for (int pass = 0; pass < max_passes; ++pass) {
        Vec<3> mean = Vec<3>::Zero();
        for (const Vec<3>& p : points) mean += p / n;
        Mat<3> second = Mat<3>::Zero();
        for (const Vec<3>& p : points) second += (p - mean) * (p - mean).transpose() * (3.0 / n);
        if (mean.norm() < 1e-15 && (second - Mat<3>::Identity()).norm() < 1e-15 * n) break;
        const Eigen::LLT<Mat<3>> factor(second);
        for (Vec<3>& p : points) p = Vec<3>(factor.matrixL().solve(Vec<3>(p - mean))).normalized();
    }
    return points;
}

}  // namespace

template <int Dim>
void move_to_centre_of_mass(Shape<Dim>& shape) {
    double total = 0.0;
    for (const double v : shape.volume) total += v;
    // The second pass removes the round-off of the first.
    for (int pass = 0; pass < 2; ++pass) {
        Vec<Dim> centre = Vec<Dim>::Zero();
        for (int i = 0; i < shape.n_nodes(); ++i) centre += shape.volume[i] / total * shape.X[i];
        for (Vec<Dim>& x : shape.X) x -= centre;
        for (Vec<Dim>& x : shape.outline) x -= centre;
    }
    shape.dx = std::pow(total / shape.n_nodes(), 1.0 / Dim);
}

template <int Dim, class Solid>
Shape<Dim> make_lattice_shape(const Solid& solid, const Vec<Dim>& spacing) {
    Shape<Dim> shape;
    Lattice<Dim> lattice(solid.low(), solid.high(), spacing);
    const double reach = 0.5 * spacing.norm(), cell_volume = spacing.prod();
    // A centre on the surface up to round-off is outside.
    const double inside = 1e-9 * spacing.minCoeff();

    std::vector<int> cut_outside;
    for (int cell = 0; cell < lattice.n_cells(); ++cell) {
        const Vec<Dim> x = lattice.centre(cell);
        const double distance = solid.distance(x);
        if (distance > inside) {
            lattice.node[cell] = shape.n_nodes();
            shape.X.push_back(x);
            shape.cell.push_back(lattice.index(cell) - lattice.n / 2);
            shape.volume.push_back(distance >= reach ? cell_volume
                                                     : solid.overlap(x - 0.5 * spacing, x + 0.5 * spacing));
        } else if (distance > -reach) {
            cut_outside.push_back(cell);
        }
    }
    if (shape.X.empty()) return shape;

    for (const int cell : cut_outside) {
        const Vec<Dim> x = lattice.centre(cell);
        const double part = solid.overlap(x - 0.5 * spacing, x + 0.5 * spacing);
        if (part == 0.0) continue;
        const std::vector<int> heirs = find_heirs<Dim>(lattice, cell, shape.X);
        for (const int node : heirs) shape.volume[node] += part / static_cast<double>(heirs.size());
    }
    double total = 0.0;
    for (const double v : shape.volume) total += v;
    for (double& v : shape.volume) v *= solid.measure() / total;

    for (int cell = 0; cell < lattice.n_cells(); ++cell) {
        const int node = lattice.node[cell];
        if (node < 0) continue;
        bool at_surface = false;
        lattice.for_face_neighbours(lattice.index(cell),
                                    [&](int other) { at_surface = at_surface || other < 0; });
        if (!at_surface) continue;
        const SurfaceView<Dim> view = solid.view(shape.X[node]);
        shape.surface.push_back({node, view.normal, view.distance, view.kappa});
    }
    shape.cornered = solid.cornered();
    shape.outline = solid.outline();
    const Vec<Dim> before = shape.X[0];
    move_to_centre_of_mass(shape);
    shape.radius = solid.radius_about(before - shape.X[0]);
    return shape;
}

Shape<2> make_rings_shape(double radius, int n) {
    Shape<2> shape;
    const double spacing = radius / n, golden_angle = pi * (3.0 - std::sqrt(5.0));
    for (int k = 1; k <= n; ++k) {
        const double r = (k - 0.5) * spacing;
        const int n_ring = static_cast<int>(std::lround(2.0 * pi * (k - 0.5)));
        for (int i = 0; i < n_ring; ++i) {
            const double angle = golden_angle * k + 2.0 * pi * i / n_ring;
            const Vec<2> direction(std::cos(angle), std::sin(angle));
            if (k == n) shape.surface.push_back({shape.n_nodes(), direction, 0.5 * spacing, 1.0 / radius});
            shape.X.push_back(r * direction);
            shape.volume.push_back(pi * spacing * spacing * (2 * k - 1) / n_ring);
        }
    }
    shape.outline = Ball<2>(radius).outline();
    move_to_centre_of_mass(shape);
    shape.radius = radius;
    return shape;
}

Shape<3> make_shells_shape(double radius, int n) {
    Shape<3> shape;
    const double spacing = radius / n, golden_angle = pi * (3.0 - std::sqrt(5.0));
    for (int k = 1; k <= n; ++k) {
        const double r = (k - 0.5) * spacing, cells = 4.0 / 3.0 * pi * (3.0 * k * k - 3.0 * k + 1.0);
        const int n_shell = static_cast<int>(std::lround(cells));
        const Vec<3> axis(std::cos(golden_angle * k), std::sin(golden_angle * k), 0.0);
        for (const Vec<3>& direction : spread_on_sphere(n_shell, rotation_matrix(Spin<3>(2.0 * k * axis)))) {
            if (k == n) shape.surface.push_back({shape.n_nodes(), direction, 0.5 * spacing, 1.0 / radius});
            shape.X.push_back(r * direction);
            shape.volume.push_back(cells * spacing * spacing * spacing / n_shell);
        }
    }
    move_to_centre_of_mass(shape);
    shape.radius = radius;
    return shape;
}

template void move_to_centre_of_mass(Shape<2>&);
template void move_to_centre_of_mass(Shape<3>&);
template Shape<2> make_lattice_shape(const Ball<2>&, const Vec<2>&);
template Shape<2> make_lattice_shape(const Ellipse&, const Vec<2>&);
template Shape<2> make_lattice_shape(const Polygon&, const Vec<2>&);
template Shape<3> make_lattice_shape(const Ball<3>&, const Vec<3>&);
template Shape<3> make_lattice_shape(const Cuboid&, const Vec<3>&);

}  // namespace quern
