// Waves and time steps: the models in motion against closed forms.
#include <Eigen/Eigenvalues>
#include <numbers>

#include "particles/influence.hpp"
#include "particles/stable_step.hpp"
#include "particles/strain.hpp"
#include "tests/particles/force_cases.hpp"

using namespace quern;
using namespace quern::test;

namespace {

/// -density omega^2 of plane waves exp(i k.X) in the endless lattice of spacing dx, as a matrix [N/m^5; 2D:
/// N/m^4]:
///
///     bond-based  D = sum C w (1 - cos k.xi) d d^T V
///     LPS         D = sum (2 a/m) w (1 - cos k.xi) d d^T V + (n b/m^2) h h^T,   h = sum w sin(k.xi) xi V
///     PeriDEM     the same with n = 3, a = 15 G, b = 3 K - 5 G in the plane as well, and volumes cut at the
///     rim
///
/// d = xi/|xi|, summed over the whole stencil; h is what is left of the dilatation of both ends.
template <int Dim>
Mat<Dim> make_wave_matrix(const Material& material, double dx, const Vec<Dim>& k) {
    const double horizon = material.horizon_ratio * dx, V = std::pow(dx, Dim);
    double m = 0.0;
    Mat<Dim> springs = Mat<Dim>::Zero();
    Vec<Dim> h = Vec<Dim>::Zero();
    const bool cut = material.volume_correction == VolumeCorrection::linear;
    const int reach = 4;
    const int width = 2 * reach + 1;
    for (int id = 0; id < (Dim == 2 ? width * width : width * width * width); ++id) {
        Vec<Dim> xi;
        int rest = id;
        for (int d = 0; d < Dim; ++d) {
            xi[d] = dx * (rest % width - reach);
            rest /= width;
        }
        const double length = xi.norm();
        if (length == 0.0 || length > horizon) continue;
        const double share = cut && length > horizon - 0.5 * dx ? (horizon + 0.5 * dx - length) / dx : 1.0;
        const double w = share * influence(material.influence, length / horizon);
        m += w * length * length * V;
        springs += w * V * (1.0 - std::cos(k.dot(xi))) / (length * length) * xi * xi.transpose();
        h += w * V * std::sin(k.dot(xi)) * xi;
    }
    const double G = material.shear_modulus;
    if (material.model == ForceModel::peridem)
        return 30.0 * G / m * springs +
               3.0 * (3.0 * material.bulk_modulus - 5.0 * G) / (m * m) * h * h.transpose();
    const double K = dilatational_modulus<Dim>(material), n = Dim;
    if (material.model == ForceModel::bond_based) return (Dim == 2 ? 8.0 : 18.0) * K / m * springs;
    const double a = (Dim == 2 ? 8.0 : 15.0) * G;
    return 2.0 * a / m * springs + n * (n * K - a / n) / (m * m) * h * h.transpose();
}

template <int Dim>
Field<Dim> make_noise(std::size_t n) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(-1.0, 1.0);
    Field<Dim> noise(n);
    for (Vec<Dim>& value : noise)
        for (int d = 0; d < Dim; ++d) value[d] = any(random);
    return noise;
}

/// Largest displacement after `steps` of leapfrog from noise of size 1, linearised, damped or not. The
/// damping sees the velocity of half a step before.
template <int Dim>
double grow(const Shape<Dim>& shape, const Material& material, double dt, int steps) {
    const auto model = make_model(shape, material);
    Field<Dim> u = make_noise<Dim>(shape.X.size()), v(u.size(), Vec<Dim>::Zero());
    for (int step = 0; step < steps; ++step) {
        Field<Dim> f = linear_forces(model, u);
        const GrainView<Dim> grain{1.0, shape.X, v, {}};
        std::visit([&](const auto& law) { law.add_damping_forces(grain, f); }, model);
        for (std::size_t i = 0; i < u.size(); ++i) {
            v[i] += dt / (material.density * shape.volume[i]) * f[i];
            u[i] += dt * v[i];
        }
    }
    return largest(u);
}

}  // namespace

TEST_CASE("Dispersion: plane waves in a lattice are those of the closed form, for every law") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, Material material) {
        material.horizon_ratio = Dim == 2 ? 3.015 : 2.2;
        const int count = Dim == 2 ? 13 : 9;  // the middle node sees no surface, nor do its partners
        const double dx = 0.01;
        const Shape<Dim> shape = make_lattice<Dim>(IntVec<Dim>::Constant(count), dx);
        const auto model = make_model(shape, material);
        const std::size_t middle = shape.X.size() / 2;
        for (const double length : {40.0, 7.3, 2.6}) {
            Vec<Dim> k = Vec<Dim>::Ones() + 0.7 * Vec<Dim>::Unit(0);
            k *= 2.0 * std::numbers::pi / (length * dx) / k.norm();
            const Mat<Dim> expected = make_wave_matrix<Dim>(material, dx, k);
            Mat<Dim> is;
            for (int d = 0; d < Dim; ++d) {
                Field<Dim> u;
                for (const Vec<Dim>& X : shape.X) u.push_back(std::cos(k.dot(X)) * Vec<Dim>::Unit(d));
                is.col(d) = -linear_forces(model, u)[middle] / shape.volume[middle];
            }
            CHECK((is - expected).norm() < 1e-11 * expected.norm());  // measured 3.5e-15, bound 1e-11
        }
    });
}

