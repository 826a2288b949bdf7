// The impulse map of a slot, its adjoint and its inverse mass.
#include "contact/slot_field.hpp"
#include "tests/contact/scenes.hpp"

namespace quern::test {

namespace {

/// visit(nodes, slot, mass) for every slot of a pair of touching grains.
template <int Dim, class Visit>
void for_each_slot(Visit&& visit) {
    for (const Filling<Dim>& filling : fillings<Dim>())
        for (const double weight : {1.0, 0.1}) {
            CAPTURE(Dim);
            CAPTURE(filling.name);
            CAPTURE(weight);
            World<Dim> world = make_pair_of_grains<Dim>(filling.shape, aims<Dim>(1)[0], 0.0, 1.0);
            ContactNodeOptions options;
            options.weights.interior_weight = weight;
            ContactNodes<Dim> nodes(world.grid, options);
            fill_all(nodes, world.scene());
            REQUIRE(nodes.slots().size() > 4);
            for (const Slot<Dim>& slot : nodes.slots()) visit(slot, world);
        }
}

/// Levers that reach a cell to each side.
template <int Dim>
std::vector<Vec<Dim>> levers(double h) {
    std::vector<Vec<Dim>> list;
    for (const Aim<Dim>& aim : aims<Dim>(4)) list.push_back(h * (2.0 * aim.shift - Vec<Dim>::Ones()));
    return list;
}

template <int Dim>
void check_inverse_mass() {
    double worst = 0.0, rigid = -1.0;
    for_each_slot<Dim>([&](const Slot<Dim>& slot, const World<Dim>& world) {
        std::vector<Vec<Dim>> v(world.particles.x.size());
        ParticleField<Dim> field{v};
        for (const Vec<Dim>& r : levers<Dim>(world.grid.h())) {
            const Mat<Dim> W = inverse_mass<Dim>(slot, r, true);
            const Mat<Dim> lumped = inverse_mass<Dim>(slot, r, false);
            for (int a = 0; a < Dim; ++a) {
                std::fill(v.begin(), v.end(), Vec<Dim>::Zero());
                field.add_impulse(slot, r, Vec<Dim>::Unit(a));
                const Vec<Dim> u = field.velocity(slot, r);
                worst = std::max(worst, (u - W.col(a)).norm() / u.norm());
            }
            // Weights are at most one: the patch gives way less than the rigid body of its weighted mass.
            rigid = std::max(rigid, (W.trace() - lumped.trace()) / lumped.trace());
        }
    });
    CHECK(worst < 1e-13);  // measured 8.6e-16, bound 1e-13
    CHECK(rigid < 0.0);
}

template <int Dim>
void check_adjoint() {
    double power = 0.0, linear = 0.0, angular = 0.0;
    for_each_slot<Dim>([&](const Slot<Dim>& slot, const World<Dim>& world) {
        std::vector<Vec<Dim>> v = world.particles.v;
        for (std::size_t p = 0; p < v.size(); ++p)
            v[p] += world.particles.x[p].reverse().cwiseProduct(world.particles.x[p]);
        std::vector<Vec<Dim>> dv(v.size(), Vec<Dim>::Zero());
        const ParticleField<Dim> field{v};
        ParticleField<Dim> change{dv};
        for (const Vec<Dim>& r : levers<Dim>(world.grid.h())) {
            const Vec<Dim> J = r.reverse() / world.grid.h();
            std::fill(dv.begin(), dv.end(), Vec<Dim>::Zero());
            change.add_impulse(slot, r, J);
            double received = 0.0;
            Vec<Dim> P = Vec<Dim>::Zero();
            Spin<Dim> L = Spin<Dim>::Zero();  // about the patch
            for (int k = 0; k < slot.n_support; ++k) {
                const Support<Dim>& e = slot.support[k];
                const Vec<Dim> p = world.particles.mass[e.particle] * dv[e.particle];
                received += v[e.particle].dot(p);
                P += p;
                L += moment(Vec<Dim>(e.d - slot.xb), p);
            }
            power = std::max(power, std::abs(received - field.velocity(slot, r).dot(J)) / J.norm());
            linear = std::max(linear, (P - J).norm() / J.norm());
            if (slot.rotates)
                angular = std::max(angular, (L - moment(r, J)).norm() / (world.grid.h() * J.norm()));
        }
    });
    CHECK(power < 1e-12);    // measured 1.8e-14, bound 1e-12
    CHECK(linear < 1e-13);   // measured 4.6e-15, bound 1e-13
    CHECK(angular < 1e-13);  // measured 7.4e-16, bound 1e-13
}

template <int Dim>
void check_rigid_motion() {
    double worst = 0.0;
    for_each_slot<Dim>([&](const Slot<Dim>& slot, const World<Dim>& world) {
        if (!slot.rotates) return;
        const Vec<Dim> V = Vec<Dim>::LinSpaced(Dim, 1.0, 2.0);
        const Spin<Dim> omega = Spin<Dim>::LinSpaced(n_spin<Dim>, 3.0, -1.0);
        const Vec<Dim> centre = world.grid.node_position(slot.index) + slot.xb;
        std::vector<Vec<Dim>> v;
        for (const Vec<Dim>& x : world.particles.x) v.push_back(V + cross(omega, Vec<Dim>(x - centre)));
        const ParticleField<Dim> field{v};
        for (const Vec<Dim>& r : levers<Dim>(world.grid.h()))
            worst = std::max(worst, (field.velocity(slot, r) - V - cross(omega, r)).norm());
    });
    CHECK(worst < 1e-12);  // measured 1.3e-14, bound 1e-12 [m/s]
}

/// Weights of the support of every slot: N of the linear functions, N^2 in the impulse map, q inside.
template <int Dim>
void check_weights() {
    for (const Filling<Dim>& filling : fillings<Dim>())
        for (const bool nodal : {false, true}) {
            World<Dim> world = make_pair_of_grains<Dim>(filling.shape, aims<Dim>(1)[0], 0.0, 1.0);
            ContactNodeOptions options;
            options.weights.nodal = nodal;
            options.weights.interior_weight = 0.3;
            ContactNodes<Dim> nodes(world.grid, options);
            fill_all(nodes, world.scene());
            double worst = 0.0;
            int at_surface = 0, inside = 0;
            for (const Slot<Dim>& slot : nodes.slots())
                for (int k = 0; k < slot.n_support; ++k) {
                    const Support<Dim>& e = slot.support[k];
                    const double N = (Vec<Dim>::Ones() - e.d.cwiseAbs() / world.grid.h()).prod();
                    const double w = nodal ? N : (e.surface >= 0 ? N * N : 0.3 * N * N);
                    worst = std::max({worst, std::abs(e.N - N), std::abs(e.w - w)});
                    ++(e.surface >= 0 ? at_surface : inside);
                }
            CHECK(worst < 1e-13);  // measured 1.8e-15, bound 1e-13
            CHECK(at_surface > 10);
            CHECK(inside > 10);
        }
}

}  // namespace

TEST_CASE("Impulse map: weights of particles at the surface and inside") {
    check_weights<2>();
    check_weights<3>();
}

TEST_CASE("Impulse map: the inverse mass is what an impulse does to the velocity") {
    check_inverse_mass<2>();
    check_inverse_mass<3>();
}

TEST_CASE("Impulse map: velocity is its adjoint; momentum and moment arrive whole") {
    check_adjoint<2>();
    check_adjoint<3>();
}

TEST_CASE("Impulse map: rigid motion is seen exactly at any lever") {
    check_rigid_motion<2>();
    check_rigid_motion<3>();
}

}  // namespace quern::test
