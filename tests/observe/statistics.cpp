// Statistics of contacts and grains against cases that are known in closed form.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "src/observe/bins.hpp"
#include "src/observe/contact_network.hpp"
#include "src/observe/force_distribution.hpp"
#include "src/observe/grain_stress.hpp"

namespace quern::test {

namespace {

constexpr double pi = std::numbers::pi;

double number(std::mt19937& random) {
    return static_cast<double>(random()) / 4294967296.0;
}

/// Contacts of grains at the places of a hexagonal packing of unit diameter, on a periodic box.
struct Hexagons {
    static constexpr int n = 6;
    Vec<2> box = Vec<2>(n, n* std::sqrt(0.75));
    std::vector<Vec<2>> centres;
    std::vector<ContactPoint<2>> points;

    /// `force` presses on every contact [N].
    explicit Hexagons(double force) {
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) centres.push_back(Vec<2>(i + 0.5 * (j % 2), j * std::sqrt(0.75)));
        for (int g = 0; g < n * n; ++g)
            for (const double angle : {0.0, pi / 3.0, 2.0 * pi / 3.0}) {
                const Vec<2> along(std::cos(angle), std::sin(angle));
                ContactPoint<2> point;
                point.first = g;
                point.at_first = centres[static_cast<std::size_t>(g)] + 0.5 * along;
                point.normal = along;
                point.impulse = force * along;
                for (int h = 0; h < n * n; ++h) {
                    Vec<2> off =
                        centres[static_cast<std::size_t>(h)] - centres[static_cast<std::size_t>(g)] - along;
                    const Vec<2> periods(std::round(off[0] / box[0]), std::round(off[1] / box[1]));
                    const Vec<2> shift = periods.cwiseProduct(box);
                    if ((off - shift).norm() > 1e-6) continue;
                    point.second = h;
                    point.at_second = point.at_first + shift;
                }
                points.push_back(point);
            }
    }
};

template <int Dim>
ContactPoint<Dim> turned(const ContactPoint<Dim>& point, const Mat<Dim>& R) {
    ContactPoint<Dim> other = point;
    other.at_first = R * point.at_first;
    other.at_second = R * point.at_second;
    other.normal = R * point.normal;
    other.impulse = R * point.impulse;
    return other;
}

/// Largest difference between the tensors of a random network and those of the turned network, turned back.
template <int Dim>
double turning_error(const Mat<Dim>& R) {
    std::mt19937 random(5);
    std::vector<ContactPoint<Dim>> points, others;
    std::vector<Vec<Dim>> centres(3), other_centres;
    const auto vector = [&] {
        Vec<Dim> v;
        for (int a = 0; a < Dim; ++a) v[a] = number(random) - 0.5;
        return v;
    };
    for (Vec<Dim>& centre : centres) centre = vector();
    for (const Vec<Dim>& centre : centres) other_centres.push_back(R * centre);
    for (int k = 0; k < 12; ++k) {
        const Vec<Dim> at = vector();
        points.push_back({k % 3, k % 2 ? (k + 1) % 3 : -1, at, at, vector().normalized(), vector(), false});
        others.push_back(turned<Dim>(points.back(), R));
    }
    const std::vector<double> volumes = {1.0, 2.0, 0.5};
    const std::vector<Mat<Dim>> a = contact_stress<Dim>(points, 0.1, centres, volumes);
    const std::vector<Mat<Dim>> b = contact_stress<Dim>(others, 0.1, other_centres, volumes);
    double worst = 0.0;
    for (std::size_t g = 0; g < 3; ++g)
        worst = std::max(worst, (R * a[g] * R.transpose() - b[g]).norm() / a[g].norm());
    const Vec<Dim> box = Vec<Dim>::Constant(1e3);
    const Mat<Dim> F = fabric<Dim>(pair_forces<Dim>(points, 0.1, box));
    const Mat<Dim> G = fabric<Dim>(pair_forces<Dim>(others, 0.1, box));
    worst = std::max(worst, (R * F * R.transpose() - G).norm());
    const Principal before = principal(a[0]), after = principal(b[0]);
    return std::max(worst, std::abs(before.difference() / after.difference() - 1.0));
}

}  // namespace

