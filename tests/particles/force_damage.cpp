// What dissipates: damping in the bonds, and their breaking.
#include <limits>

#include "particles/shape_builders.hpp"
#include "tests/particles/force_cases.hpp"

using namespace quern;
using namespace quern::test;

namespace {

template <int Dim>
Field<Dim> damping_forces(const PeridynamicModel<Dim>& model, const GrainView<Dim>& grain) {
    Field<Dim> f(grain.x.size(), Vec<Dim>::Zero());
    std::visit([&](const auto& law) { law.add_damping_forces(grain, f); }, model);
    return f;
}

}  // namespace

TEST_CASE("Bond damping: takes energy, adds no momentum and no spin, whatever breaks") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, Material material) {
        material.bond_damping = 1e-4;
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        const Field<Dim> x = make_deformed(shape, 1.7);
        std::mt19937 random(9);
        std::normal_distribution<double> any;
        const std::vector<std::uint8_t> broken = make_broken(count_bonds(model));
        for (int trial = 0; trial < 4; ++trial) {
            Field<Dim> v(x.size());
            for (Vec<Dim>& value : v)
                for (int d = 0; d < Dim; ++d) value[d] = any(random);
            const std::span<const std::uint8_t> alive = trial < 2 ? std::span<const std::uint8_t>() : broken;
            const Field<Dim> f = damping_forces(model, {1.7, x, v, alive});
            Vec<Dim> total = Vec<Dim>::Zero();
            Spin<Dim> turn = Spin<Dim>::Zero();
            for (std::size_t i = 0; i < x.size(); ++i) {
                total += f[i];
                turn += moment(x[i], f[i]);
            }
            CHECK(dot(f, v) < 0.0);
            CHECK(total.norm() < 1e-13 * largest(f));              // measured 1.5e-15, bound 1e-13
            CHECK(turn.norm() < 1e-13 * largest(f) * largest(x));  // measured 1.0e-15, bound 1e-13
        }
    });
}

TEST_CASE("Bond damping: none in rigid motion of a deformed grain") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, Material material) {
        material.bond_damping = 1e-4;
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        const Field<Dim> x = make_deformed(shape, 1.7);
        Field<Dim> v, stretching;
        for (const Vec<Dim>& point : x) {
            v.push_back(cross(Spin<Dim>(Spin<Dim>::Constant(3.0)), point) + Vec<Dim>::Constant(0.2));
            stretching.push_back(3.0 * point);
        }
        const double scale = largest(damping_forces(model, {1.7, x, stretching, {}}));
        CHECK(largest(damping_forces(model, {1.7, x, v, {}})) <
              1e-12 * scale);  // measured 9e-16, bound 1e-12
    });
}

TEST_CASE("Bond damping: stress is bond_damping * stiffness * rate, in dilatation and for any rate") {
    Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
    material.bond_damping = 2e-4;
    const Shape<2> shape = make_test_shape<2>();
    const auto model = make_model(shape, material);
    double area = 0.0;
    for (const double volume : shape.volume) area += volume;
    const double rate = 0.3, K2 = material.bulk_modulus + material.shear_modulus / 3.0, scale = 1.7;
    Field<2> x, v;
    for (const Vec<2>& X : shape.X) {
        x.push_back(scale * X);
        v.push_back(rate * scale * X);
    }
    // power = -tau K2 (2 rate)^2 area of the scaled grain
    const double power = -2e-4 * K2 * 4.0 * rate * rate * area * scale * scale;
    CHECK(std::abs(dot(damping_forces(model, {scale, x, v, {}}), v) / power - 1.0) < 1e-12);

    // any rate, at rest: bond_damping times the linearised force of that displacement
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, Material any) {
        any.bond_damping = 2e-4;
        const Shape<Dim> grain = make_test_shape<Dim>();
        const auto law = make_model(grain, any);
        const Field<Dim> velocity = make_deformed(grain, 1.0);
        Field<Dim> expected = linear_forces(law, velocity);
        for (Vec<Dim>& force : expected) force *= 2e-4;
        CHECK(largest_difference(damping_forces(law, {1.0, grain.X, velocity, {}}), expected) <
              1e-13 * largest(expected));
    });
}

