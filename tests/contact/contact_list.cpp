// The list of contacts against what the grains and walls have received.
#include "contact/contact_list.hpp"

#include "tests/contact/node_pairs.hpp"

namespace quern::test {

namespace {

/// Sums of a list over grains and walls, against a report; relative to the sum of the sizes.
template <int Dim>
double worst_difference(const std::vector<ContactPoint<Dim>>& points, const ContactReport<Dim>& report) {
    std::vector<Vec<Dim>> grains(report.grain_impulse.size(), Vec<Dim>::Zero());
    std::vector<Vec<Dim>> walls(report.wall_impulse.size(), Vec<Dim>::Zero());
    std::vector<Spin<Dim>> moments(walls.size(), Spin<Dim>::Zero());
    double scale = 1e-300;
    for (const ContactPoint<Dim>& point : points) {
        scale += point.impulse.norm();
        grains[point.first] -= point.impulse;
        if (point.second >= 0) {
            grains[point.second] += point.impulse;
        } else {
            walls[-1 - point.second] += point.impulse;
            moments[-1 - point.second] += moment(point.at_second, point.impulse);
        }
    }
    double worst = std::max(largest_difference(grains, report.grain_impulse),
                            largest_difference(walls, report.wall_impulse));
    for (std::size_t w = 0; w < walls.size(); ++w)
        worst = std::max(worst, (moments[w] - report.wall_moment[w]).norm());
    return worst / scale;
}

/// A pair on an oblique line that also presses on a wall behind the first grain.
template <int Dim>
World<Dim> pair_at_wall(const Shape<Dim>& shape, const Aim<Dim>& aim, double overlap) {
    World<Dim> world = make_pair_of_grains<Dim>(shape, aim, -overlap, 0.5, 0.2);
    Vec<Dim> point = Vec<Dim>::Zero();
    for (int p = 0; p < world.grains[0].count; ++p)
        point += world.particles.mass[p] / world.grains[0].mass * world.particles.x[p];
    world.walls.push_back({point + (radius - overlap) * aim.direction.unitOrthogonal(),
                           -aim.direction.unitOrthogonal(), 0.3 * aim.direction.unitOrthogonal() * -1.0,
                           0.4});
    for (int a = 0; a < 2; ++a)
        for (int b = 0; b < 2; ++b) world.friction.set(a, b, 0.3);
    return world;
}

}  // namespace

TEST_CASE("Contact list: on the grid the contacts of a grain or wall sum to what it has received") {
    double by_pairs = 0.0, seed = 0.0;
    int listed = 0, at_limit = 0;
    for_each_case([&](const Method& method, const auto& filling, const auto& aims) {
        constexpr int Dim = std::decay_t<decltype(filling.shape.X[0])>::RowsAtCompileTime;
        for (const Aim<Dim>& aim : aims) {
            World<Dim> world = pair_at_wall<Dim>(filling.shape, aim, 0.02);
            GridContact<Dim> contact(world.grid, method.options);
            const std::vector<Vec<Dim>> v_before = world.particles.v;
            world.drift.assign(v_before.size(), Vec<Dim>::Zero());
            const ContactReport<Dim> report =
                contact.add_impulses(world.scene(), {world.dt, v_before, world.particles.v, world.drift});
            std::vector<ContactPoint<Dim>> points;
            contact.list_contacts(world.scene(), points);
            listed += static_cast<int>(points.size());
            for (const auto& point : points) {
                CHECK(point.normal.norm() == doctest::Approx(1.0));
                at_limit += point.slips;
            }
            double& worst = method.by_pairs() ? by_pairs : seed;
            worst = std::max(worst, worst_difference<Dim>(points, report));
        }
    });
    CHECK(listed > 1000);
    CHECK(at_limit > 10);
    CHECK(at_limit < listed);
    CHECK(by_pairs < 1e-14);  // measured 7.5e-16, bound 1e-14
    CHECK(seed < 0.1);        // measured 0.044, bound 0.1: what the rule loses of the momentum
}

TEST_CASE("Contact list: between nodes the contacts of a grain or wall sum to what it has received") {
    double worst = 0.0;
    int listed = 0;
    for_each_node_pair_case([&](const NodePairOptions& options, const auto& filling, const auto& aims) {
        constexpr int Dim = std::decay_t<decltype(filling.shape.X[0])>::RowsAtCompileTime;
        for (const Aim<Dim>& aim : aims) {
            World<Dim> world = pair_at_wall<Dim>(filling.shape, aim, 0.02);
            NodePairs<Dim> pairs(world, options);
            pairs.step(true);
            const std::vector<Vec<Dim>> v_before = world.particles.v;
            ContactTrial<Dim> trial{world.dt, v_before, world.particles.v, world.drift};
            trial.listing = true;
            const ContactReport<Dim> report = pairs.contact.add_impulses(world.scene(), trial);
            std::vector<ContactPoint<Dim>> points;
            pairs.contact.list_contacts(world.scene(), points);
            listed += static_cast<int>(points.size());
            ContactReport<Dim> forces = report;
            for (std::size_t w = 0; w < forces.wall_moment.size(); ++w) {
                forces.wall_moment[w].setZero();
                for (const auto& point : points)
                    if (point.second == -1 - static_cast<int>(w))
                        forces.wall_moment[w] += moment(point.at_second, point.impulse);
                // The published law pushes at the node, not on the plane.
                CHECK((forces.wall_moment[w] - report.wall_moment[w]).norm() <=
                      1e-12 + (options.friction_law == PairFriction::published ? 0.05 : 1e-9) *
                                  report.wall_moment[w].norm());
            }
            worst = std::max(worst, worst_difference<Dim>(points, forces));
        }
    });
    CHECK(listed > 500);
    CHECK(worst < 1e-13);  // measured 1.0e-16, bound 1e-13
}

TEST_CASE("Contact list: two nodes that overlap press with k (R - d) on each other") {
    for (const bool periodic : {false, true}) {
        const double volume = 0.01, R = 0.1, distance = 0.09;
        const Shape<2> node = single_node<2>(volume);
        World<2> world(make_grid<2>(0.2, 32, true));
        const double x = periodic ? 0.02 : 3.0;
        world.add(node, {x, 3.0}, {0.0, 0.0});
        world.add(node, {x - distance + (periodic ? 6.4 : 0.0), 3.0}, {0.0, 0.0});
        PairLaw law;
        law.radius = R;
        NodePairs<2> pairs(world, {}, law);
        const std::vector<Vec<2>> v_before = world.particles.v;
        ContactTrial<2> trial{world.dt, v_before, world.particles.v, world.drift};
        trial.listing = true;
        const ContactReport<2> report = pairs.contact.add_impulses(world.scene(), trial);
        std::vector<ContactPoint<2>> points;
        pairs.contact.list_contacts(world.scene(), points);
        REQUIRE(points.size() == 1);
        const std::vector<PairForce<2>> forces = pair_forces<2>(points, world.dt, Vec<2>(6.4, 6.4));
        REQUIRE(forces.size() == 1);
        const PairForce<2>& force = forces[0];
        const double expected = report.elastic * 2.0 / (R - distance);  // k (R - d)^2/2
        CHECK(force.first == 0);
        CHECK(force.second == 1);
        CHECK(force.normal_force == doctest::Approx(expected).epsilon(1e-12));  // measured 1e-15, bound 1e-12
        CHECK(force.normal[0] == doctest::Approx(-1.0));
        CHECK(force.tangential_force.norm() < 1e-12 * expected);
        CHECK(force.at_first[0] == doctest::Approx(x - 0.5 * distance));
        CHECK(force.at_second[0] == doctest::Approx(x - 0.5 * distance + (periodic ? 6.4 : 0.0)));
    }
}

TEST_CASE("Contact list: points of a pair become one resultant, each image of a periodic neighbour its own") {
    const Vec<2> box(4.0, 4.0);
    const auto point = [](int first, int second, Vec<2> at, Vec<2> shift, Vec<2> n, Vec<2> impulse,
                          bool slips) {
        return ContactPoint<2>{first, second, at, at + shift, n, impulse, slips};
    };
    const Vec<2> none(0.0, 0.0), x(1.0, 0.0), y(0.0, 1.0);
    const std::vector<PairForce<2>> pairs =
        pair_forces<2>({point(1, 0, {1.0, 2.0}, none, -x, {-3.0, 1.0}, true),
                        point(0, 1, {1.0, 1.0}, none, x, {1.0, 0.5}, false),
                        point(0, 1, {3.0, 1.0}, {-4.0, 0.0}, x, {2.0, 0.0}, false),
                        point(0, -1, {0.0, 0.5}, none, -y, {0.0, -5.0}, true)},
                       0.5, box);
    REQUIRE(pairs.size() == 3);
    CHECK(pairs[0].first == 0);
    CHECK(pairs[0].second == 1);
    CHECK(pairs[0].n_points == 1);  // the image to the left
    CHECK(pairs[0].normal_force == doctest::Approx(4.0));
    CHECK(pairs[1].n_points == 2);
    CHECK(pairs[1].normal_force == doctest::Approx(8.0));
    CHECK(pairs[1].tangential_force[1] == doctest::Approx(-1.0));
    CHECK(pairs[1].at_first[1] == doctest::Approx(1.75));
    CHECK(pairs[1].slipping == doctest::Approx(0.75));
    CHECK(pairs[2].second == -1);
    CHECK(pairs[2].normal_force == doctest::Approx(10.0));
}

}  // namespace quern::test