TEST_CASE(
    "Statistics: a hexagonal packing has six contacts a grain, fabric 1/2 and the stress of its forces") {
    const double F = 3.0, dt = 0.01;
    Hexagons packing(F * dt);
    const std::vector<PairForce<2>> pairs = pair_forces<2>(packing.points, dt, packing.box);
    REQUIRE(pairs.size() == packing.points.size());
    const std::vector<std::uint8_t> wall(packing.centres.size(), 0);
    const Coordination found = coordination<2>(pairs, wall);
    for (std::size_t g = 0; g < wall.size(); ++g) {
        CHECK(found.pairs[g] == 6);
        CHECK(found.pairs_held[g] == 6);
    }
    CHECK((fabric<2>(pairs) - 0.5 * Mat<2>::Identity()).norm() < 1e-14);  // measured 7.9e-17, bound 1e-14
    const double V = pi / 4.0;
    const std::vector<double> volumes(wall.size(), V);
    // Six forces F at d/2: sum f r = -F (d/2) (6/2) 1, over V.
    const Mat<2> expected = -1.5 * F / V * Mat<2>::Identity();
    double worst = 0.0;
    for (const Mat<2>& stress : contact_stress<2>(packing.points, dt, packing.centres, volumes))
        worst = std::max(worst, (stress - expected).norm() / expected.norm());
    CHECK(worst < 1e-13);  // measured 3.7e-16, bound 1e-13: also across the periodic faces
}

TEST_CASE("Statistics: rattlers are taken away until none is left") {
    const auto pair = [](int a, int b) {
        PairForce<2> force;
        force.first = a;
        force.second = b;
        return force;
    };
    // A triangle, a chain of two that hangs on it, a grain alone, and one between two walls.
    const std::vector<PairForce<2>> pairs = {pair(0, 1), pair(1, 2),  pair(0, 2), pair(2, 3),
                                             pair(3, 4), pair(6, -1), pair(6, -2)};
    const Coordination found = coordination<2>(pairs, std::vector<std::uint8_t>(7, 0));
    CHECK(found.pairs == std::vector<int>{2, 2, 3, 2, 1, 0, 2});
    CHECK(found.rattler == std::vector<std::uint8_t>{0, 0, 0, 1, 1, 1, 0});
    CHECK(found.pairs_held == std::vector<int>{2, 2, 2, 0, 0, 0, 2});
    // Grain 0 stands for a wall: what touches it touches a wall.
    std::vector<std::uint8_t> wall(7, 0);
    wall[0] = 1;
    CHECK(coordination<2>(pairs, wall).pairs == std::vector<int>{0, 2, 3, 2, 1, 0, 2});
}

TEST_CASE("Statistics: tensors turn with the frame") {
    CHECK(turning_error<2>(rotation_matrix(Spin<2>(0.7))) < 1e-13);  // measured 4.7e-16, bound 1e-13
    CHECK(turning_error<3>(rotation_matrix(Spin<3>(0.7, -0.4, 1.1))) <
          1e-13);  // measured 4.4e-16, bound 1e-13
    Mat<2> tensor;
    tensor << 3.0, 1.0, 1.0, 3.0;
    CHECK(principal(tensor).first == doctest::Approx(4.0));
    CHECK(principal(tensor).last == doctest::Approx(2.0));
    CHECK(principal(tensor).angle == doctest::Approx(pi / 4.0));
}