TEST_CASE("Bonds break: beyond the critical stretch only, in compression where asked for, for good") {
    for_each_case([]<int Dim>(std::integral_constant<int, Dim>, Material material) {
        const double s0 = 0.01, scale = 2.0;
        material.critical_stretch = s0;
        const bool both = material.breaks_in == BreaksIn::both;
        CHECK(both == (material.model == ForceModel::peridem));
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto model = make_model(shape, material);
        const int n_bonds = count_bonds(model);
        std::vector<std::uint8_t> alive(n_bonds, 1);
        const auto pull = [&](double stretch) {
            Field<Dim> x;
            for (const Vec<Dim>& X : shape.X) x.push_back(scale * (1.0 + stretch) * X);
            return std::visit(
                [&](const auto& law) {
                    return law.break_bonds({scale, x, {}, alive}, alive);
                },
                model);
        };
        CHECK(pull(-s0 * (1.0 - 1e-9)) == 0);
        CHECK(pull(-s0 * (1.0 + 1e-9)) == (both ? n_bonds : 0));
        CHECK(pull(-0.5) == 0);
        alive.assign(alive.size(), 1);
        CHECK(pull(s0 * (1.0 - 1e-9)) == 0);
        CHECK(pull(s0 * (1.0 + 1e-9)) == n_bonds);
        CHECK(pull(s0 * 2.0) == 0);
        CHECK(pull(0.0) == 0);
        CHECK(*std::max_element(alive.begin(), alive.end()) == 0);
        CHECK(largest(forces(model, {scale, make_deformed(shape, scale), {}, alive})) == 0.0);
    });
}

TEST_CASE("Bonds break: never without a critical stretch") {
    const Shape<2> shape = make_test_shape<2>();
    const Lps<2> model(shape, make_material(ForceModel::lps, PlaneState::strain, 2));
    Field<2> x;
    for (const Vec<2>& X : shape.X) x.push_back(100.0 * X);
    std::vector<std::uint8_t> alive(model.n_bonds(), 1);
    CHECK(model.break_bonds({1.0, x, {}, alive}, alive) == 0);
}

TEST_CASE_TEMPLATE("Damage: two halves pulled apart feel nothing, and show the volume they have lost", Tag,
                   std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
    constexpr int Dim = Tag::value;
    Material material = make_material(ForceModel::lps, PlaneState::strain, Dim);
    material.critical_stretch = 0.05;
    material.influence = Influence::constant;
    Shape<Dim> shape = make_lattice<Dim>(IntVec<Dim>::Constant(8), 0.01);
    for (int i = 0; i < shape.n_nodes(); ++i) shape.volume[i] *= 1.0 + 0.1 * (i % 4);
    const Lps<Dim> model(shape, material);
    Field<Dim> x = shape.X;
    for (Vec<Dim>& point : x)
        if (point[0] > 0.0) point[0] += 0.02;
    std::vector<std::uint8_t> alive(model.n_bonds(), 1);
    const int n_broken = model.break_bonds({1.0, x, {}, alive}, alive);
    int n_crossing = 0;
    std::vector<double> damage(shape.X.size()), expected(shape.X.size(), 0.0);
    for (int i = 0; i < shape.n_nodes(); ++i) {
        double across = 0.0, whole = 0.0;
        for (const auto [j, b] : model.bonds().family_of(i)) {
            whole += shape.volume[j];
            if (shape.X[i][0] * shape.X[j][0] < 0.0) across += shape.volume[j], ++n_crossing;
        }
        expected[i] = across / whole;
    }
    CHECK(2 * n_broken == n_crossing);
    model.compute_damage({1.0, x, {}, alive}, damage);
    for (std::size_t i = 0; i < damage.size(); ++i)
        REQUIRE(damage[i] == doctest::Approx(expected[i]).epsilon(1e-14));

    Field<Dim> f(x.size(), Vec<Dim>::Zero());
    model.add_internal_forces({1.0, x, {}, alive}, f);
    const double tie = material.bulk_modulus * std::pow(shape.dx, Dim - 1);
    CHECK(largest(f) < 1e-13 * tie);  // measured 1.1e-15, bound 1e-13
    CHECK(model.elastic_energy({1.0, x, {}, alive}) < 1e-20 * tie);
    CHECK(model.elastic_energy({1.0, x, {}, {}}) > 1e-6 * tie);
}

