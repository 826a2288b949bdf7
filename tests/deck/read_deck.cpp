// What a good deck says: parameters, overrides, defaults, files, arrays, and the way back.
#include "src/deck/read_deck.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "grid/error.hpp"
#include "tests/deck/deck_files.hpp"

using namespace quern;
using doctest::Approx;

namespace {

constexpr double pi = std::numbers::pi;

}  // namespace

TEST_CASE("read_deck: every key arrives in SI units") {
    const Deck deck = read_text(full_deck);
    CHECK(deck.title == "All of it: \"seed\" at 60 deg");
    CHECK(deck.dimension == 3);
    CHECK(deck.time.end == 120.0);
    CHECK(deck.time.step == 0.5e-6);
    CHECK(deck.time.safety == 0.7);
    CHECK(deck.gravity == Numbers3{9.8 * std::sin(pi / 3), 0.0, -9.8 * std::cos(pi / 3)});

    REQUIRE(deck.materials.size() == 2);
    const Material& glass = deck.materials[0];
    CHECK(glass.name == "glass");
    CHECK(glass.model == ForceModel::bond_based);
    CHECK(glass.density == Approx(2440).epsilon(1e-15));
    CHECK(glass.bulk_modulus == Approx(48e9).epsilon(1e-14));
    CHECK(glass.shear_modulus == Approx(28.8e9).epsilon(1e-14));
    CHECK(glass.influence == Influence::gaussian);
    CHECK(glass.calibration == Calibration::none);
    CHECK(glass.surface_correction == SurfaceCorrection::volume);
    CHECK(glass.bond_damping == 2e-6);
    CHECK(glass.critical_stretch == 0.001);
    CHECK(deck.materials[1].name == "odd name, really");
    CHECK(deck.materials[1].shear_modulus == Approx(6e18 / 7e9).epsilon(1e-14));  // 3KE/(9K - E)

    REQUIRE(deck.shapes.size() == 2);
    CHECK(deck.shapes[0].kind == ShapeKind::sphere);
    CHECK(deck.shapes[0].filling == Filling::rings);
    CHECK(deck.shapes[0].radius == 0.01);
    CHECK(deck.shapes[0].spacing == 0.001);
    CHECK(deck.shapes[1].size == Numbers3{0.01, 0.02, 0.03});

    CHECK(deck.grid.periodic == std::array<bool, 3>{true, false, false});
    CHECK(deck.grid.extent[0] == Approx(2.0).epsilon(1e-15));
    CHECK(deck.grid.extent[1] == Approx(2.1).epsilon(1e-15));  // rounded up to whole cells

    REQUIRE(deck.walls.size() == 2);
    CHECK(deck.walls[0].name == "y+");
    CHECK(deck.walls[0].normal == Numbers3{0, -1, 0});
    CHECK(deck.walls[0].point[1] == deck.grid.origin[1] + deck.grid.extent[1]);
    CHECK(deck.walls[0].velocity[1](0.5e-3) == Approx(-0.5 * 15e3));  // 15 mm/us
    CHECK(deck.walls[0].velocity[1](1.0) == Approx(-15e3));
    CHECK(deck.walls[1].normal[2] == Approx(0.8));
    CHECK(deck.walls[1].velocity.empty());

    CHECK(deck.contact.rule == ContactRule::seed);
    CHECK(deck.contact.coupling == ContactCoupling::flip);
    CHECK(deck.contact.friction == 0.15);
    REQUIRE(deck.contact.pairs.size() == 1);
    CHECK(deck.contact.pairs[0].second == "odd name, really");
    CHECK(deck.contact.pairs[0].friction == 0.5);
    CHECK(deck.contact.interior_weight == 0.1);
    CHECK(deck.contact.max_sweeps == 10);
    CHECK(deck.contact.tolerance == 1e-4);
    CHECK_FALSE((deck.contact.tile || deck.contact.curvature || deck.contact.rotation));
    CHECK_FALSE((deck.contact.gap_test || deck.contact.exact_mass));
    CHECK(deck.mass_damping == 3.0);

    REQUIRE(deck.loads.size() == 2);
    CHECK(deck.loads[0].grains == std::vector<int>{1});
    CHECK((*deck.loads[0].region)(0.1, 0, 0, 0) == 1.0);
    CHECK((*deck.loads[0].region)(-0.1, 0, 0, 0) == 0.0);
    CHECK_FALSE(deck.loads[0].per_mass);
    CHECK(deck.loads[0].value[1](0.0) == 1000.0);
    CHECK(deck.loads[0].value[2](0.25) == Approx(1.0));
    CHECK(deck.loads[1].grains.empty());
    CHECK(deck.loads[1].value[0](2, 3, 5, 7) == 210.0);

    REQUIRE(deck.constraints.size() == 1);
    CHECK_FALSE(deck.constraints[0].velocity[0]);
    CHECK((*deck.constraints[0].velocity[1])(0.0) == 100.0);
    CHECK_FALSE(deck.constraints[0].velocity[2]);

    CHECK(deck.prepare.gravity == Numbers3{0, 0, -1});
    CHECK(deck.prepare.friction == 0.0);
    CHECK(deck.output.track == std::vector<int>{0, 1});
    CHECK(deck.output.vtp);

    REQUIRE(deck.grains.size() == 2);
    CHECK(deck.grains[0].position == Numbers3{0, 0.01, 0.02});
    CHECK(deck.grains[0].angle[2] == Approx(pi / 2));
    CHECK(deck.grains[0].spin[0] == Approx(2 * pi));
    CHECK(deck.grains[1].velocity[0] == Approx(1 / 3.6));
    CHECK(deck.grains[1].scale == 1.5);
}

