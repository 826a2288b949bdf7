// Small scenes for the tests of contact: round grains placed by hand, no forces, one contact step; and the
// table of all contact methods.
#pragma once

#include <doctest/doctest.h>

#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "contact/grid_contact.hpp"
#include "particles/shape_builders.hpp"

namespace quern::test {

template <int Dim>
struct Placement {
    Spin<Dim> angle = Spin<Dim>::Zero();  ///< [rad]
    Spin<Dim> spin = Spin<Dim>::Zero();   ///< [rad/s]
    double scale = 1.0;
    double density = 1000.0;
    int material = 0;
};

/// Finds nodes and fills the slots of all of them.
template <int Dim>
void fill_all(ContactNodes<Dim>& nodes, const ContactScene<Dim>& scene) {
    nodes.find(scene, 0.0);
    nodes.choose_all();
    nodes.fill(scene);
}

/// Grains, walls and a grid: everything that a contact step needs.
template <int Dim>
struct World {
    explicit World(const CartesianGrid<Dim>& background) : grid(background) {}

    void add(const Shape<Dim>& shape, const Vec<Dim>& centre, const Vec<Dim>& velocity,
             const Placement<Dim>& placement = {}) {
        Grain<Dim> grain;
        grain.shape = &shape;
        grain.scale = placement.scale;
        grain.first = particles.size();
        grain.count = shape.n_nodes();
        grain.material = placement.material;
        grain.id = static_cast<int>(grains.size());
        const Mat<Dim> R = rotation_matrix(placement.angle);
        for (int i = 0; i < shape.n_nodes(); ++i) {
            const Vec<Dim> r = placement.scale * (R * shape.X[i]);
            const double volume = std::pow(placement.scale, Dim) * shape.volume[i];
            particles.x.push_back(centre + r);
            particles.v.push_back(velocity + cross(placement.spin, r));
            particles.volume.push_back(volume);
            particles.mass.push_back(placement.density * volume);
            grain.volume += volume;
            grain.mass += placement.density * volume;
        }
        grains.push_back(grain);
    }

    ContactScene<Dim> scene() const {
        return {grains, particles.x, particles.mass, particles.volume, walls, &friction};
    }

    /// One contact step; velocities change, positions do not.
    ContactReport<Dim> collide(const GridContactOptions& options) {
        GridContact<Dim> contact(grid, options);
        const std::vector<Vec<Dim>> v_before = particles.v;
        drift.assign(v_before.size(), Vec<Dim>::Zero());
        return contact.add_impulses(scene(), {dt, v_before, particles.v, drift});
    }

    Vec<Dim> momentum() const {
        Vec<Dim> P = Vec<Dim>::Zero();
        for (int p = 0; p < particles.size(); ++p) P += particles.mass[p] * particles.v[p];
        return P;
    }
    Vec<Dim> momentum(int grain) const {
        Vec<Dim> P = Vec<Dim>::Zero();
        for (int p = grains[grain].first; p < grains[grain].first + grains[grain].count; ++p)
            P += particles.mass[p] * particles.v[p];
        return P;
    }
    Spin<Dim> angular_momentum() const {
        Spin<Dim> L = Spin<Dim>::Zero();
        for (int p = 0; p < particles.size(); ++p)
            L += moment(particles.x[p], Vec<Dim>(particles.mass[p] * particles.v[p]));
        return L;
    }
    /// sum m |v|: what momentum errors are measured against.
    double momentum_scale() const {
        double P = 0.0;
        for (int p = 0; p < particles.size(); ++p) P += particles.mass[p] * particles.v[p].norm();
        return P;
    }
    double kinetic_energy() const {
        double T = 0.0;
        for (int p = 0; p < particles.size(); ++p)
            T += 0.5 * particles.mass[p] * particles.v[p].squaredNorm();
        return T;
    }
    Vec<Dim> mean_velocity(int grain) const { return momentum(grain) / grains[grain].mass; }

