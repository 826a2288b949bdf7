// What every internal-force model must satisfy, whatever its law.
#include "grid/parallel.hpp"
#include "tests/particles/force_cases.hpp"

using namespace quern;
using namespace quern::test;

TEST_CASE("Internal forces: rigid motion, far away and turned by two radians, gives none") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, const Material& material) {
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        Field<Dim> x;
        for (const Vec<Dim>& X : shape.X)
            x.push_back(1.7 * (make_rotation<Dim>(2.0) * X) + Vec<Dim>::Constant(0.5));
        const double deformed = largest(forces(model, {1.7, make_deformed(shape, 1.7), {}, {}}));
        // relative to the force of 5 % strain; x itself is rounded to 1e-16 of 0.5 m, 5e-15 of a bond.
        // measured 1.6e-13, bound 5e-12
        CHECK(largest(forces(model, {1.7, x, {}, {}})) < 5e-12 * deformed);
    });
}

TEST_CASE("Internal forces: minus the gradient of the energy, intact and broken") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, const Material& material) {
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        Field<Dim> x = make_deformed(shape, 1.7);
        const std::vector<std::uint8_t> broken = make_broken(count_bonds(model));
        for (const std::span<const std::uint8_t> alive : {std::span<const std::uint8_t>(), {broken}}) {
            const Field<Dim> f = forces(model, {1.7, x, {}, alive});
            double worst = 0.0;
            for (std::size_t i = 0; i < x.size(); i += 7)
                for (int d = 0; d < Dim; ++d) {
                    const double h = 1e-5 * shape.dx, here = x[i][d];
                    x[i][d] = here + h;
                    const double up = energy(model, {1.7, x, {}, alive});
                    x[i][d] = here - h;
                    const double down = energy(model, {1.7, x, {}, alive});
                    x[i][d] = here;
                    worst = std::max(worst, std::abs(f[i][d] + (up - down) / (2.0 * h)));
                }
            CHECK(worst < 1e-8 * largest(f));  // measured 2.3e-10, bound 1e-8
        }
    });
}

TEST_CASE("Internal forces: no net force and no net moment") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, const Material& material) {
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        const Field<Dim> x = make_deformed(shape, 1.7), f = forces(model, {1.7, x, {}, {}});
        Vec<Dim> total = Vec<Dim>::Zero();
        Spin<Dim> turn = Spin<Dim>::Zero();
        for (std::size_t i = 0; i < x.size(); ++i) {
            total += f[i];
            turn += moment(x[i], f[i]);
        }
        CHECK(total.norm() < 1e-13 * largest(f));              // measured 7.5e-15, bound 1e-13
        CHECK(turn.norm() < 1e-13 * largest(f) * largest(x));  // measured 8.3e-16, bound 1e-13
    });
}

TEST_CASE("Internal forces: turn with the frame") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, const Material& material) {
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        const Mat<Dim> R = make_rotation<Dim>(1.1);
        Field<Dim> x = make_deformed(shape, 1.0), expected = forces(model, {1.0, x, {}, {}});
        for (Vec<Dim>& point : x) point = (R * point).eval();
        for (Vec<Dim>& force : expected) force = (R * force).eval();
        // measured 2.0e-14, bound 1e-12
        CHECK(largest_difference(forces(model, {1.0, x, {}, {}}), expected) < 1e-12 * largest(expected));
    });
}