TEST_CASE("read_deck: what is left out takes the default of the struct") {
    const Deck deck = read_text(plain_deck);
    CHECK(deck.time.step == TimeDeck{}.step);
    CHECK(deck.contact.max_sweeps == ContactDeck{}.max_sweeps);
    CHECK(deck.contact.tile == ContactDeck{}.tile);
    CHECK(deck.materials[0].horizon_ratio == Material{}.horizon_ratio);
    CHECK(std::isinf(deck.materials[0].critical_stretch));
    CHECK(deck.output.history_interval == 0.0);
    CHECK_FALSE(deck.output.track_all);
    CHECK_FALSE(deck.prepare.gravity);
    CHECK(deck.grains[1].place.text().find("deck.yaml:32: grains.1") != std::string::npos);
}

TEST_CASE("read_deck: model peridem is lps with other defaults, each of which can be set back") {
    const auto material = [](const std::string& keys) {
        const Deck deck = read_text(replaced(plain_deck, "    density:", keys + "    density:"));
        const TempFolder folder;
        const Deck again = read_deck(folder.write("resolved.yaml", resolved_yaml(deck)), {});
        CHECK(resolved_yaml(again) == resolved_yaml(deck));
        return deck.materials[0];
    };
    const Material plain =
        material("    model: peridem\n    horizon: 0.6 mm\n    fracture_energy: 50 J/m^2\n");
    CHECK(plain.model == ForceModel::peridem);
    CHECK(plain.constants == Constants::three_dimensional);
    CHECK(plain.volume_correction == VolumeCorrection::linear);
    CHECK(plain.horizon_rim == HorizonRim::excluded);
    CHECK(plain.breaks_in == BreaksIn::both);
    CHECK(plain.influence == Influence::conical);
    CHECK(plain.calibration == Calibration::discrete);
    CHECK(plain.critical_stretch_formula == StretchFormula::peridem);
    CHECK(plain.horizon == 0.6e-3);
    CHECK(plain.horizon_of(1.0) == 0.6e-3);
    CHECK(plain.fracture_energy == 50.0);
    CHECK(plain.can_break());

    const Material back = material(
        "    model: peridem\n    constants: plane\n    volume_correction: none\n    horizon_rim: included\n"
        "    breaks_in: tension\n    fracture_energy: 50\n    critical_stretch_formula: energy_balance\n");
    CHECK(back.constants == Constants::plane);
    CHECK(back.volume_correction == VolumeCorrection::none);
    CHECK(back.horizon_rim == HorizonRim::included);
    CHECK(back.breaks_in == BreaksIn::tension);
    CHECK(back.critical_stretch_formula == StretchFormula::energy_balance);
    CHECK(back.horizon_of(0.1) == doctest::Approx(0.3015));

    const Material lps =
        material("    constants: three_dimensional\n    critical_stretch: 0.1\n    breaks_in: both\n");
    CHECK(lps.model == ForceModel::lps);
    CHECK(lps.constants == Constants::three_dimensional);
    CHECK(lps.critical_stretch == 0.1);
    CHECK(lps.breaks_in == BreaksIn::both);
    CHECK(lps.volume_correction == VolumeCorrection::none);
}

