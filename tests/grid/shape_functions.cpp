// Linear and quadratic shape functions: sums, moments, gradients.
#include "grid/shape_functions.hpp"

#include <doctest/doctest.h>

#include <random>

namespace quern {

namespace {

template <int Dim>
std::vector<Vec<Dim>> points() {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-4.0, 4.0);
    std::vector<Vec<Dim>> list = {Vec<Dim>::Zero(), Vec<Dim>::Constant(0.5), Vec<Dim>::Constant(-1.0)};
    for (int i = 0; i < 200; ++i) {
        Vec<Dim> x;
        for (int a = 0; a < Dim; ++a) x[a] = any(random);
        list.push_back(x);
    }
    return list;
}

template <int Dim>
void check_linear() {
    CAPTURE(Dim);
    for (const Vec<Dim>& x : points<Dim>()) {
        const LinearStencil<Dim> stencil(x);
        double sum = 0.0;
        Vec<Dim> mean = Vec<Dim>::Zero();
        for (int k = 0; k < stencil.size; ++k) {
            CHECK(stencil.N[k] >= 0.0);
            sum += stencil.N[k];
            mean += stencil.N[k] * stencil.node(k).template cast<double>();
            double product = 1.0;
            for (int a = 0; a < Dim; ++a) product *= 1.0 - std::abs(x[a] - stencil.node(k)[a]);
            CHECK(std::abs(stencil.N[k] - product) < 1e-15);
        }
        CHECK(std::abs(sum - 1.0) < 1e-15);
        CHECK((mean - x).norm() < 1e-14);
    }
}

double spline(double r) {
    const double s = std::abs(r);
    return s < 0.5 ? 0.75 - s * s : s < 1.5 ? 0.5 * (1.5 - s) * (1.5 - s) : 0.0;
}

template <int Dim>
void check_quadratic() {
    CAPTURE(Dim);
    const auto value = [](const Vec<Dim>& r) {
        double product = 1.0;
        for (int a = 0; a < Dim; ++a) product *= spline(r[a]);
        return product;
    };
    for (const Vec<Dim>& x : points<Dim>()) {
        Vec<Dim> gradients = Vec<Dim>::Zero();
        Mat<Dim> moments = Mat<Dim>::Zero();
        int n_nodes = 0;
        for (int k = 0; k < power(5, Dim); ++k) {
            Vec<Dim> node = CartesianGrid<Dim>::cell(x).template cast<double>();
            for (int a = 0, rest = k; a < Dim; ++a, rest /= 5) node[a] += rest % 5 - 2;
            const Vec<Dim> t = x - node;
            if (t.cwiseAbs().maxCoeff() > 1.5) continue;
            ++n_nodes;
            const Vec<Dim> gradient = quadratic_gradient<Dim>(t);
            gradients += gradient;
            moments += node * gradient.transpose();
            for (int a = 0; a < Dim; ++a) {
                const Vec<Dim> e = 1e-5 * Vec<Dim>::Unit(a);
                const double slope = (value(t + e) - value(t - e)) / 2e-5;
                CHECK(std::abs(gradient[a] - slope) < 1e-5);  // measured 5e-6 at knots, bound 1e-5
            }
        }
        CHECK(n_nodes >= power(3, Dim));
        CHECK(gradients.norm() < 1e-14);
        CHECK((moments - Mat<Dim>::Identity()).norm() < 1e-14);
    }
}

}  // namespace

TEST_CASE("Shape functions: linear hats sum to one and reproduce linear fields") {
    check_linear<2>();
    check_linear<3>();
}

TEST_CASE("Shape functions: gradients of quadratic splines and their sums") {
    check_quadratic<2>();
    check_quadratic<3>();
}

}  // namespace quern