TEST_CASE("Internal forces: scale as s^(Dim-1), energy as s^Dim, frequency of a rebuilt shape as 1/s") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, const Material& material) {
        const Shape<Dim> shape = make_test_shape<Dim>();
        const double s = 2.5;
        Shape<Dim> large = shape;
        for (Vec<Dim>& X : large.X) X *= s;
        for (double& volume : large.volume) volume *= std::pow(s, Dim);
        large.dx *= s;
        const auto model = make_model(shape, material), rebuilt = make_model(large, material);
        const Field<Dim> x = make_deformed(shape, s);
        const Field<Dim> expected = forces(rebuilt, {1.0, x, {}, {}});
        // measured 2.1e-14, bound 1e-12
        CHECK(largest_difference(forces(model, {s, x, {}, {}}), expected) < 1e-12 * largest(expected));
        CHECK(std::abs(energy(model, {s, x, {}, {}}) / energy(rebuilt, {1.0, x, {}, {}}) - 1.0) <
              1e-12);  // measured 4e-15, bound 1e-12
        const auto omega = [](const auto& law) { return law.max_frequency(); };
        CHECK(std::abs(std::visit(omega, rebuilt) * s / std::visit(omega, model) - 1.0) <
              1e-10);  // measured 1.4e-15, bound 1e-10
    });
}

TEST_CASE("Internal forces: the fast kernel equals the printed formulas, intact and broken") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, Material material) {
        const Shape<Dim> shape = make_test_shape<Dim>();
        const Field<Dim> x = make_deformed(shape, 1.7);
        for (const Calibration calibration : {Calibration::none, Calibration::discrete})
            for (const SurfaceCorrection correction : {SurfaceCorrection::none, SurfaceCorrection::volume}) {
                material.calibration = calibration;
                material.surface_correction = correction;
                const auto fast = make_model(shape, material);
                const auto printed = make_model(shape, material, KernelChoice{Kernel::reference});
                const std::vector<std::uint8_t> broken = make_broken(count_bonds(fast));
                for (const std::span<const std::uint8_t> alive :
                     {std::span<const std::uint8_t>(), {broken}}) {
                    const Field<Dim> expected = forces(printed, {1.7, x, {}, alive});
                    // measured 2.1e-14, bound 1e-12
                    CHECK(largest_difference(forces(fast, {1.7, x, {}, alive}), expected) <
                          1e-12 * largest(expected));
                }
            }
    });
}

TEST_CASE("Internal forces: accumulate, repeat to the bit, and do not mind whole masks") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, const Material& material) {
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        const Field<Dim> x = make_deformed(shape, 1.0), once = forces(model, {1.0, x, {}, {}});
        const std::vector<std::uint8_t> whole(count_bonds(model), 1);
        CHECK(largest_difference(forces(model, {1.0, x, {}, whole}), once) == 0.0);
        Field<Dim> twice = once;
        std::visit([&](const auto& law) { law.add_internal_forces({1.0, x, {}, {}}, twice); }, model);
        for (Vec<Dim>& force : twice) force *= 0.5;
        CHECK(largest_difference(twice, once) == 0.0);
    });
}

TEST_CASE("Internal forces: the linearised operator is their derivative at rest, and symmetric") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, const Material& material) {
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        const Field<Dim> deformed = make_deformed(shape, 1.0);
        Field<Dim> u, other, plus, minus;
        for (std::size_t i = 0; i < deformed.size(); ++i) {
            u.push_back(deformed[i] - shape.X[i]);
            other.push_back(Vec<Dim>::Constant(std::cos(3.0 * static_cast<double>(i))));
            plus.push_back(shape.X[i] + 1e-5 * u[i]);
            minus.push_back(shape.X[i] - 1e-5 * u[i]);
        }
        const Field<Dim> linear = linear_forces(model, u);
        Field<Dim> slope = forces(model, {1.0, plus, {}, {}});
        const Field<Dim> back = forces(model, {1.0, minus, {}, {}});
        for (std::size_t i = 0; i < slope.size(); ++i) slope[i] = (slope[i] - back[i]) / 2e-5;
        CHECK(largest_difference(slope, linear) < 1e-8 * largest(linear));  // measured 1.1e-9, bound 1e-8
        const double one = dot(linear, other), two = dot(linear_forces(model, other), u);
        CHECK(std::abs(one - two) < 1e-12 * std::abs(one));  // measured 1.5e-14, bound 1e-12
    });
}