TEST_CASE("read_deck: any two moduli give the same material") {
    const double K = 40e9, G = 24e9, E = 9 * K * G / (3 * K + G), nu = (3 * K - 2 * G) / (6 * K + 2 * G);
    const std::pair<const char*, double> moduli[] = {
        {"bulk_modulus", K}, {"shear_modulus", G}, {"young_modulus", E}, {"poisson_ratio", nu}};
    for (int i = 0; i < 4; ++i) {
        for (int j = i + 1; j < 4; ++j) {
            std::string deck = plain_deck;
            deck = replaced(deck, "bulk_modulus: 40 GPa",
                            fmt::format("{}: {}", moduli[i].first, moduli[i].second));
            deck = replaced(deck, "shear_modulus: 24 GPa",
                            fmt::format("{}: {}", moduli[j].first, moduli[j].second));
            const Material material = read_text(deck).materials[0];
            CAPTURE(i);
            CAPTURE(j);
            CHECK(std::abs(material.bulk_modulus / K - 1) < 1e-14);   // measured 4e-16, bound 1e-14
            CHECK(std::abs(material.shear_modulus / G - 1) < 1e-14);  // measured 2e-16, bound 1e-14
        }
    }
}

TEST_CASE("read_deck: bond-based materials of the right Poisson ratio are taken") {
    const std::string bonds = replaced(plain_deck, "    density:", "    model: bond_based\n    density:");
    CHECK(read_text(bonds).materials[0].model == ForceModel::bond_based);
    const std::string stress = replaced(bonds, "    density:", "    plane: stress\n    density:");
    CHECK_THROWS_AS(read_text(stress), InputError);
    const std::string third = replaced(stress, "shear_modulus: 24 GPa", "poisson_ratio: ${1/3}");
    CHECK(read_text(third).materials[0].plane == PlaneState::stress);
}

TEST_CASE("read_deck: an override may begin a section that the deck does not have") {
    CHECK(read_text(plain_deck, {"output.checkpoint.every=7"}).output.checkpoint.every == 7);
    CHECK(read_text(plain_deck, {"compute.kernel=single"}).compute.kernel == ForceKernel::single);
}

TEST_CASE("read_deck: overrides come before parameters, and keep the unit of a parameter") {
    const auto gravity_x = [](const std::vector<std::string>& overrides) {
        return read_text(full_deck, overrides).gravity[0];
    };
    CHECK(gravity_x({"params.theta=30"}) == Approx(4.9));
    CHECK(gravity_x({"params.theta=30 deg"}) == Approx(4.9));
    CHECK(gravity_x({"params.theta=0.5 rad"}) == Approx(9.8 * std::sin(0.5)));
    CHECK(gravity_x({"params.theta=${3*10} deg"}) == Approx(4.9));
    CHECK(gravity_x({"gravity=[1, 2, 3]"}) == 1.0);
    CHECK(gravity_x({"gravity.0=7"}) == 7.0);
    const Deck deck = read_text(full_deck, {"params.word=pair", "time.safety=0.1", "grains.1.scale=3",
                                            "materials.glass.density=1", "params.mu=1", "params.speed=1"});
    CHECK(deck.contact.rule == ContactRule::pair);
    CHECK(deck.contact.friction == 0.5);
    CHECK(deck.time.safety == 0.1);
    CHECK(deck.grains[1].scale == 3.0);
    CHECK(deck.materials[0].density == 1.0);
    CHECK(deck.walls[0].velocity[1](1.0) == Approx(-1e3));  // 1 mm/us
    CHECK(read_text(plain_deck, {"damping.mass=2"}).mass_damping == 2.0);
}

