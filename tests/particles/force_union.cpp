// Unions of lattice grains of unlike shape against the printed formulas, for every law, instruction set and
// pattern of broken bonds.
#include <algorithm>
#include <limits>
#include <random>

#include "particles/shape_builders.hpp"
#include "particles/union_batch.hpp"
#include "tests/particles/force_cases.hpp"

namespace quern::test {

namespace {

std::vector<Instructions> sets_here() {
    std::vector<Instructions> sets;
    for (const Instructions set : {Instructions::avx512, Instructions::avx2, Instructions::plain})
        if (has_instructions(set)) sets.push_back(set);
    return sets;
}

/// Balls of unlike size, some with an even number of cells across; the third is no ball, the fourth has a
/// spacing of its own and the last two are alike.
template <int Dim>
std::vector<Shape<Dim>> make_shapes() {
    const Vec<Dim> edge = Vec<Dim>::Constant(0.01);
    const double unit = Dim == 2 ? 0.035 : 0.025;
    std::vector<Shape<Dim>> shapes;
    for (const double size : {0.8, 1.2, 1.0, 1.0, 0.95, 1.1, 1.05, 1.05})
        shapes.push_back(make_lattice_shape<Dim>(Ball<Dim>(size * unit), edge));
    if constexpr (Dim == 2)
        shapes[2] = make_lattice_shape<2>(
            Polygon({{-0.035, -0.02}, {0.01, -0.03}, {0.03, 0.0}, {0.02, 0.032}, {-0.02, 0.035}}), edge);
    else
        shapes[2] = make_lattice_shape<3>(Cuboid({0.04, 0.05, 0.03}), edge);
    shapes[3] = make_lattice_shape<Dim>(Ball<Dim>(1.3 * unit), 1.25 * edge);
    return shapes;
}

/// Eight grains, each of its own shape, size, place, rotation, deformation and broken bonds.
template <int Dim>
struct Company {
    std::vector<Shape<Dim>> shapes = make_shapes<Dim>();
    std::vector<PeridynamicModel<Dim>> models;
    std::vector<Field<Dim>> x, v;
    std::vector<std::vector<std::uint8_t>> own;  ///< [grain][bond] intact

    Company(const Material& material, Kernel kernel, bool broken) {
        std::mt19937 random(7);
        for (int g = 0; g < batch_lanes; ++g) {
            models.push_back(make_model<Dim>(shapes[g], material, {kernel}));
            Field<Dim> place = make_deformed<Dim>(shapes[g], scale(g)), velocity = place;
            const Mat<Dim> R = make_rotation<Dim>(0.7 * g);
            for (std::size_t i = 0; i < place.size(); ++i) {
                place[i] = Vec<Dim>::Constant(0.4 * g) + R * place[i];
                velocity[i] = (3.0 + g) * place[i].reverse();
            }
            x.push_back(place);
            v.push_back(velocity);
            own.emplace_back(count_bonds(models[g]), 1);
            if (broken)
                for (std::uint8_t& bit : own.back()) bit = random() % 3 != 0;
        }
    }
    double scale(int g) const { return 0.5 + 0.3 * g; }
    GrainView<Dim> view(int g) const { return {scale(g), x[g], v[g], own[g]}; }
    UnionMember<Dim> member(int g) const {
        return std::visit(
            [&](const auto& law) {
                return UnionMember<Dim>{&shapes[g].cell, &law.bonds(), &law.stiffness(), law.break_limit()};
            },
            models[g]);
    }
    Field<Dim> zero(int g) const { return Field<Dim>(x[g].size(), Vec<Dim>::Zero()); }
};

/// The union of some of them, in this order, with their bits and forces.
template <int Dim>
struct Union {
    const Company<Dim>& company;
    std::vector<int> chosen;
    std::vector<UnionMember<Dim>> members;
    UnionBatch<Dim> batch;
    std::vector<std::uint8_t> alive;
    std::vector<Field<Dim>> f, damping;

