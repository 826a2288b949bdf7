// Batches of grains against the printed formulas, for every law, instruction set and pattern of broken bonds.
#include <algorithm>
#include <limits>
#include <random>

#include "tests/particles/force_cases.hpp"

namespace quern::test {

namespace {

std::vector<Instructions> sets_here() {
    std::vector<Instructions> sets;
    for (const Instructions set : {Instructions::avx512, Instructions::avx2, Instructions::plain})
        if (has_instructions(set)) sets.push_back(set);
    return sets;
}

/// Grains of one shape, each of its own size, place, rotation and deformation.
template <int Dim>
struct Grains {
    std::vector<double> scale;
    std::vector<Field<Dim>> x, v;
    std::vector<std::uint8_t> alive;  ///< a bit a grain

    Grains(const Shape<Dim>& shape, int n, int n_bonds, bool broken) {
        std::mt19937 random(7);
        for (int g = 0; g < n; ++g) {
            scale.push_back(0.5 + 0.3 * g);
            Field<Dim> place = make_deformed<Dim>(shape, scale.back()), velocity = place;
            const Mat<Dim> R = make_rotation<Dim>(0.7 * g);
            for (std::size_t i = 0; i < place.size(); ++i) {
                place[i] = Vec<Dim>::Constant(0.4 * g) + R * place[i];
                velocity[i] = (3.0 + g) * place[i].reverse();
            }
            x.push_back(place);
            v.push_back(velocity);
        }
        if (broken)
            for (int b = 0; b < n_bonds; ++b)
                alive.push_back(static_cast<std::uint8_t>(random() % 3 == 0 ? random() % 256 : 255));
    }
    GrainView<Dim> view(int g) const {
        return {scale[g], x[g], v[g], alive.empty() ? BondBits() : BondBits(alive, g)};
    }
    GrainBatch<Dim> batch(int first, int size, std::vector<Field<Dim>>& f) const {
        GrainBatch<Dim> all;
        all.size = size;
        for (int lane = 0; lane < size; ++lane) {
            all.grain[lane] = view(first + lane);
            all.f[lane] = f[first + lane].data();
        }
        return all;
    }
};

}  // namespace

TEST_CASE("Batch: forces and damping are those of the printed formulas and of single grains") {
    double worst = 0.0, worst_damping = 0.0;
    for_each_case([&](auto dim, Material material) {
        constexpr int Dim = dim();
        material.bond_damping = 1e-4;
        const Shape<Dim> shape = make_test_shape<Dim>();
        const auto printed = make_model<Dim>(shape, material, {Kernel::reference});
        const int n_bonds = std::visit([](const auto& m) { return m.n_bonds(); }, printed);
        for (const Instructions set : sets_here())
            for (const int n : {8, 5, 1})
                for (const bool broken : {false, true}) {
                    const auto model = make_model<Dim>(shape, material, {Kernel::fast, set});
                    Grains<Dim> grains(shape, n, n_bonds, broken);
                    const Field<Dim> zero(shape.X.size(), Vec<Dim>::Zero());
                    std::vector<Field<Dim>> f(n, zero), damping(n, zero);
                    std::visit(
                        [&](const auto& law) {
                            CHECK(law.add_batch_forces(grains.batch(0, n, f), grains.alive).bond.empty());
                            law.add_batch_damping(grains.batch(0, n, damping), grains.alive);
                        },
                        model);
                    for (int g = 0; g < n; ++g) {
                        Field<Dim> expected = zero, expected_damping = zero;
                        std::visit(
                            [&](const auto& law) {
                                law.add_internal_forces(grains.view(g), expected);
                                law.add_damping_forces(grains.view(g), expected_damping);
                            },
                            printed);
                        worst = std::max(worst, largest_difference(f[g], expected) / largest(expected));
                        worst_damping =
                            std::max(worst_damping, largest_difference(damping[g], expected_damping) /
                                                        largest(expected_damping));
                    }
                }
    });
    CHECK(worst < 1e-12);          // measured 2.3e-14, bound 1e-12
    CHECK(worst_damping < 1e-12);  // measured 8.4e-16, bound 1e-12
}

TEST_CASE("Batch: a grain's bits depend neither on its lane nor on its companions") {
    for_each_case([&](auto dim, const Material& material) {
        constexpr int Dim = dim();
        const Shape<Dim> shape = make_test_shape<Dim>();
        for (const Instructions set : sets_here()) {
            const auto model = make_model<Dim>(shape, material, {Kernel::fast, set});
            const int n_bonds = std::visit([](const auto& m) { return m.n_bonds(); }, model);
            Grains<Dim> grains(shape, 8, n_bonds, false);
            const Field<Dim> zero(shape.X.size(), Vec<Dim>::Zero());
            std::vector<Field<Dim>> together(8, zero), alone(8, zero);
            std::visit(
                [&](const auto& law) {
                    law.add_batch_forces(grains.batch(0, 8, together), {});
                    for (int g = 0; g < 8; ++g) law.add_batch_forces(grains.batch(g, 1, alone), {});
                },
                model);
            for (int g = 0; g < 8; ++g) CHECK(largest_difference(together[g], alone[g]) == 0.0);
        }
    });
}

TEST_CASE("Batch: bonds break in the lanes where they are stretched too far, and no longer pull") {
    for_each_case([&](auto dim, Material material) {
        constexpr int Dim = dim();
        const bool both = material.breaks_in == BreaksIn::both;
        const Shape<Dim> shape = make_test_shape<Dim>();
        // Of the peridem materials s0 comes from an energy and differs from lane to lane.
        material.critical_stretch = both ? std::numeric_limits<double>::infinity() : 0.02;
        if (both)
            material.fracture_energy =
                0.02 * 0.02 * 3.0 * material.shear_modulus * material.horizon_of(shape.dx);
        for (const Instructions set : sets_here()) {
            int n_compressed = 0;
            const auto model = make_model<Dim>(shape, material, {Kernel::fast, set});
            const int n_bonds = std::visit([](const auto& m) { return m.n_bonds(); }, model);
            Grains<Dim> grains(shape, 6, n_bonds, true);
            std::vector<std::uint8_t> alive = grains.alive;
            std::vector<Field<Dim>> f(6, Field<Dim>(shape.X.size(), Vec<Dim>::Zero()));
            std::visit(
                [&](const auto& law) {
                    const BrokenBonds torn = law.add_batch_forces(grains.batch(0, 6, f), alive);
                    std::vector<std::uint8_t> undone = alive;
                    for (std::size_t k = 0; k < torn.bond.size(); ++k) undone[torn.bond[k]] |= torn.lanes[k];
                    CHECK(undone == grains.alive);
                    int n_broken = 0;
                    for (int g = 0; g < 6; ++g) {
                        std::vector<std::uint8_t> own(n_bonds);
                        for (int b = 0; b < n_bonds; ++b) own[b] = grains.alive[b] >> g & 1;
                        n_broken += law.break_bonds({grains.scale[g], grains.x[g], {}, own}, own);
                        const Bonds<Dim>& bonds = law.bonds();
                        for (int i = 0; i < bonds.n_nodes(); ++i)
                            for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b)
                                n_compressed += (grains.alive[b] >> g & 1) != own[b] &&
                                                (grains.x[g][bonds.partner[b]] - grains.x[g][i]).norm() <
                                                    grains.scale[g] * bonds.length[b];
                        for (int b = 0; b < n_bonds; ++b) CHECK((alive[b] >> g & 1) == own[b]);
                        Field<Dim> expected(shape.X.size(), Vec<Dim>::Zero());
                        law.add_internal_forces({grains.scale[g], grains.x[g], {}, own}, expected);
                        CHECK(largest_difference(f[g], expected) < 1e-12 * largest(expected));
                    }
                    CHECK(n_broken > 20);
                    CHECK((n_compressed > 20) == both);
                    CHECK((n_compressed > 0) == both);
                    for (int b = 0; b < n_bonds; ++b) CHECK((alive[b] | 63) == (grains.alive[b] | 63));
                },
                model);
        }
    });
}

}  // namespace quern::test
