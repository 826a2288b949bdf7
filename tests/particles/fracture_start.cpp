// What a body begins with: cracks, bonds that never break, strength that scatters.
#include <random>

#include "particles/crack.hpp"
#include "particles/weibull.hpp"
#include "tests/particles/force_cases.hpp"

namespace quern::test {

TEST_CASE("Crack: cuts the bonds that cross its segment, and those alone") {
    const Crack<2> crack{{1.0, 1.0}, {Vec<2>(2.0, 0.0)}};
    CHECK(crack.size() == doctest::Approx(2.0));
    CHECK(crack.cuts({2.0, 0.5}, {2.0, 1.5}));
    CHECK(crack.cuts({2.0, 1.5}, {2.0, 0.5}));
    CHECK(crack.cuts({0.5, 0.4}, {2.0, 1.5}));        // on the line at x = 1.32
    CHECK_FALSE(crack.cuts({0.5, 0.5}, {1.4, 1.5}));  // passes the tip at x = 0.95
    CHECK_FALSE(crack.cuts({2.0, 1.1}, {2.0, 1.5}));
    CHECK_FALSE(crack.cuts({3.5, 0.5}, {3.5, 1.5}));
    // Points on the line are above it, whatever their last bits; the ends belong to the crack.
    for (const double bit : {-1e-16, 0.0, 1e-16}) {
        CHECK(crack.cuts({2.0, 1.0 + bit}, {2.0, 0.5}));
        CHECK_FALSE(crack.cuts({2.0, 1.0 + bit}, {2.0, 1.5}));
        CHECK(crack.cuts({3.0 + bit, 0.5}, {3.0 + bit, 1.5}));
    }
}

TEST_CASE("Crack: in space a parallelogram, skew edges included") {
    const Crack<3> crack{{0.0, 0.0, 0.0}, {Vec<3>(1.0, 0.0, 0.0), Vec<3>(1.0, 2.0, 0.0)}};
    CHECK(crack.size() == doctest::Approx(2.0));
    CHECK(crack.cuts({1.0, 1.0, -0.1}, {1.0, 1.0, 0.1}));
    CHECK(crack.cuts({1.4, 1.0, 0.1}, {1.4, 1.0, -0.1}));
    CHECK_FALSE(crack.cuts({0.4, 1.0, -0.1}, {0.4, 1.0, 0.1}));
    CHECK_FALSE(crack.cuts({1.6, 1.0, -0.1}, {1.6, 1.0, 0.1}));
    CHECK_FALSE(crack.cuts({1.0, 2.1, -0.1}, {1.0, 2.1, 0.1}));
    CHECK_FALSE(crack.cuts({1.0, 1.0, 0.1}, {1.0, 1.0, 0.2}));
}

TEST_CASE("Crack: moves with the body") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    const Mat<3> R = make_rotation<3>(0.8);
    const Vec<3> shift(3.0, -2.0, 1.0);
    int n_cut = 0;
    for (int trial = 0; trial < 2000; ++trial) {
        const auto point = [&] { return Vec<3>(any(random), any(random), any(random)); };
        const Crack<3> crack{point(), {point(), point()}};
        const Crack<3> turned{R * crack.corner + shift,
                              {Vec<3>(R * crack.edge[0]), Vec<3>(R * crack.edge[1])}};
        const Vec<3> a = point(), b = point();
        const bool cut = crack.cuts(a, b);
        n_cut += cut ? 1 : 0;
        CHECK(turned.cuts(R * a + shift, R * b + shift) == cut);
        CHECK(crack.cuts(b, a) == cut);
    }
    CHECK(n_cut > 50);
}