TEST_CASE("Critical stretch: the published values of PeriDEM, and -1/2 powers of horizon and scale") {
    Material material;
    set_peridem_options(material);
    material.bulk_modulus = 2.16e7;
    material.shear_modulus = 1.296e7;
    material.fracture_energy = 50.0;
    const BreakLimit soft = make_break_limit<2>(material, 0.6e-3);
    CHECK(soft.stretch == doctest::Approx(0.0463).epsilon(1e-3));  // measured 0.046296, printed to 4 digits
    CHECK(soft.longest(4.0) == doctest::Approx(1.0 + 0.5 * soft.stretch).epsilon(1e-14));
    CHECK(soft.shortest(4.0) == doctest::Approx(1.0 - 0.5 * soft.stretch).epsilon(1e-14));
    CHECK(make_break_limit<3>(material, 2.4e-3).stretch ==
          doctest::Approx(0.5 * soft.stretch).epsilon(1e-14));
    material.bulk_modulus = 2e9;
    material.shear_modulus = 1.2e9;
    material.fracture_energy = 500.0;
    CHECK(make_break_limit<2>(material, 0.6e-3).stretch == doctest::Approx(0.01521).epsilon(5e-4));
    material.shear_modulus = 0.0;  // (3/4)^4 K alone
    CHECK(std::pow(make_break_limit<2>(material, 0.6e-3).stretch, -2.0) ==
          doctest::Approx(0.31640625 * 2e9 * 0.6e-3 / 500.0).epsilon(1e-12));
}

TEST_CASE_TEMPLATE("Critical stretch: bonds across a plane, each at it, hold the fracture energy", Tag,
                   std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
    constexpr int Dim = Tag::value;
    const double dx = 0.01, Gc = 30.0;
    for_each_material<Dim>([&](Material material) {
        const bool springs = material.model == ForceModel::bond_based;
        if (Dim == 3 && !springs) return;
        material.horizon_ratio = Dim == 2 ? 6.3 : 4.3;
        material.fracture_energy = Gc;
        material.critical_stretch_formula = StretchFormula::energy_balance;
        // At the Poisson ratio of springs the LPS stores nothing in dilatation.
        const bool space = material.model == ForceModel::peridem;
        material.shear_modulus =
            (space || material.plane == PlaneState::strain ? 3.0 / 5.0 : 3.0 / 8.0) * material.bulk_modulus;
        const int half = static_cast<int>(material.horizon_ratio) * (springs ? 1 : 2);
        const Shape<Dim> shape = make_lattice<Dim>(IntVec<Dim>::Constant(2 * half + 1), dx);
        const auto model = make_model(shape, material, {Kernel::fast, Instructions::best, false});
        const int middle = shape.n_nodes() / 2;
        // A bond that reaches `a` columns is one of `a` alike across the same plane.
        const double energy = std::visit(
            [&](const auto& law) {
                double sum = 0.0;
                for (const auto& to : law.bonds().family_of(middle)) {
                    const double columns = (shape.X[to.node][0] - shape.X[middle][0]) / dx;
                    const double e = law.break_limit().stretch * law.bonds().length[to.bond];
                    if (columns > 0.5) sum += columns * 0.5 * law.stiffness().bond[to.bond] * e * e;
                }
                return sum;
            },
            model);
        // the sum is not the integral: measured at most 3.8 %, bound 5 %
        CHECK(std::abs(energy / (Gc * std::pow(dx, Dim - 1)) - 1.0) < 0.05);
    });
}