TEST_CASE("read_deck: a grain file gives a grain a row, radius scales the shape") {
    const TempFolder folder;
    folder.write("grains.csv",
                 "# from a scan\n x , y, radius, vx, vy, angle, spin, material\n"
                 "1e-3,2e-3,5e-4,1,-1,0.5,2,glass\r\n\n3e-3,+4e-3,2e-3,0,0,0,0,glass\n");
    const std::string entry = "{shape: disk, file: grains.csv}";
    const Deck deck = read_deck(folder.write(
        "deck.yaml", replaced(plain_deck, "{shape: disk, material: glass, position: [2 mm, 2 mm]}", entry)));
    REQUIRE(deck.grains.size() == 3);
    const GrainDeck& grain = deck.grains[0];
    CHECK(grain.shape == "disk");
    CHECK(grain.position == Numbers3{1e-3, 2e-3, 0});
    CHECK(grain.scale == 0.5);
    CHECK(grain.velocity == Numbers3{1, -1, 0});
    CHECK(grain.angle[2] == 0.5);
    CHECK(grain.spin[2] == 2.0);
    CHECK(grain.place.line == 3);
    CHECK(deck.grains[1].position[1] == 4e-3);
    CHECK(deck.grains[1].scale == 2.0);
    CHECK(deck.grains[2].position[0] == 5e-3);
}

TEST_CASE("read_deck: an array gives the same grains for the same seed") {
    const auto read_array = [](const char* more) {
        const std::string array =
            std::string("array: {counts: [3, 2], origin: [1 mm, 2 mm], step: [2 mm, 3 mm]") + more;
        return read_text(replaced(plain_deck, "position: [2 mm, 2 mm]", array + "}")).grains;
    };
    const std::vector<GrainDeck> plain = read_array("");
    REQUIRE(plain.size() == 7);
    CHECK(plain[1].position == Numbers3{1e-3 + 1 * 2e-3, 2e-3, 0});
    CHECK(plain[5].position == Numbers3{1e-3 + 2 * 2e-3, 2e-3 + 3e-3, 0});
    CHECK(plain[5].scale == 1.0);
    const std::vector<GrainDeck> first = read_array(", jitter: 0.2, scale: [0.5, 2], seed: 7");
    const std::vector<GrainDeck> again = read_array(", jitter: 0.2, scale: [0.5, 2], seed: 7");
    const std::vector<GrainDeck> other = read_array(", jitter: 0.2, scale: [0.5, 2], seed: 8");
    bool all_moved = true;
    for (std::size_t i = 0; i < 6; ++i) {
        CHECK(first[i].position == again[i].position);
        CHECK(first[i].scale == again[i].scale);
        CHECK(std::abs(first[i].position[0] - plain[i].position[0]) <= 0.2 * 2e-3);
        CHECK(std::abs(first[i].position[1] - plain[i].position[1]) <= 0.2 * 3e-3);
        CHECK(first[i].scale >= 0.5);
        CHECK(first[i].scale < 2.0);
        all_moved = all_moved && first[i].position != other[i].position && first[i].scale != other[i].scale;
    }
    CHECK(all_moved);
    // The first numbers of mt19937_64 with seed 7 are part of the format: a deck means the same for ever.
    std::mt19937_64 bits(7);
    const double u = static_cast<double>(bits() >> 11) / 9007199254740992.0;
    CHECK(first[0].position[0] == 1e-3 + 0.2 * (2 * u - 1) * 2e-3);
}