    Union(const Company<Dim>& all, std::vector<int> grains, const Material& material, Instructions set)
        : company(all),
          chosen(std::move(grains)),
          members(pick()),
          batch(members, CellUnion<Dim>(members), material, set, material.can_break()) {
        for (const int g : chosen) {
            f.push_back(all.zero(g));
            damping.push_back(all.zero(g));
        }
        if (!material.can_break()) return;
        alive = batch.intact();
        for (std::size_t lane = 0; lane < chosen.size(); ++lane)
            for (std::size_t b = 0; b < all.own[chosen[lane]].size(); ++b)
                if (all.own[chosen[lane]][b] == 0)
                    alive[batch.places(static_cast<int>(lane))[b]] &=
                        static_cast<std::uint8_t>(~(1U << lane));
    }
    std::vector<UnionMember<Dim>> pick() const {
        std::vector<UnionMember<Dim>> list;
        for (const int g : chosen) list.push_back(company.member(g));
        return list;
    }
    GrainBatch<Dim> grains(std::vector<Field<Dim>>& forces) const {
        GrainBatch<Dim> list;
        list.size = static_cast<int>(chosen.size());
        for (int lane = 0; lane < list.size; ++lane) {
            list.grain[lane] = company.view(chosen[lane]);
            list.f[lane] = forces[lane].data();
        }
        return list;
    }
    BrokenBonds evaluate() {
        batch.add_viscous_forces(grains(damping), alive);
        return batch.add_elastic_forces(grains(f), alive);
    }
};

const std::vector<int> everyone = {0, 1, 2, 3, 4, 5, 6, 7};

}  // namespace

TEST_CASE("Union: forces and damping of every lane are those of the printed formulas") {
    double worst = 0.0, worst_damping = 0.0;
    const auto check = [&](auto dim, const Material& material, bool broken) {
        constexpr int Dim = dim();
        const Company<Dim> printed(material, Kernel::reference, broken);
        for (const Instructions set : sets_here())
            for (const std::vector<int>& chosen : {everyone, {6, 2, 0, 5, 3}, {4}}) {
                Union<Dim> together(printed, chosen, material, set);
                CHECK(together.evaluate().bond.empty());
                for (std::size_t lane = 0; lane < chosen.size(); ++lane) {
                    const int g = chosen[lane];
                    Field<Dim> expected = printed.zero(g), expected_damping = expected;
                    std::visit(
                        [&](const auto& law) {
                            law.add_internal_forces(printed.view(g), expected);
                            law.add_damping_forces(printed.view(g), expected_damping);
                        },
                        printed.models[g]);
                    raise(worst, largest_difference(together.f[lane], expected) / largest(expected));
                    raise(worst_damping, largest_difference(together.damping[lane], expected_damping) /
                                             largest(expected_damping));
                }
            }
    };
    for_each_case([&](auto dim, Material material) {
        material.bond_damping = 1e-4;
        check(dim, material, false);
        material.critical_stretch = 10.0;
        check(dim, material, true);
        if (material.influence != Influence::conical) return;
        material.surface_correction = SurfaceCorrection::volume;
        check(dim, material, true);
        material.surface_correction = SurfaceCorrection::none;
        material.calibration = Calibration::none;
        check(dim, material, true);
    });
    CHECK(worst < 1e-12);          // measured 2.3e-14, bound 1e-12
    CHECK(worst_damping < 1e-12);  // measured 1.8e-15, bound 1e-12
}

TEST_CASE("Union: a grain's bits depend neither on its lane nor on its companions") {
    for_each_case([&](auto dim, Material material) {
        constexpr int Dim = dim();
        material.bond_damping = 1e-4;
        for (const bool broken : {false, true}) {
            if (broken) material.critical_stretch = 10.0;
            const Company<Dim> company(material, Kernel::fast, broken);
            for (const Instructions set : sets_here()) {
                Union<Dim> together(company, everyone, material, set);
                Union<Dim> turned(company, {7, 5, 4, 1, 0, 2}, material, set);
                together.evaluate();
                turned.evaluate();
                for (std::size_t lane = 0; lane < turned.chosen.size(); ++lane) {
                    const int g = turned.chosen[lane];
                    Union<Dim> alone(company, {g}, material, set);
                    alone.evaluate();
                    CHECK(largest_difference(together.f[g], alone.f[0]) == 0.0);
                    CHECK(largest_difference(turned.f[lane], alone.f[0]) == 0.0);
                    CHECK(largest_difference(together.damping[g], alone.damping[0]) == 0.0);
                    CHECK(largest_difference(turned.damping[lane], alone.damping[0]) == 0.0);
                }
            }
        }
    });
}

TEST_CASE("Union: bonds break in the lanes where they are stretched too far, and no longer pull") {
    for_each_case([&](auto dim, Material material) {
        constexpr int Dim = dim();
        const bool both = material.breaks_in == BreaksIn::both;
        // Of the peridem materials s0 comes from an energy and differs from lane to lane.
        material.critical_stretch = both ? std::numeric_limits<double>::infinity() : 0.02;
        if (both) material.fracture_energy = 0.02 * 0.02 * 3.0 * material.shear_modulus * 0.03;
        const Company<Dim> company(material, Kernel::fast, true);
        for (const Instructions set : sets_here()) {
            Union<Dim> together(company, {0, 1, 2, 3, 4, 5}, material, set);
            const std::vector<std::uint8_t> before = together.alive;
            const BrokenBonds torn = together.evaluate();
            std::vector<std::uint8_t> undone = together.alive;
            int n_torn = 0, n_broken = 0;
            for (std::size_t k = 0; k < torn.bond.size(); ++k) {
                undone[torn.bond[k]] |= torn.lanes[k];
                n_torn += __builtin_popcount(torn.lanes[k]);
            }
            CHECK(undone == before);
            for (int g = 0; g < 6; ++g) {
                std::vector<std::uint8_t> own = company.own[g];
                GrainView<Dim> view = company.view(g);
                view.alive = own;
                const BondBits bits(together.alive, g, together.batch.places(g).data());
                std::visit(
                    [&](const auto& law) {
                        n_broken += law.break_bonds(view, own);
                        Field<Dim> expected = company.zero(g), through_union = expected;
                        law.add_internal_forces(view, expected);
                        // measured 1.4e-14, bound 1e-12
                        CHECK(largest_difference(together.f[g], expected) < 1e-12 * largest(expected));
                        GrainView<Dim> same = view;
                        same.alive = bits;
                        law.add_internal_forces(same, through_union);
                        CHECK(largest_difference(through_union, expected) == 0.0);
                        CHECK(law.elastic_energy(same) == law.elastic_energy(view));
                    },
                    company.models[g]);
                for (std::size_t b = 0; b < own.size(); ++b)
                    CHECK(bits[static_cast<int>(b)] == (own[b] != 0));
            }
            CHECK(n_broken > 20);
            CHECK(n_torn == n_broken);
        }
    });
}

TEST_CASE("Union: has the cells and bonds of its members, each once, and a bit for each of theirs") {
    const auto check = [](auto dim) {
        constexpr int Dim = dim();
        Material material = make_material(ForceModel::lps, PlaneState::strain, Dim);
        material.critical_stretch = 0.1;
        const Company<Dim> company(material, Kernel::fast, false);
        const Union<Dim> together(company, everyone, material, Instructions::best);
        const CellUnion<Dim> cells(together.members);
        std::array<int, batch_lanes> n_bits{};
        for (const std::uint8_t byte : together.alive) {
            CHECK(byte != 0);
            for (int lane = 0; lane < batch_lanes; ++lane) n_bits[lane] += byte >> lane & 1;
        }
        int n_bonds = 0;
        for (int g = 0; g < batch_lanes; ++g) {
            const Bonds<Dim>& bonds = *together.members[g].bonds;
            CHECK(n_bits[g] == bonds.n_bonds());
            n_bonds += bonds.n_bonds();
            bool found = true;
            for (int i = 0; i < bonds.n_nodes(); ++i)
                for (int b = bonds.first[i]; b < bonds.first[i + 1]; ++b) {
                    const int row = cells.node_of[g][i], u = cells.bond_of[g][b];
                    found &= cells.first[row] <= u && u < cells.first[row + 1] &&
                             cells.partner[u] == cells.node_of[g][bonds.partner[b]];
                }
            CHECK(found);
        }
        CHECK(cells.fill() == doctest::Approx(n_bonds / (8.0 * cells.n_bonds())).epsilon(1e-15));
        CHECK(cells.fill() > 0.4);
        // Eight of one shape are that shape; one is an eighth of a batch.
        const std::vector<UnionMember<Dim>> same(batch_lanes, company.member(1)), one = {company.member(1)};
        CHECK(CellUnion<Dim>(same).fill() == 1.0);
        CHECK(CellUnion<Dim>(one).fill() == 0.125);
        CHECK(CellUnion<Dim>(same).n_nodes() == company.shapes[1].n_nodes());
    };
    check(std::integral_constant<int, 2>{});
    check(std::integral_constant<int, 3>{});
    // A disk lies within a wider one, whether their lattices have a node in the middle or not.
    Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
    for (const double wider : {1.0, 2.0, 5.0, 6.0}) {
        std::vector<Shape<2>> shapes;
        for (const double across : {12.0, 12.0 + wider})
            shapes.push_back(make_lattice_shape<2>(Ball<2>(0.005 * across), Vec<2>::Constant(0.01)));
        const Lps<2> small(shapes[0], material), large(shapes[1], material);
        const std::vector<UnionMember<2>> members = {
            {&shapes[0].cell, &small.bonds(), &small.stiffness(), small.break_limit()},
            {&shapes[1].cell, &large.bonds(), &large.stiffness(), large.break_limit()}};
        CHECK(CellUnion<2>(members).n_nodes() == shapes[1].n_nodes());
    }
}

}  // namespace quern::test