TEST_CASE("Weibull: mean, spread and median of the law, the same numbers everywhere, any order") {
    for (const double m : {1.0, 3.0, 10.0}) {
        CAPTURE(m);
        const int n = 40000;
        double sum = 0.0, squares = 0.0;
        int below = 0;
        const double median = std::pow(std::log(2.0), 1.0 / m) / std::tgamma(1.0 + 1.0 / m);
        for (int grain = 0; grain < n; ++grain) {
            const double f = weibull_factor(m, 3, grain);
            sum += f;
            squares += f * f;
            below += f < median ? 1 : 0;
        }
        const double mean = sum / n, variance = squares / n - mean * mean;
        const double gamma = std::tgamma(1.0 + 1.0 / m);
        const double expected = std::tgamma(1.0 + 2.0 / m) / (gamma * gamma) - 1.0;
        CHECK(std::abs(mean - 1.0) < 4.0 * std::sqrt(expected / n));  // measured 0.7 of sqrt(..), bound 4
        CHECK(std::abs(variance / expected - 1.0) < 0.05);            // measured 0.014, bound 0.05
        CHECK(std::abs(below / (0.5 * n) - 1.0) < 0.02);              // measured 0.004, bound 0.02
    }
    CHECK(weibull_factor(5.0, 1, 7) != weibull_factor(5.0, 2, 7));
    CHECK(weibull_factor(5.0, 1, 7) != weibull_factor(5.0, 1, 8));
    CHECK(weibull_factor(5.0, 1, 7) == doctest::Approx(1.1850615980730332).epsilon(1e-14));
}

TEST_CASE("Bonds that never break stay whatever happens, and count in no relative stretch") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, Material material) {
        material.critical_stretch = 0.01;
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        const std::size_t n = static_cast<std::size_t>(count_bonds(model));
        std::vector<std::uint8_t> alive(n, 1), kept(n);
        for (std::size_t b = 0; b < n; ++b) kept[b] = b % 3 == 0;
        Field<Dim> x;
        for (const Vec<Dim>& X : shape.X) x.push_back(2.0 * X);
        GrainView<Dim> view{1.0, x, {}, alive, {}, kept};
        std::visit([&](const auto& law) { law.break_bonds(view, alive); }, model);
        CHECK(alive == kept);
        std::vector<double> Z(x.size());
        view.kept = BondBits(alive);
        std::fill(alive.begin(), alive.end(), std::uint8_t{1});
        std::visit([&](const auto& law) { law.compute_relative_stretch(view, Z); }, model);
        CHECK(*std::max_element(Z.begin(), Z.end()) == 0.0);
    });
}

TEST_CASE("Strength: a grain breaks at its factor times the critical stretch") {
    Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
    material.critical_stretch = 0.01;
    const Shape<2> shape = make_test_shape<2>();
    const auto model = make_model(shape, material);
    for (const double strength : {0.5, 1.0, 2.5}) {
        std::vector<std::uint8_t> alive(static_cast<std::size_t>(count_bonds(model)), 1);
        for (const double part : {1.0 - 1e-9, 1.0 + 1e-9}) {
            Field<2> x;
            for (const Vec<2>& X : shape.X) x.push_back((1.0 + 0.01 * strength * part) * X);
            const GrainView<2> view{1.0, x, {}, alive, {}, {}, strength};
            const int n = std::visit([&](const auto& law) { return law.break_bonds(view, alive); }, model);
            CHECK(n == (part < 1.0 ? 0 : count_bonds(model)));
        }
    }
}

TEST_CASE("Damage: what cracks of the start cut is none, and no part of the family") {
    Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
    material.critical_stretch = 0.01;
    const Shape<2> shape = make_lattice<2>({8, 8}, 0.01);
    const Lps<2> model(shape, material);
    std::vector<std::uint8_t> whole = make_broken(model.n_bonds()), alive = whole;
    std::vector<double> damage(shape.X.size());
    model.compute_damage({1.0, shape.X, {}, alive, whole}, damage);
    CHECK(*std::max_element(damage.begin(), damage.end()) == 0.0);
    alive.assign(alive.size(), 0);
    model.compute_damage({1.0, shape.X, {}, alive, whole}, damage);
    CHECK(*std::min_element(damage.begin(), damage.end()) == 1.0);
    whole.assign(whole.size(), 0);  // a node without any bond has nothing to lose
    model.compute_damage({1.0, shape.X, {}, alive, whole}, damage);
    CHECK(*std::max_element(damage.begin(), damage.end()) == 0.0);
}

}  // namespace quern::test
