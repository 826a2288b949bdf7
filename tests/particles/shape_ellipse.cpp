// Ellipse: nearest point, normal, curvature, cut areas, and lattices of it.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "particles/shape_builders.hpp"
#include "particles/shape_checks.hpp"
#include "particles/solids.hpp"

using namespace quern;

namespace {

constexpr double pi = std::numbers::pi;

}  // namespace

TEST_CASE("Ellipse: nearest point, normal and curvature off its outline") {
    for (const auto& [a, b] : {std::pair{2.0, 1.0}, std::pair{0.7, 3.1}, std::pair{1.0, 1.0}}) {
        const Ellipse ellipse(a, b);
        double worst = 0.0;
        for (int i = 0; i < 100; ++i) {
            const double angle = 0.0631 * i, c = std::cos(angle), s = std::sin(angle);
            const Vec<2> q(a * c, b * s), n = Vec<2>(b * c, a * s).normalized();
            const double kappa = a * b / std::pow(a * a * s * s + b * b * c * c, 1.5);
            // Inward at most to the centre of curvature of the sharpest end.
            const double deep = 0.9 * std::min(a, b) * std::min(a, b) / std::max(a, b);
            for (const double depth : {-0.8, 0.3 * deep, deep}) {
                const SurfaceView<2> view = ellipse.view(q - depth * n);
                worst = std::max({worst, (view.point - q).norm(), (view.normal - n).norm(),
                                  std::abs(view.distance - depth), std::abs(view.kappa / kappa - 1.0)});
            }
        }
        CHECK(worst < 1e-13);  // measured 8e-15, bound 1e-13
    }
}

TEST_CASE("Ellipse: at its centre and on its axes the nearest end of the shorter one") {
    const Ellipse wide(2.0, 1.0), tall(1.0, 2.0);
    CHECK(wide.view(Vec<2>(0.0, 0.0)).distance == doctest::Approx(1.0));
    CHECK(tall.view(Vec<2>(0.0, 0.0)).distance == doctest::Approx(1.0));
    CHECK(tall.view(Vec<2>(0.0, 0.0)).normal[0] == doctest::Approx(1.0));
    CHECK(wide.view(Vec<2>(1.9, 0.0)).point[0] == doctest::Approx(2.0));
    CHECK(wide.view(Vec<2>(1.9, 0.0)).kappa == doctest::Approx(2.0));   // a/b^2
    CHECK(wide.view(Vec<2>(0.0, 0.9)).kappa == doctest::Approx(0.25));  // b/a^2
    CHECK(wide.view(Vec<2>(-3.0, 0.0)).distance == doctest::Approx(-1.0));
}

TEST_CASE("Ellipse: cells cut it into parts that sum to its area") {
    const Ellipse ellipse(1.3, 0.4);
    double sum = 0.0;
    constexpr int n = 23;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Vec<2> lo(-1.5 + 3.0 * i / n, -0.5 + 1.0 * j / n), edge(3.0 / n, 1.0 / n);
            sum += ellipse.overlap(lo, lo + edge);
        }
    CHECK(sum == doctest::Approx(ellipse.measure()).epsilon(1e-13));
    CHECK(ellipse.overlap(Vec<2>(0.0, 0.0), Vec<2>(9.0, 9.0)) == doctest::Approx(0.25 * pi * 0.52));
}

TEST_CASE("make_lattice_shape: an ellipse has its area, its moments and a closed surface") {
    const Ellipse ellipse(1.0, 0.5);
    const double spacing = 0.05;
    const Shape<2> shape = make_lattice_shape<2>(ellipse, Vec<2>(Vec<2>::Constant(spacing)));
    CHECK(total_volume(shape) == doctest::Approx(0.5 * pi).epsilon(1e-13));
    CHECK(first_moment(shape).norm() < 1e-14);
    const Mat<2> second = second_moment(shape);
    CHECK(second(0, 0) == doctest::Approx(pi / 8.0).epsilon(0.01));   // pi a^3 b/4
    CHECK(second(1, 1) == doctest::Approx(pi / 32.0).epsilon(0.02));  // pi a b^3/4
    CHECK(largest_surface_gap(shape, shape.outline) < 1.5 * spacing);
    CHECK(shape.radius == doctest::Approx(1.0));
    CHECK_FALSE(shape.cornered);
    for (const SurfacePoint<2>& point : shape.surface) {
        CHECK(point.delta >= 0.0);
        CHECK(point.delta < spacing);
        const Vec<2> on = shape.X[point.node] + point.delta * point.nu;
        CHECK(on.cwiseQuotient(Vec<2>(1.0, 0.5)).norm() == doctest::Approx(1.0).epsilon(1e-12));
    }
}