TEST_CASE("read_deck: polygons are turned counter-clockwise") {
    const std::string polygon = replaced(plain_deck, "type: disk\n    filling: rings\n    radius: 1 mm",
                                         "type: polygon\n    vertices: [[0, 0], [0, 1 mm], [1 mm, 0]]");
    const ShapeDeck shape = read_text(polygon).shapes[0];
    REQUIRE(shape.vertices.size() == 3);
    CHECK(shape.vertices[0] == std::array<double, 2>{1e-3, 0});
    CHECK(shape.vertices[2] == std::array<double, 2>{0, 0});
}

TEST_CASE("read_deck: a mesh is found beside the deck, and from anywhere once resolved") {
    const TempFolder folder, elsewhere;
    folder.write("grain.msh", "$MeshFormat\n");
    const std::string text =
        replaced(plain_deck, "type: disk\n    filling: rings\n    radius: 1 mm\n    spacing: 0.1 mm",
                 "type: mesh\n    file: grain.msh\n    unit: 1 mm");
    const Deck deck = read_deck(folder.write("deck.yaml", text));
    CHECK(deck.shapes[0].unit == 1e-3);
    CHECK(std::filesystem::path(deck.shapes[0].file).is_absolute());
    const Deck again = read_deck(elsewhere.write("deck.yaml", resolved_yaml(deck)));
    CHECK(again.shapes[0].file == deck.shapes[0].file);
}

TEST_CASE("resolved_yaml: reads back to the same deck") {
    const TempFolder folder;
    folder.write("grains.csv", "x,y,scale\n0.001,0.0023456789,1.1\n0.003,0.004,0.7\n");
    const std::string with_file = replaced(plain_deck, "position: [2 mm, 2 mm]", "file: grains.csv");
    const std::string with_array =
        replaced(plain_deck, "position: [2 mm, 2 mm]",
                 "array: {counts: [3, 2], origin: [1 mm, 2 mm], step: [2 mm, 3 mm], "
                 "jitter: 0.3, scale: [0.5, 1.7], seed: 3}");
    const std::string odd_title =
        replaced(plain_deck, "Two disks", R"("tab\t, \"quotes\", back\\slash, # and: x")");
    for (const std::string& text : {plain_deck, full_deck, with_file, with_array, odd_title}) {
        const Deck deck = read_deck(folder.write("deck.yaml", text));
        const std::string resolved = resolved_yaml(deck);
        CAPTURE(resolved);
        const Deck again = read_deck(folder.write("resolved.yaml", resolved));
        CHECK(resolved_yaml(again) == resolved);
        CHECK(again.title == deck.title);
        CHECK(again.gravity == deck.gravity);
        CHECK(again.grid.extent == deck.grid.extent);
        REQUIRE(again.grains.size() == deck.grains.size());
        for (std::size_t i = 0; i < deck.grains.size(); ++i) {
            CHECK(again.grains[i].position == deck.grains[i].position);
            CHECK(again.grains[i].scale == deck.grains[i].scale);
        }
        for (std::size_t i = 0; i < deck.walls.size(); ++i)
            CHECK(again.walls[i].normal == deck.walls[i].normal);
    }
}

TEST_CASE("deck_hash: tells resolved decks apart, by every section") {
    const std::string plain = deck_hash(read_text(plain_deck));
    CHECK(plain.size() == 16);
    CHECK(deck_hash(read_text(plain_deck, {"params.unused=2"})) == plain);
    for (const char* change :
         {"time.end=2 ms", "contact.friction=0.2", "compute.kernel=single", "output.vtp=true"})
        CHECK_MESSAGE(deck_hash(read_text(plain_deck, {change})) != plain, change);
}