TEST_CASE("Critical stretch: the mean over all planes through a lattice holds the fracture energy") {
    const double dx = 0.01, Gc = 30.0;
    for (const Influence influence : {Influence::constant, Influence::inverse, Influence::conical}) {
        Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
        material.influence = influence;
        material.shear_modulus = 3.0 / 5.0 * material.bulk_modulus;
        material.fracture_energy = Gc;
        const double half = 8.5 * dx;
        const Shape<2> shape = make_lattice_shape<2>(
            Polygon({{-half, -half}, {half, -half}, {half, half}, {-half, half}}), Vec<2>::Constant(dx));
        for (const Calibration calibration : {Calibration::discrete, Calibration::none}) {
            material.calibration = calibration;
            const Lps<2> law(shape, material);
            const int middle = shape.n_nodes() / 2, n_angles = 3600;
            double mean = 0.0, least = 1e300, most = 0.0;
            for (int k = 0; k < n_angles; ++k) {
                const double angle = 2.0 * 3.14159265358979 * k / n_angles;
                double energy = 0.0;
                for (const auto& to : law.bonds().family_of(middle)) {
                    const Vec<2> bond = shape.X[to.node] - shape.X[middle];
                    const double e = law.break_limit().stretch * law.bonds().length[to.bond];
                    const double reach = bond.dot(Vec<2>(std::cos(angle), std::sin(angle)));
                    if (reach > 0.0)
                        energy += reach * 0.5 * law.stiffness().bond[to.bond] * e * e / (dx * dx);
                }
                mean += energy / (Gc * n_angles);
                least = std::min(least, energy / Gc);
                most = std::max(most, energy / Gc);
            }
            if (calibration == Calibration::discrete) {
                CHECK(std::abs(mean - 1.0) < 1e-5);  // measured 5e-7, of the sum over angles; bound 1e-5
                CHECK(most - least < 0.06);  // measured 0.039 (cone), 0.057 (1), 0.051 (1/r); bound 0.06
            } else {
                CHECK(std::abs(mean - 1.0) > 1e-3);
            }
        }
    }
}

TEST_CASE("Relative stretch: that of the worst bond, with the sign that breaks") {
    const Shape<2> shape = make_test_shape<2>();
    for (const BreaksIn direction : {BreaksIn::tension, BreaksIn::both}) {
        Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
        material.critical_stretch = 0.02;
        material.breaks_in = direction;
        const Lps<2> given(shape, material);
        const auto largest_of = [&](const Lps<2>& model, double scale, double stretch) {
            Field<2> x;
            for (const Vec<2>& X : shape.X)
                x.push_back(scale * (1.0 + stretch) * (make_rotation<2>(2.0) * X));
            std::vector<double> Z(shape.X.size());
            const std::vector<std::uint8_t> broken = make_broken(model.n_bonds());
            model.compute_relative_stretch({scale, x, {}, broken}, Z);
            CHECK(*std::min_element(Z.begin(), Z.end()) ==
                  doctest::Approx(*std::max_element(Z.begin(), Z.end())).epsilon(1e-10));
            return Z.front();
        };
        CHECK(largest_of(given, 1.7, 0.01) == doctest::Approx(0.5).epsilon(1e-10));
        CHECK(largest_of(given, 1.7, -0.03) ==
              doctest::Approx(direction == BreaksIn::both ? 1.5 : 0.0).epsilon(1e-10));
        material.critical_stretch = std::numeric_limits<double>::infinity();
        material.fracture_energy = 1.0;
        const Lps<2> by_energy(shape, material);
        CHECK(largest_of(by_energy, 4.0, 0.01) ==
              doctest::Approx(2.0 * largest_of(by_energy, 1.0, 0.01)).epsilon(1e-10));

        Field<2> one = shape.X;  // one node moved: only it and its family know
        one[0] += Vec<2>(-0.004, -0.003);
        std::vector<double> Z(shape.X.size());
        given.compute_relative_stretch({1.0, one, {}, {}}, Z);
        double worst = 0.0;
        for (const auto& to : given.bonds().family_of(0)) {
            const double s = (one[to.node] - one[0]).norm() / given.bonds().length[to.bond] - 1.0;
            worst = std::max(worst, direction == BreaksIn::both ? std::abs(s) : s);
        }
        CHECK(Z[0] == doctest::Approx(worst / 0.02).epsilon(1e-12));
        CHECK(Z.back() == 0.0);
    }
}