TEST_CASE("Internal forces: grains of several sizes and models on several threads give the bits of one") {
    const Shape<2> small = make_test_shape<2>(), large = make_round<2>(0.08, 0.01);
    Material springs = make_material(ForceModel::bond_based, PlaneState::strain, 2);
    springs.bond_damping = 1e-4;
    const std::vector<PeridynamicModel<2>> models = {
        make_model(small, make_material(ForceModel::lps, PlaneState::strain, 2)), make_model(large, springs),
        make_model(large, make_material(ForceModel::lps, PlaneState::stress, 2))};
    const std::vector<Field<2>> x = {make_deformed(small, 1.0), make_deformed(large, 1.0),
                                     make_deformed(large, 1.0)};
    std::vector<std::vector<std::uint8_t>> alive;
    for (const auto& model : models) alive.push_back(make_broken(count_bonds(model)));
    const auto run = [&](int n_threads) {
        const int before = parallel::n_threads();
        parallel::set_threads(n_threads);
        std::vector<Field<2>> f(4000);
        parallel::for_each(f.size(), [&](std::size_t g) {
            const std::size_t m = g * 7 % 3;
            const std::span<const std::uint8_t> mask =
                g % 2 == 0 ? std::span<const std::uint8_t>() : alive[m];
            f[g] = forces(models[m], {1.0 + 0.001 * static_cast<double>(g), x[m], x[m], mask});
            std::visit(
                [&](const auto& law) {
                    law.add_damping_forces({1.0, x[m], x[m], mask}, f[g]);
                },
                models[m]);
        });
        parallel::set_threads(before);
        return f;
    };
    const std::vector<Field<2>> one = run(1), four = run(4);
    for (std::size_t g = 0; g < one.size(); ++g) REQUIRE(largest_difference(one[g], four[g]) == 0.0);
}

TEST_CASE("Internal forces: those of the public PeriDEM code, written out as it computes them") {
    Material material = make_material(ForceModel::peridem, PlaneState::strain, 2);
    material.horizon = 0.031;
    const Shape<2> shape = make_test_shape<2>();
    const Field<2> x = make_deformed(shape, 1.0);
    const int n = shape.n_nodes();
    const double K = material.bulk_modulus, G = material.shear_modulus, eps = material.horizon;
    double h = eps;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j) h = std::min(h, (shape.X[j] - shape.X[i]).norm());
    const auto visit_family = [&](int i, auto&& visit) {
        for (int j = 0; j < n; ++j) {
            const double r = (shape.X[j] - shape.X[i]).norm();
            if (j == i || r >= eps) continue;
            const double V = shape.volume[j] * (r > eps - 0.5 * h ? (eps + 0.5 * h - r) / h : 1.0);
            visit(j, r, 12.0 * (1.0 - r / eps), V, (x[j] - x[i]).norm() - r);
        }
    };
    std::vector<double> m(n, 0.0), theta(n, 0.0);
    for (int i = 0; i < n; ++i)
        visit_family(i, [&](int, double r, double J, double V, double) { m[i] += r * r * J * V; });
    for (int i = 0; i < n; ++i)
        visit_family(
            i, [&](int, double r, double J, double V, double e) { theta[i] += 3.0 / m[i] * r * e * J * V; });
    Field<2> expected(n, Vec<2>::Zero());
    for (int i = 0; i < n; ++i)
        visit_family(i, [&](int j, double r, double J, double V, double e) {
            const double T = J * (r * (theta[i] / m[i] + theta[j] / m[j]) * (3.0 * K - 5.0 * G) +
                                  15.0 * G * e * (1.0 / m[i] + 1.0 / m[j]));
            expected[i] += shape.volume[i] * T * V * (x[j] - x[i]).normalized();
        });
    // measured 6.4e-15, bound 1e-12
    CHECK(largest_difference(forces(make_model(shape, material), {1.0, x, {}, {}}), expected) <
          1e-12 * largest(expected));
}
