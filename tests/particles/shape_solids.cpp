#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "particles/solids.hpp"

using namespace quern;
using std::numbers::pi;

namespace {

/// Sum of the overlaps with all cells of a lattice that covers the solid; the lattice is off centre.
template <int Dim>
double sum_of_overlaps(const Ball<Dim>& ball, double h) {
    const double low = ball.low()[0] - 0.37 * h;
    const int n = static_cast<int>(std::ceil((ball.high()[0] - low) / h));
    double sum = 0.0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j)
            for (int k = 0; k < (Dim == 3 ? n : 1); ++k) {
                Vec<Dim> lo;
                lo[0] = low + h * i;
                lo[1] = low + h * j;
                if constexpr (Dim == 3) lo[2] = low + h * k;
                sum += ball.overlap(lo, lo + Vec<Dim>::Constant(h));
            }
    return sum;
}

}  // namespace

TEST_CASE("Ball: the overlap of a disk with rectangles has its closed forms") {
    const Ball<2> disk(2.0);
    CHECK(disk.overlap({-3, -3}, {3, 3}) == doctest::Approx(4 * pi).epsilon(1e-14));
    CHECK(disk.overlap({0, 0}, {5, 5}) == doctest::Approx(pi).epsilon(1e-14));
    CHECK(disk.overlap({-1, -1}, {1, 1}) == doctest::Approx(4.0).epsilon(1e-14));
    CHECK(disk.overlap({1, -9}, {9, 9}) ==
          doctest::Approx(4 * pi / 3 - std::sqrt(3.0)).epsilon(1e-14));  // segment
    CHECK(disk.overlap({2, 2}, {3, 3}) == 0.0);
    CHECK(sum_of_overlaps(disk, 0.3) == doctest::Approx(4 * pi).epsilon(1e-13));
}

TEST_CASE("Ball: the overlap with boxes has its closed forms") {
    const Ball<3> ball(2.0);
    const double full = 32 * pi / 3;
    CHECK(ball.overlap({-3, -3, -3}, {3, 3, 3}) == doctest::Approx(full).epsilon(1e-9));  // measured 1e-15
    CHECK(ball.overlap({0, 0, 0}, {3, 3, 3}) == doctest::Approx(full / 8).epsilon(1e-9));
    CHECK(ball.overlap({-1, -1, -1}, {1, 1, 1}) == doctest::Approx(8.0).epsilon(1e-9));
    // cap of height 0.5: pi h^2 (3 R - h)/3, along each axis
    const double cap = pi * 0.25 * 5.5 / 3;
    CHECK(ball.overlap({-3, -3, 1.5}, {3, 3, 3}) == doctest::Approx(cap).epsilon(1e-9));
    CHECK(ball.overlap({1.5, -3, -3}, {3, 3, 3}) == doctest::Approx(cap).epsilon(1e-9));  // measured 1e-11
    CHECK(ball.overlap({2, 2, 2}, {3, 3, 3}) == 0.0);
    CHECK(sum_of_overlaps(ball, 0.31) == doctest::Approx(full).epsilon(1e-9));  // measured 1.3e-12
}

TEST_CASE("Ball: the view is radial") {
    const Ball<3> ball(2.0);
    const SurfaceView<3> view = ball.view({0, 1.5, 0});
    CHECK(view.normal == Vec<3>(0, 1, 0));
    CHECK(view.point == Vec<3>(0, 2, 0));
    CHECK(view.distance == doctest::Approx(0.5));
    CHECK(view.kappa == 0.5);
    CHECK(Ball<2>(2.0).view({0, 0}).normal.norm() == 1.0);  // the centre has some normal, not a NaN
    CHECK(Ball<2>(2.0).outline().size() == 64);
    CHECK(ball.outline().empty());
}

TEST_CASE("Cuboid: distance, view and overlap") {
    const Cuboid box({4, 2, 2});
    CHECK(box.measure() == 16.0);
    CHECK(box.distance({1.5, 0, 0}) == doctest::Approx(0.5));
    CHECK(box.distance({3, 2, 0}) == doctest::Approx(-std::sqrt(2.0)));
    CHECK(box.view({1.5, 0, 0}).normal == Vec<3>(1, 0, 0));
    CHECK((box.view({1.9, -0.9, 0}).normal - Vec<3>(1, -1, 0).normalized()).norm() < 1e-15);
    CHECK((box.view({-1.9, 0.9, 0.9}).normal - Vec<3>(-1, 1, 1).normalized()).norm() < 1e-15);
    CHECK(box.view({1.9, -0.9, 0}).distance == doctest::Approx(0.1));
    CHECK(box.view({1.9, -0.9, 0}).kappa == 0.0);
    CHECK(box.overlap({1, 0, 0}, {3, 3, 0.5}) == doctest::Approx(0.5));
    CHECK(box.overlap({3, 0, 0}, {4, 1, 1}) == 0.0);
    CHECK(box.outline().size() == 8);
    CHECK(box.radius_about({0, 0, 0}) == doctest::Approx(std::sqrt(6.0)));
}
