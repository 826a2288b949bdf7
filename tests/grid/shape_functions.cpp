// Linear and quadratic shape functions: sums, moments, slopes.
#include "grid/shape_functions.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

namespace quern {

namespace {

/// Four points each, knots of both functions among them.
std::vector<Pack> points() {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-4.0, 4.0);
    std::vector<Pack> list = {Pack(0.0, 0.5, -0.5, 1.0), Pack(-1.0, 1.5, -1.5, 2.0)};
    for (int i = 0; i < 100; ++i) list.emplace_back(any(random), any(random), any(random), any(random));
    return list;
}

double spline(double t) {
    const double r = std::abs(t);
    return r < 0.5 ? 0.75 - r * r : r < 1.5 ? 0.5 * (1.5 - r) * (1.5 - r) : 0.0;
}

/// Sums over the nodes of a function, and of the node times it.
template <class Function>
void check_sums(Function&& f, double zeroth, const std::vector<Pack>& list, bool slope) {
    for (const Pack& x : list) {
        Pack total = Pack::Zero(), first = Pack::Zero();
        for (int node = -7; node <= 7; ++node) {
            const Pack value = f(x - node);
            total += value;
            first += node * value;
        }
        CHECK((total - zeroth).abs().maxCoeff() < 1e-14);                      // measured 1e-15
        CHECK((first - (slope ? Pack::Ones() : x)).abs().maxCoeff() < 1e-14);  // measured 2e-15
    }
}

}  // namespace

TEST_CASE("Shape functions: values and slopes") {
    for (const Pack& t : points())
        for (int k = 0; k < pack_size; ++k) {
            const double e = 1e-5, slope = (spline(t[k] + e) - spline(t[k] - e)) / (2.0 * e);
            CHECK(std::abs(linear_shape(t)[k] - std::max(0.0, 1.0 - std::abs(t[k]))) < 1e-15);
            CHECK(std::abs(quadratic_shape(t)[k] - spline(t[k])) < 1e-15);
            CHECK(std::abs(quadratic_slope(t)[k] - slope) < 1e-5);  // measured 5e-6 at knots, bound 1e-5
        }
}

TEST_CASE("Shape functions: they sum to one, reproduce linear fields, and so do their slopes") {
    check_sums([](const Pack& t) { return linear_shape(t); }, 1.0, points(), false);
    check_sums([](const Pack& t) { return quadratic_shape(t); }, 1.0, points(), false);
    check_sums([](const Pack& t) { return quadratic_slope(t); }, 0.0, points(), true);
}

TEST_CASE("Shape functions: the sum of four") {
    CHECK(sum(Pack(1.0, 2.0, 4.0, 8.0)) == 15.0);
}

}  // namespace quern
