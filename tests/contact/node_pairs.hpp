// Scenes of contact between nodes: the worlds of scenes.hpp with bodies of a rubber.
#pragma once

#include "contact/node_pair_contact.hpp"
#include "tests/contact/scenes.hpp"

namespace quern::test {

inline constexpr double rubber_modulus = 1e7;  ///< [Pa]

/// A horizon of three spacings; the smallest distance of two nodes is taken from the shape.
template <int Dim>
std::vector<PairBody> rubber_bodies(const World<Dim>& world) {
    std::vector<PairBody> bodies;
    for (const Grain<Dim>& grain : world.grains) {
        double least = 1e300;
        for (int i = 0; i < grain.count; ++i)
            for (int j = 0; j < i; ++j)
                least = std::min(least, (grain.shape->X[i] - grain.shape->X[j]).norm());
        const double dx = grain.shape->dx * grain.scale;
        bodies.push_back({rubber_modulus, rubber_modulus, 3.0 * dx, grain.scale * least, 1e3, 0.0});
    }
    return bodies;
}

/// Contact between nodes that lives for more than one step.
template <int Dim>
struct NodePairs {
    NodePairs(World<Dim>& of, const NodePairOptions& options, const PairLaw& law = {})
        : world(of),
          contact(of.grid, of.grains, of.particles.volume, rubber_bodies(of), PairLaws(2, law), options) {}

    /// One contact step; `v_before` are the velocities as they are.
    ContactReport<Dim> push(bool first = false) {
        const std::vector<Vec<Dim>> v_before = world.particles.v;
        ContactTrial<Dim> trial{world.dt, v_before, world.particles.v, world.drift};
        trial.first = first;
        return contact.add_impulses(world.scene(), trial);
    }
    /// A contact step, then the drift: a body without forces inside.
    ContactReport<Dim> step(bool first = false) {
        const ContactReport<Dim> report = push(first);
        for (int p = 0; p < world.particles.size(); ++p)
            world.particles.x[p] += world.dt * world.particles.v[p];
        for (Wall<Dim>& wall : world.walls) wall.point += world.dt * wall.velocity;
        return report;
    }

    World<Dim>& world;
    NodePairContact<Dim> contact;
};

/// One node, alone: the simplest grain there is.
template <int Dim>
Shape<Dim> single_node(double volume) {
    Shape<Dim> shape;
    shape.X = {Vec<Dim>::Zero()};
    shape.volume = {volume};
    shape.dx = std::pow(volume, 1.0 / Dim);
    shape.surface = {{0, Vec<Dim>::Unit(0), 0.5 * shape.dx, 0.0}};
    shape.radius = 0.5 * shape.dx;
    return shape;
}

/// visit(options, filling, aims): every law of friction, plane and space, rings and lattice.
template <class Visit>
void for_each_node_pair_case(Visit&& visit) {
    const auto all = [&]<int Dim>(std::integral_constant<int, Dim>) {
        for (const PairFriction law : {PairFriction::history, PairFriction::slip, PairFriction::published})
            for (const Filling<Dim>& filling : fillings<Dim>()) {
                CAPTURE(Dim);
                CAPTURE(static_cast<int>(law));
                CAPTURE(filling.name);
                NodePairOptions options;
                options.friction_law = law;
                options.damping = PairDamping::nodes;
                visit(options, filling, aims<Dim>(Dim == 2 ? 12 : 4));
            }
    };
    all(std::integral_constant<int, 2>{});
    all(std::integral_constant<int, 3>{});
}

}  // namespace quern::test