TEST_CASE("Statistics: an exponential sample gives its slope within its error") {
    for (const double slope : {1.0, 1.4, 3.0}) {
        std::mt19937 random(17);
        std::vector<double> forces;
        // Half at 1 - s, half at 1 + e with e exponential: mean 1 for s = 1/slope, tail exp(-slope f).
        for (int k = 0; k < 20000; ++k) {
            const double e = -std::log(1.0 - number(random)) / slope;
            forces.push_back(7.0 * (1.0 + e));
            forces.push_back(7.0 * (1.0 - std::min(1.0, 1.0 / slope)));
        }
        const ForceDistribution found = force_distribution(forces, 0.25);
        // Over the sample's mean the slope is that of the forces times the mean.
        const double expected = slope * found.mean / 7.0;
        CHECK(std::abs(found.slope - expected) < 3.0 * found.slope_error);  // measured 1.2, bound 3
        CHECK(found.slope_error == doctest::Approx(found.slope / std::sqrt(found.n_tail)));
        double whole = 0.0, mean = 0.0;
        for (std::size_t k = 0; k < found.density.size(); ++k) {
            whole += found.density[k] * found.width;
            mean += found.density[k] * found.width * (static_cast<double>(k) + 0.5) * found.width;
        }
        CHECK(whole == doctest::Approx(1.0).epsilon(1e-12));
        CHECK(mean == doctest::Approx(1.0).epsilon(0.13));  // half a bin
    }
    CHECK(force_distribution({}, 0.25).n_tail == 0);
}

TEST_CASE("Statistics: the part of the grains that carries half of the load") {
    CHECK(part_with_half_the_load({1.0, 1.0, 1.0, 1.0}) == doctest::Approx(0.5));
    CHECK(part_with_half_the_load({0.0, 6.0, 0.0, -5.0}) == doctest::Approx(0.125));
    CHECK(part_with_half_the_load({1.0, 2.0, 5.0, 2.0}) == doctest::Approx(0.25));
    CHECK(part_with_half_the_load({0.0, 0.0}) == 0.0);
}

TEST_CASE("Statistics: slices hold what lies in them") {
    std::vector<SlicePart> parts;
    split({0.0, 1.0, 4, false}, 0.25, 0.2, parts);
    REQUIRE(parts.size() == 2);
    CHECK(parts[0].slice == 0);
    CHECK(parts[0].part == doctest::Approx(0.5));
    CHECK(parts[1].part == doctest::Approx(0.5));
    split({0.0, 1.0, 4, true}, 0.05, 0.2, parts);
    REQUIRE(parts.size() == 2);
    CHECK(parts[0].slice == 3);
    CHECK(parts[0].part == doctest::Approx(0.25));
    split({0.0, 1.0, 4, false}, 0.05, 0.2, parts);
    REQUIRE(parts.size() == 1);
    CHECK(parts[0].part == doctest::Approx(0.75));
    split({0.0, 1.0, 4, false}, 3.0, 0.2, parts);
    CHECK(parts.empty());

    // A disk of R = 1 made of 40 x 40 squares, in ten slices: the area between two chords.
    const double dx = 0.05;
    std::vector<double> area(10, 0.0);
    for (int i = -20; i < 20; ++i)
        for (int j = -20; j < 20; ++j) {
            const double x = (i + 0.5) * dx, y = (j + 0.5) * dx;
            if (x * x + y * y > 1.0) continue;
            split({-1.0, 1.0, 10, false}, x + 0.013, dx, parts);
            for (const SlicePart& part : parts)
                area[static_cast<std::size_t>(part.slice)] += part.part * dx * dx;
        }
    const auto below = [](double x) { return x * std::sqrt(1.0 - x * x) + std::asin(x); };
    double worst = 0.0;
    for (int k = 0; k < 10; ++k) {
        const auto chord = [&](double x) { return below(std::clamp(x - 0.013, -1.0, 1.0)); };
        const double exact = chord(-1.0 + 0.2 * (k + 1)) - chord(-1.0 + 0.2 * k);
        worst = std::max(worst, std::abs(area[static_cast<std::size_t>(k)] - exact) / (0.2 * 2.0));
    }
    CHECK(worst <
          0.03);  // measured 0.0125, bound 0.03: of the area of a slice, mostly the staircase of the disk
}

}  // namespace quern::test
