// The bonds of a shape: who is joined, and what is refused.
#include <algorithm>

#include "grid/error.hpp"
#include "tests/particles/force_cases.hpp"

using namespace quern;
using namespace quern::test;

namespace {

template <class Make>
std::string message_of(Make&& make) {
    try {
        make();
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

bool has(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE_TEMPLATE("Bonds: the cell list finds the pairs of the double loop", Tag,
                   std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
    constexpr int Dim = Tag::value;
    const Shape<Dim> shape = make_shaken<Dim>(make_round<Dim>(0.06, 0.01), 0.3);
    Material material = make_material(ForceModel::lps, PlaneState::strain, Dim);
    material.influence = Influence::constant;
    const Bonds<Dim> bonds = make_bonds(shape, material);
    int found = 0;
    for (int i = 0; i < shape.n_nodes(); ++i)
        for (int j = i + 1; j < shape.n_nodes(); ++j) {
            const auto row =
                std::span(bonds.partner).subspan(bonds.first[i], bonds.first[i + 1] - bonds.first[i]);
            const bool joined = std::find(row.begin(), row.end(), j) != row.end();
            REQUIRE(joined == ((shape.X[j] - shape.X[i]).norm() <= bonds.horizon));
            found += joined;
        }
    CHECK(found == bonds.n_bonds());
    CHECK(bonds.family.size() == 2u * found);
}

TEST_CASE("Bonds: a full lattice family at horizon 3.015 dx has 28 neighbours in the plane, 122 in space") {
    Material material = make_material(ForceModel::lps, PlaneState::strain, 3);
    material.horizon_ratio = 3.015;
    const Bonds<2> flat = make_bonds(make_lattice<2>({7, 7}, 0.01), material);
    const Bonds<3> solid = make_bonds(make_lattice<3>({7, 7, 7}, 0.01), material);
    CHECK(flat.family_of(24).size() == 28);
    CHECK(solid.family_of(171).size() == 122);
    CHECK(flat.bulk_family_volume == doctest::Approx(28e-4).epsilon(1e-12));
    CHECK(solid.bulk_family_volume == doctest::Approx(122e-6).epsilon(1e-12));
}

TEST_CASE("Bonds: the rim of the cone counts for nothing and is left out") {
    Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
    material.horizon_ratio = 3.0;
    const Shape<2> shape = make_lattice<2>({7, 7}, 0.1);
    CHECK(make_bonds(shape, material).family_of(24).size() == 24);
    material.influence = Influence::constant;
    CHECK(make_bonds(shape, material).family_of(24).size() == 28);
}

TEST_CASE("Bonds: a length as horizon, its rim left out, and volumes cut there") {
    Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
    material.influence = Influence::constant;
    material.horizon_ratio = 3.0;
    const Shape<2> shape = make_lattice<2>({9, 9}, 0.1);
    const Bonds<2> by_ratio = make_bonds(shape, material);
    material.horizon_ratio = 7.0;
    material.horizon = 0.3;
    const Bonds<2> by_length = make_bonds(shape, material);
    CHECK(by_length.horizon == 0.3);
    CHECK(by_length.partner == by_ratio.partner);
    CHECK(by_length.moment == by_ratio.moment);
    material.horizon_rim = HorizonRim::excluded;
    CHECK(make_bonds(shape, material).family_of(40).size() == 24);

    material.horizon_rim = HorizonRim::included;
    material.volume_correction = VolumeCorrection::linear;
    const Bonds<2> cut = make_bonds(shape, material);
    double m = 0.0;
    for (const auto& to : cut.family_of(40)) {
        // of a family of 28, cells of width 0.1 around the nodes at 0.283 and 0.3 reach beyond the horizon
        const double xi = cut.length[to.bond];
        const double share = xi > 0.29 ? 0.5 : xi > 0.27 ? 3.5 - std::sqrt(8.0) : 1.0;
        CHECK(cut.weight[to.bond] == doctest::Approx(share).epsilon(1e-12));
        m += share * xi * xi * 0.01;
    }
    CHECK(cut.moment[40] == doctest::Approx(m).epsilon(1e-12));
}

TEST_CASE("Bonds: families that cannot carry load are refused by name") {
    Material material = make_material(ForceModel::lps, PlaneState::strain, 2);
    material.horizon_ratio = 0.9;
    const std::string lonely = message_of([&] { make_bonds(make_lattice<2>({5, 5}, 0.01), material); });
    CHECK(has(lonely, "material 'test' on shape 'lattice': got node 0 with 0 neighbours"));
    CHECK(has(lonely, "raise horizon_ratio, now 0.9"));
    material.horizon = 0.009;
    CHECK(has(message_of([&] {
                  make_bonds(make_lattice<2>({5, 5}, 0.01), material);
              }),
              "raise horizon, now 0.009 m"));
    material.horizon = 0.0;
    material.horizon_ratio = 3.015;
    CHECK(has(message_of([&] { make_bonds(make_lattice<2>({9, 1}, 0.01), material); }), "on one line"));
    CHECK(has(message_of([&] { make_bonds(make_lattice<3>({5, 5, 1}, 0.01), material); }), "on one plane"));
    Shape<2> doubled = make_lattice<2>({5, 5}, 0.01);
    doubled.X[7] = doubled.X[3];
    CHECK(has(message_of([&] { make_bonds(doubled, material); }), "nodes 3 and 7 at one place"));
}

TEST_CASE("Models: moduli that cannot be are refused") {
    const Shape<2> shape = make_lattice<2>({5, 5}, 0.01);
    Material material = make_material(ForceModel::bond_based, PlaneState::strain, 2);
    material.shear_modulus = 0.5 * material.bulk_modulus;
    const std::string springs = message_of([&] { make_model(shape, material); });
    CHECK(has(springs, "material 'test': shear_modulus: got 5e+06 Pa, expected 6e+06 Pa"));
    CHECK(has(springs, "Poisson ratio of 1/4"));
    material.model = ForceModel::lps;
    CHECK(message_of([&] { make_model(shape, material); }) == "accepted");
    material.density = 0.0;
    CHECK(has(message_of([&] { make_model(shape, material); }), "material 'test': density: got 0"));
}