    CartesianGrid<Dim> grid;
    double dt = 1e-4;
    std::vector<Grain<Dim>> grains;
    Particles<Dim> particles;
    std::vector<Vec<Dim>> drift;
    std::vector<Wall<Dim>> walls;
    FrictionTable friction{2, 0.0};
};

inline constexpr double radius = 0.5;  ///< of all round grains here [m]

/// Disks and balls of both fillings, six (plane) or four (space) particles a radius.
template <int Dim>
struct Filling {
    std::string name;
    Shape<Dim> shape;
};
template <int Dim>
const std::vector<Filling<Dim>>& fillings() {
    static const std::vector<Filling<Dim>> all = [] {
        constexpr int n = Dim == 2 ? 6 : 4;
        std::vector<Filling<Dim>> list;
        if constexpr (Dim == 2)
            list.push_back({"rings", make_rings_shape(radius, n)});
        else
            list.push_back({"shells", make_shells_shape(radius, n)});
        list.push_back(
            {"lattice", make_lattice_shape<Dim>(Ball<Dim>(radius), Vec<Dim>::Constant(radius / n))});
        return list;
    }();
    return all;
}

template <int Dim>
CartesianGrid<Dim> make_grid(double h, int n_cells = 32, bool periodic_x = false) {
    std::array<bool, Dim> periodic{};
    periodic[0] = periodic_x;
    return CartesianGrid<Dim>(Vec<Dim>::Zero(), h, IntVec<Dim>::Constant(n_cells), periodic);
}

/// A direction and a place of the contact against the grid, in cells; always the same ones.
template <int Dim>
struct Aim {
    Vec<Dim> direction, shift;
};
template <int Dim>
std::vector<Aim<Dim>> aims(int n) {
    std::mt19937 random(11);
    const auto number = [&] { return static_cast<double>(random()) / 4294967296.0; };
    std::vector<Aim<Dim>> list;
    for (int i = 0; i < n; ++i) {
        Aim<Dim> aim;
        do
            for (int a = 0; a < Dim; ++a) aim.direction[a] = 2.0 * number() - 1.0;
        while (aim.direction.norm() > 1.0 || aim.direction.norm() < 0.1);
        aim.direction.normalize();
        for (int a = 0; a < Dim; ++a) aim.shift[a] = number();
        list.push_back(aim);
    }
    return list;
}

/// Two round grains, the second `ratio` as large as the first, on a line, `gap` [m] apart, moving towards
/// each other at `speed` each; positive `slip` moves them along a tangent in opposite directions.
template <int Dim>
World<Dim> make_pair_of_grains(const Shape<Dim>& shape, const Aim<Dim>& aim, double gap, double speed,
                               double slip = 0.0, double ratio = 1.0) {
    const double h = 2.0 * shape.dx;
    World<Dim> world(make_grid<Dim>(h));
    const Vec<Dim> middle = h * (Vec<Dim>::Constant(16.0) + aim.shift);
    Vec<Dim> tangent = Vec<Dim>::Unit(0) - aim.direction[0] * aim.direction;
    if (tangent.norm() < 0.1) tangent = Vec<Dim>::Unit(1) - aim.direction[1] * aim.direction;
    tangent.normalize();
    Placement<Dim> second;
    second.scale = ratio;
    const auto arm = [&](double r) { return Vec<Dim>((r + 0.5 * gap) * aim.direction); };
    world.add(shape, middle - arm(radius), speed * aim.direction + slip * tangent);
    world.add(shape, middle + arm(ratio * radius), -speed * aim.direction - slip * tangent, second);
    return world;
}

/// The table: every rule with every coupling that it has.
struct Method {
    std::string name;
    GridContactOptions options;

    /// Impulses between pairs, along one normal: pair and surface.
    bool by_pairs() const { return options.rule != GridRule::seed; }
    bool flip() const { return options.coupling == GridCoupling::flip; }
    /// Pairs that act at one point.
    bool at_points() const { return by_pairs() && !flip(); }
};
inline std::vector<Method> methods() {
    std::vector<Method> list;
    for (const GridRule rule : {GridRule::pair, GridRule::surface, GridRule::seed})
        for (const GridCoupling coupling : {GridCoupling::impulse, GridCoupling::flip}) {
            if (rule == GridRule::surface && coupling == GridCoupling::flip) continue;  // no nodes to act on
            Method method;
            method.name = rule == GridRule::pair ? "pair" : rule == GridRule::surface ? "surface" : "seed";
            method.name += coupling == GridCoupling::impulse ? " + impulse" : " + flip";
            method.options.rule = rule;
            method.options.exact_walls = rule == GridRule::surface;
            method.options.coupling = coupling;
            list.push_back(method);
        }
    return list;
}

/// visit(method, filling, aim) over the whole table; Dim is that of the filling.
template <int Dim, class Visit>
void for_each_case_of(Visit&& visit) {
    for (const Method& method : methods())
        for (const Filling<Dim>& filling : fillings<Dim>()) {
            CAPTURE(Dim);
            CAPTURE(method.name);
            CAPTURE(filling.name);
            visit(method, filling, aims<Dim>(Dim == 2 ? 12 : 6));
        }
}
template <class Visit>
void for_each_case(Visit&& visit) {
    for_each_case_of<2>(visit);
    for_each_case_of<3>(visit);
}

/// Sweeps until nothing changes: what is left then does not depend on the order of the sweeps.
inline GridContactOptions converged(GridContactOptions options) {
    options.max_sweeps = 5000;
    options.tolerance = 1e-15;
    return options;
}

template <int Dim>
double largest_difference(const std::vector<Vec<Dim>>& a, const std::vector<Vec<Dim>>& b) {
    double most = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) most = std::max(most, (a[i] - b[i]).norm());
    return most;
}

}  // namespace quern::test
