// Finite-strain von Mises plasticity of a point: moduli, yield, hardening, frame, energy.
#include "particles/von_mises.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <random>
#include <tuple>

namespace quern::test {

namespace {

const VonMises steel{160e9, 80e9, 400e6, 4e9};

template <int Dim>
Mat<Dim> gradient(int row, int column, double value) {
    Mat<Dim> f = Mat<Dim>::Identity();
    f(row, column) += value;
    return f;
}

template <int Dim>
Mat<Dim> random_gradient(std::mt19937& random, double size) {
    std::uniform_real_distribution<double> entry(-size, size);
    Mat<Dim> f = Mat<Dim>::Identity();
    for (int i = 0; i < Dim; ++i)
        for (int j = 0; j < Dim; ++j) f(i, j) += entry(random);
    return f;
}

template <int Dim>
double largest(const SymTensor<Dim>& a) {
    double value = 0.0;
    for (const double component : a) value = std::max(value, std::abs(component));
    return value;
}

template <int Dim>
SymTensor<Dim> difference(SymTensor<Dim> a, const SymTensor<Dim>& b) {
    for (std::size_t c = 0; c < a.size(); ++c) a[c] -= b[c];
    return a;
}

/// Work of the mean Kirchhoff stress over an increment of a motion F [J/m^3].
template <int Dim>
double stress_work(const SymTensor<Dim>& before, const SymTensor<Dim>& after, const Mat<Dim>& f) {
    // Nominal stress of both ends on the change of the gradient: the trapezoid of a leapfrog.
    const Mat<Dim> df = f - Mat<Dim>::Identity();
    const Mat<Dim> end = to_matrix<Dim>(after) * f.inverse().transpose();
    return 0.5 * (to_matrix<Dim>(before) + end).cwiseProduct(df).sum();
}

template <int Dim>
void check_small_strains() {
    const VonMises elastic{2e9, 0.7e9, std::numeric_limits<double>::infinity(), 0.0};
    const double e = 1e-7;
    double work = 0.0;
    PlasticState<Dim> pulled, sheared;
    const SymTensor<Dim> axial = update<Dim>(pulled, gradient<Dim>(0, 0, e), elastic, work);
    const SymTensor<Dim> shear = update<Dim>(sheared, gradient<Dim>(0, 1, e), elastic, work);
    const double M = 2e9 + 4.0 / 3.0 * 0.7e9, lambda = 2e9 - 2.0 / 3.0 * 0.7e9;
    CHECK(axial[0] == doctest::Approx(M * e).epsilon(1e-6));  // measured 3e-8, of second order in e
    CHECK(axial[1] == doctest::Approx(lambda * e).epsilon(1e-6));
    CHECK(axial[Dim == 2 ? 3 : 2] == doctest::Approx(lambda * e).epsilon(1e-6));
    CHECK(shear[Dim == 2 ? 2 : 3] == doctest::Approx(0.7e9 * e).epsilon(1e-6));
    CHECK(elastic_energy<Dim>(pulled, elastic) == doctest::Approx(0.5 * M * e * e).epsilon(1e-6));
    CHECK(elastic_energy<Dim>(sheared, elastic) == doctest::Approx(0.5 * 0.7e9 * e * e).epsilon(1e-6));
    CHECK(work == 0.0);
}

template <int Dim>
void check_reversible() {
    const VonMises elastic{2e9, 0.7e9, std::numeric_limits<double>::infinity(), 0.0};
    std::mt19937 random(3);
    PlasticState<Dim> in_steps, at_once;
    Mat<Dim> F = Mat<Dim>::Identity();
    double work = 0.0;
    SymTensor<Dim> stress{};
    for (int k = 0; k < 40; ++k) {
        const Mat<Dim> f = random_gradient<Dim>(random, 0.1);
        F = f * F;
        stress = update<Dim>(in_steps, f, elastic, work);
    }
    const SymTensor<Dim> once = update<Dim>(at_once, F, elastic, work);
    const double scale = largest<Dim>(once);
    CHECK(largest<Dim>(difference<Dim>(stress, once)) < 1e-12 * scale);  // measured 1e-14, bound 1e-12
    CHECK(elastic_energy<Dim>(in_steps, elastic) ==
          doctest::Approx(elastic_energy<Dim>(at_once, elastic)).epsilon(1e-12));
    CHECK(in_steps.alpha == 0.0);
}

/// Stress against strain of a test in steps: uniaxial strain or simple shear.
template <int Dim>
void check_yield(bool shear) {
    const double K = steel.bulk_modulus, G = steel.shear_modulus, H = steel.hardening_modulus;
    const double yield = shear ? steel.yield_stress / std::sqrt(3.0) / G : steel.yield_stress / (2.0 * G);
    const double elastic = shear ? G : K + 4.0 / 3.0 * G;
    const double plastic = shear ? G * H / (3.0 * G + H) : K + 4.0 / 3.0 * G * H / (3.0 * G + H);
    PlasticState<Dim> state;
    double work = 0.0;
    const int n = 1000, at = shear ? (Dim == 2 ? 2 : 3) : 0;
    const double step = 2.0 * yield / n;
    std::vector<double> stress;
    double first = 0.0, F = 1.0;
    for (int k = 1; k <= n; ++k) {
        const double f = shear ? step : step / F;
        F += step;
        stress.push_back(update<Dim>(state, gradient<Dim>(0, shear ? 1 : 0, f), steel, work)[at]);
        if (first == 0.0 && state.alpha > 0.0) first = k * step;
    }
    CAPTURE(shear);
    CHECK(first == doctest::Approx(yield).epsilon(0.005));  // measured 0.002 and 0, bound 0.005
    CHECK(stress[399] / (400 * step) ==
          doctest::Approx(elastic).epsilon(0.005));  // measured 0.0005 and 0, bound 0.005
    CHECK((stress[n - 1] - stress[599]) / (400 * step) ==
          doctest::Approx(plastic).epsilon(shear ? 0.002 : 0.01));  // measured 0.0002 and 0.004
}

template <int Dim>
void check_frame() {
    std::mt19937 random(8);
    PlasticState<Dim> still, turning;
    Mat<Dim> R = Mat<Dim>::Identity();
    double work = 0.0, work_turning = 0.0;
    SymTensor<Dim> a{}, b{};
    for (int k = 0; k < 50; ++k) {
        const Mat<Dim> f = random_gradient<Dim>(random, 0.01);
        const Mat<Dim> Q = rotation_matrix(Spin<Dim>(Spin<Dim>::Constant(0.1 * k)));
        a = update<Dim>(still, f, steel, work);
        b = update<Dim>(turning, Mat<Dim>(Q * f * R.transpose()), steel, work_turning);
        R = Q;
    }
    CHECK(work > 1e6);
    CHECK(work_turning == doctest::Approx(work).epsilon(1e-10));  // measured 3e-15, bound 1e-10
    CHECK(turning.alpha == doctest::Approx(still.alpha).epsilon(1e-10));
    CHECK(largest<Dim>(difference<Dim>(push_forward<Dim>(R, a), b)) < 1e-10 * largest<Dim>(a));
    const double before = work_turning;
    const PlasticState<Dim> flowed = turning;
    const SymTensor<Dim> turned = update<Dim>(turning, R, steel, work_turning);
    // What the return has put on the yield surface may be beyond it by round-off once turned.
    CHECK(turning.alpha - flowed.alpha < 1e-16);
    CHECK(work_turning - before < 1e-6);
    CHECK(largest<Dim>(difference<Dim>(push_forward<Dim>(R, b), turned)) < 1e-12 * largest<Dim>(b));
}

/// Missing energy of a cycle of shear to and fro, and its plastic work [J/m^3].
template <int Dim>
std::pair<double, double> cycle(const VonMises& law, int n, double amplitude) {
    PlasticState<Dim> state;
    double work = 0.0, stress = 0.0;
    SymTensor<Dim> before{};
    for (int k = 0; k < 5 * n; ++k) {
        const double sign = k < n || k >= 3 * n ? 1.0 : -1.0;
        const Mat<Dim> f = gradient<Dim>(0, 1, sign * amplitude / n);
        const SymTensor<Dim> after = update<Dim>(state, f, law, work);
        stress += stress_work<Dim>(before, after, f);
        before = after;
    }
    return {stress - work - elastic_energy<Dim>(state, law), work};
}

}  // namespace

TEST_SUITE("particles") {
    TEST_CASE("Von Mises: moduli of small strains, no work without yield") {
        check_small_strains<2>();
        check_small_strains<3>();
    }

    TEST_CASE("Von Mises: without yield the way does not matter, however large the strains") {
        check_reversible<2>();
        check_reversible<3>();
    }

    TEST_CASE("Von Mises: yield point and slopes in uniaxial strain and in shear") {
        for (const bool shear : {false, true}) {
            check_yield<2>(shear);
            check_yield<3>(shear);
        }
    }

    TEST_CASE("Von Mises: a turned body has turned stresses, a turn costs nothing") {
        check_frame<2>();
        check_frame<3>();
    }

    TEST_CASE(
        "Von Mises: elastic energy and plastic work are the work of the stress, second order in a step") {
        for (const double yield : {400e6, 8e9}) {  // elastic strains of 0.3 and of 6 per cent
            const VonMises law{160e9, 80e9, yield, 4e9};
            const double amplitude = 10.0 * yield / law.shear_modulus;
            double coarse = 0.0, fine = 0.0, work = 0.0, again = 0.0;
            std::tie(coarse, work) = cycle<2>(law, 200, amplitude);
            std::tie(fine, again) = cycle<2>(law, 400, amplitude);
            CAPTURE(coarse / work);
            CAPTURE(fine / again);
            CHECK(std::abs(fine) < 2e-5 * work);             // measured 3.3e-6 and 3.3e-6, bound 2e-5
            CHECK(std::abs(fine) < 0.4 * std::abs(coarse));  // measured 0.17 and 0.20, bound 0.4
            CHECK(cycle<3>(law, 400, amplitude).second == doctest::Approx(again).epsilon(1e-12));
        }
    }

    TEST_CASE("Von Mises: plastic work of small elastic strains is the area under yield stress and alpha") {
        PlasticState<3> state;
        double work = 0.0;
        for (int k = 0; k < 2000; ++k) update<3>(state, gradient<3>(0, 1, 1e-5), steel, work);
        const double area =
            steel.yield_stress * state.alpha + 0.5 * steel.hardening_modulus * state.alpha * state.alpha;
        CHECK(work == doctest::Approx(area).epsilon(1e-4));  // measured 4e-6, bound 1e-4
    }

    TEST_CASE("Von Mises: the plane is plane strain of space") {
        std::mt19937 random(4);
        PlasticState<2> plane;
        PlasticState<3> space;
        double work2 = 0.0, work3 = 0.0;
        for (int k = 0; k < 100; ++k) {
            const Mat<2> f = random_gradient<2>(random, 0.02);
            Mat<3> f3 = Mat<3>::Identity();
            f3.topLeftCorner<2, 2>() = f;
            const SymTensor<2> a = update<2>(plane, f, steel, work2);
            const SymTensor<3> b = update<3>(space, f3, steel, work3);
            const double bound = 1e-12 * largest<3>(b);
            CHECK(std::abs(a[0] - b[0]) < bound);
            CHECK(std::abs(a[1] - b[1]) < bound);
            CHECK(std::abs(a[2] - b[3]) < bound);
            CHECK(std::abs(a[3] - b[2]) < bound);
        }
        CHECK(work2 == doctest::Approx(work3).epsilon(1e-12));
        CHECK(plane.be[3] != doctest::Approx(1.0).epsilon(1e-6));
        CHECK(elastic_energy<2>(plane, steel) ==
              doctest::Approx(elastic_energy<3>(space, steel)).epsilon(1e-12));
    }

    TEST_CASE("Von Mises: be keeps the determinant 1 and the stress stays on the yield surface") {
        PlasticState<3> state;
        double work = 0.0;
        for (int k = 0; k < 20000; ++k)  // shear of 20
            update<3>(state, gradient<3>(0, 1, 1e-3), {160e9, 80e9, 4e9, 0.0}, work);
        CHECK(determinant<3>(state.be) == doctest::Approx(1.0).epsilon(1e-13));  // measured 2e-16
        const SymTensor<3> d = plus_identity<3>(state.be, -mean_of<3>(state.be));
        CHECK(80e9 * std::sqrt(2.0 * half_square<3>(d)) ==
              doctest::Approx(std::sqrt(2.0 / 3.0) * 4e9).epsilon(1e-12));
        CHECK(state.J == doctest::Approx(1.0).epsilon(1e-12));
    }
}

}  // namespace quern::test