TEST_CASE("Dispersion: long waves run at the speeds of the continuum, but for the lattice anisotropy") {
    Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
    const double dx = 0.01, K = material.bulk_modulus, G = material.shear_modulus;
    double fast = 0.0, slow = 0.0;
    const int n_angles = 16;
    for (int a = 0; a < n_angles; ++a) {
        const double angle = 2.0 * std::numbers::pi * a / n_angles,
                     k = 2.0 * std::numbers::pi / (1000.0 * dx);
        const Mat<2> D = make_wave_matrix<2>(material, dx, k * Vec<2>(std::cos(angle), std::sin(angle)));
        const Vec<2> moduli = Eigen::SelfAdjointEigenSolver<Mat<2>>(D / (k * k)).eigenvalues();
        slow += moduli[0] / n_angles;
        fast += moduli[1] / n_angles;
    }
    CHECK(std::abs(slow / G - 1.0) < 2e-3);                    // measured 1.5e-4, bound 2e-3
    CHECK(std::abs(fast / (K + 4.0 / 3.0 * G) - 1.0) < 2e-3);  // measured 3.3e-6, bound 2e-3
}

TEST_CASE("Bar: the lowest longitudinal wave runs at sqrt(E/density)") {
    // Plane stress, 120 x 24 nodes; a cosine of one half wave along the bar turns round after a quarter
    // period.
    for (const ForceModel kind : {ForceModel::lps, ForceModel::bond_based}) {
        Material material = make_material(kind, PlaneState::stress, 2);
        const Shape<2> shape = make_lattice<2>({120, 24}, 0.01);
        const auto model = make_model(shape, material);
        const double K = material.bulk_modulus, G = material.shear_modulus, E = 9.0 * K * G / (3.0 * K + G);
        const double length = 1.2, speed = std::sqrt(E / material.density);
        const auto mode = [&](const Vec<2>& X) { return -std::sin(std::numbers::pi * X[0] / length); };
        Field<2> x = shape.X, v;
        for (const Vec<2>& X : shape.X) v.push_back({1e-4 * speed * mode(X), 0.0});
        const double omega = std::visit([](const auto& law) { return law.max_frequency(); }, model);
        const double dt = 0.5 * 2.0 / omega;
        double amplitude = 1.0, before = 1.0, time = 0.0;
        while (amplitude > 0.0 && time < length / speed) {
            const Field<2> f = forces(model, {1.0, x, {}, {}});
            before = amplitude;
            amplitude = 0.0;
            for (std::size_t i = 0; i < x.size(); ++i) {
                v[i] += dt / (material.density * shape.volume[i]) * f[i];
                x[i] += dt * v[i];
                amplitude += v[i][0] * mode(shape.X[i]);
            }
            time += dt;
        }
        // v stands half a step before x.
        const double quarter = time - 0.5 * dt - dt * amplitude / (amplitude - before);
        const double measured = length / (2.0 * quarter);
        // faces of LPS are stiff, those of springs soft: measured +0.0064, -0.0247, bound 0.03
        CHECK(std::abs(measured / speed - 1.0) < 0.03);
        CHECK((measured > speed) == (kind == ForceModel::lps));
    }
}

TEST_CASE("Stable step: omega is above the true one, by less than a percent") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, const Material& material) {
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        const Eigen::Index n = static_cast<Eigen::Index>(shape.X.size()) * Dim;
        Eigen::MatrixXd K(n, n);
        for (Eigen::Index c = 0; c < n; ++c) {
            Field<Dim> u(shape.X.size(), Vec<Dim>::Zero());
            u[c / Dim][c % Dim] = 1.0;
            const Field<Dim> f = linear_forces(model, u);
            for (Eigen::Index r = 0; r < n; ++r)
                K(r, c) = -f[r / Dim][r % Dim] /
                          (material.density * std::sqrt(shape.volume[r / Dim] * shape.volume[c / Dim]));
        }
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K).eigenvalues();
        const double truth = std::sqrt(values[n - 1]);
        const double omega = std::visit([](const auto& law) { return law.max_frequency(); }, model);
        CHECK(omega >= truth);
        CHECK(omega < 1.01 * truth);  // measured 1.0060, bound 1.01
        // rigid motions, and they alone, cost nothing
        const int n_rigid = Dim + n_spin<Dim>;
        CHECK(std::abs(values[n_rigid - 1]) < 1e-12 * values[n - 1]);
        CHECK(values[n_rigid] > 1e-4 * values[n - 1]);
    });
}

TEST_CASE("Stable step: leapfrog is bounded just below the limit and blows up just above, damped or not") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, Material material) {
        const Shape<Dim> shape = make_test_shape<Dim>();
        const double omega =
            std::visit([](const auto& law) { return law.max_frequency(); }, make_model(shape, material));
        for (const double damping : {0.0, 0.3 / omega}) {
            material.bond_damping = damping;
            const double limit = critical_step(omega, damping);
            CHECK(grow<Dim>(shape, material, 0.95 * limit, 400) < 30.0);  // measured 2.9, bound 30
            CHECK(grow<Dim>(shape, material, 1.05 * limit, 400) >
                  1e10);  // measured at least 1.9e63, bound 1e10
        }
    });
}

TEST_CASE("Stable step: in units of the spacing over the sound speed") {
    Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
    const Shape<2> shape = make_round<2>(0.125, 0.01);
    const double sound =
        std::sqrt((material.bulk_modulus + 4.0 / 3.0 * material.shear_modulus) / material.density);
    const double step = critical_step(Lps<2>(shape, material).max_frequency(), 0.0) * sound / shape.dx;
    CHECK(step > 1.5);  // measured 1.9
    CHECK(step < 2.4);
}
