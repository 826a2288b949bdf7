#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "particles/shape_builders.hpp"
#include "particles/shape_checks.hpp"

using namespace quern;
using std::numbers::pi;

namespace {

/// Smallest and largest distance of a node from its nearest neighbour.
template <int Dim>
std::pair<double, double> neighbour_distances(const std::vector<Vec<Dim>>& X) {
    double least = 1e300, most = 0.0;
    for (std::size_t i = 0; i < X.size(); ++i) {
        double nearest = 1e300;
        for (std::size_t j = 0; j < X.size(); ++j)
            if (j != i) nearest = std::min(nearest, (X[i] - X[j]).norm());
        least = std::min(least, nearest);
        most = std::max(most, nearest);
    }
    return {least, most};
}

}  // namespace

TEST_CASE("Rings: area and inertia have their closed forms") {
    for (const int n : {1, 2, 3, 6, 12, 24, 50}) {
        const double R = 0.7;
        const Shape<2> shape = make_rings_shape(R, n);
        CAPTURE(n);
        CHECK(total_volume(shape) == doctest::Approx(pi * R * R).epsilon(1e-12));
        CHECK(first_moment(shape).norm() < 1e-15);
        const Mat<2> moment = second_moment(shape);
        CHECK(moment.trace() ==
              doctest::Approx(pi * std::pow(R, 4) / 2 * (1 - 0.5 / (n * n))).epsilon(1e-12));
        CHECK(moment(0, 0) == doctest::Approx(moment(1, 1)).epsilon(1e-12));
        CHECK(shape.dx == doctest::Approx(R / n).epsilon(0.03));  // measured 2.3 % (n = 1), 0.04 % (n = 6)
        CHECK(shape.radius == R);
        CHECK(shape.outline.size() == 64);
    }
}

TEST_CASE("Rings: the outer ring is the surface") {
    const int n = 12;
    const Shape<2> shape = make_rings_shape(1.0, n);
    CHECK(shape.surface.size() == 72);  // round(2 pi 11.5)
    for (const SurfacePoint<2>& p : shape.surface) {
        CHECK(p.delta == doctest::Approx(0.5 / n));
        CHECK(shape.X[p.node].norm() == doctest::Approx(1.0 - 0.5 / n).epsilon(1e-14));
        CHECK((p.nu - shape.X[p.node].normalized()).norm() < 1e-13);
        CHECK(p.kappa == 1.0);
    }
    int n_outer = 0;
    for (const Vec<2>& x : shape.X) n_outer += x.norm() > 1.0 - 0.6 / n;
    CHECK(n_outer == 72);
    CHECK(!shape.cornered);
}

TEST_CASE("Rings: nodes keep apart") {
    const auto [least, most] = neighbour_distances<2>(make_rings_shape(12.0, 12).X);
    CHECK(least > 0.84);  // measured 0.866 (the triangle in the middle)
    CHECK(most < 1.06);   // measured 1.026
}

TEST_CASE("Shells: volume and inertia have their closed forms, isotropic") {
    for (const int n : {1, 2, 3, 6, 12}) {
        const double R = 0.7, volume = 4 * pi / 3 * R * R * R;
        const Shape<3> shape = make_shells_shape(R, n);
        CAPTURE(n);
        CHECK(total_volume(shape) == doctest::Approx(volume).epsilon(1e-12));
        CHECK(first_moment(shape).norm() < 1e-15);
        const double n2 = n * n, closed = volume * R * R / 5 * (1 - 25 / (36 * n2) + 1 / (9 * n2 * n2));
        const Mat<3> moment = second_moment(shape);
        CHECK((moment - closed * Mat<3>::Identity()).norm() < 1e-12 * closed);  // measured 2.6e-13
        CHECK(shape.radius == R);
    }
}

TEST_CASE("Shells: the outer shell is the surface and nodes keep apart") {
    const int n = 8;
    const Shape<3> shape = make_shells_shape(8.0, n);
    CHECK(shape.surface.size() == 708);  // round(4 pi/3 169)
    std::vector<Vec<3>> outer;
    for (const SurfacePoint<3>& p : shape.surface) {
        CHECK(p.delta == 0.5);
        CHECK(shape.X[p.node].norm() == doctest::Approx(7.5).epsilon(1e-12));
        CHECK((p.nu - shape.X[p.node].normalized()).norm() < 1e-12);
        CHECK(p.kappa == 1.0 / 8.0);
        outer.push_back(shape.X[p.node]);
    }
    const auto [least, most] = neighbour_distances<3>(outer);
    CHECK(least > 0.84);  // measured 0.871; a triangular lattice of this density has 1.07
    CHECK(most < 1.02);   // measured 0.986
}
