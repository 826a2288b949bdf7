// A whole PeriDEM deck: what each of its sections becomes.
#include <cmath>
#include <numbers>
#include <random>

#include "src/deck/tree.hpp"
#include "tests/import/peridem_files.hpp"

namespace quern::test {

TEST_CASE("Imported deck: time, gravity, output and the keys that are not used") {
    const PeridemFiles files;
    const Node deck = files.tree(peridem_deck);
    CHECK(number_at(deck, "dimension") == 2);
    CHECK(number_at(deck, "time.end") == 0.01);
    CHECK(number_at(deck, "time.step") == 1e-7);
    CHECK(number_at(deck, "gravity.1") == -10.0);
    CHECK(number_at(deck, "output.interval") == 1e-4);
    CHECK(number_at(deck, "output.history_interval") == 1e-5);
    CHECK(at(deck, "output.track").text == "all");
    CHECK(contains(files.text(), "# Not used: HPX"));
    for (const char* key : {"Neighbor.Search_Factor", "Output.Tags", "Output.Path"})
        CHECK_MESSAGE(contains(files.text(), key), key);
    CHECK_FALSE(contains(files.text(), "Differs"));
}

TEST_CASE("Imported deck: zones of equal matter and contact share a material") {
    const PeridemFiles files;
    const Node deck = files.tree(peridem_deck);
    CHECK(at(deck, "materials").names == std::vector<std::string>{"zone_1_2", "zone_3"});
    CHECK(at(deck, "materials.zone_1_2.model").text == "peridem");
    CHECK(number_at(deck, "materials.zone_1_2.density") == 1200.0);
    CHECK(number_at(deck, "materials.zone_1_2.bulk_modulus") == 2.16e7);
    CHECK(number_at(deck, "materials.zone_1_2.shear_modulus") == 1.296e7);
    CHECK(number_at(deck, "materials.zone_1_2.horizon") == 6e-4);
    CHECK(number_at(deck, "materials.zone_1_2.fracture_energy") == 50.0);
    CHECK(at(deck, "materials.zone_1_2.influence").text == "conical");
    CHECK(number_at(deck, "materials.zone_3.young_modulus") == 1e8);
    CHECK(number_at(deck, "materials.zone_3.poisson_ratio") == 0.25);
    CHECK(number_at(deck, "materials.zone_3.fracture_energy") == 100.0);  // KIc^2/E
    CHECK(at(deck, "materials.zone_3.influence").text == "constant");

    // A zone that differs in matter, or in contact only, has its own.
    const Node apart = files.tree(replaced(peridem_deck, "    Copy_Material_Data: 1\n",
                                           "    Type: PDState\n    Horizon: 6.0e-04\n    Density: 1.3e+03\n"
                                           "    K: 2.16e+07\n    G: 1.296e+07\n"));
    CHECK(at(apart, "materials").names == std::vector<std::string>{"zone_1", "zone_2", "zone_3"});
    CHECK(at(apart, "materials.zone_2").find("fracture_energy") == nullptr);
    const Node touching = files.tree(replaced(peridem_deck, "  Zone_22:\n    Copy_Contact_Data: [1, 1]\n",
                                              "  Zone_22:\n    Copy_Contact_Data: [1, 3]\n"));
    CHECK(at(touching, "materials").names == std::vector<std::string>{"zone_1", "zone_2", "zone_3"});
}

TEST_CASE("Imported deck: contact of pairs of zones") {
    const PeridemFiles files;
    const Node deck = files.tree(peridem_deck);
    CHECK(at(deck, "contact.method").text == "node_pair");
    CHECK(number_at(deck, "contact.friction") == 0.0);
    CHECK(number_at(deck, "contact.node_pair.radius_factor") == 0.95);
    CHECK(number_at(deck, "contact.node_pair.stiffness") == 1e23);   // Kn Kn_Factor
    CHECK(number_at(deck, "contact.node_pair.restitution") == 1.0);  // Damping_On: false
    CHECK(at(deck, "contact.node_pair.damping").text == "centres");
    CHECK(at(deck, "contact.node_pair.friction_law").text == "published");
    // Walls do not touch walls: no entry for them.
    REQUIRE(at(deck, "contact.pairs").items.size() == 1);
    CHECK(at(deck, "contact.pairs.0.between.0").text == "zone_1_2");
    CHECK(at(deck, "contact.pairs.0.between.1").text == "zone_3");
    CHECK(number_at(deck, "contact.pairs.0.friction") == 0.3);
    CHECK(number_at(deck, "contact.pairs.0.contact_radius") == 1e-4);
    CHECK(number_at(deck, "contact.pairs.0.stiffness") == 4e22);  // (V_Max / Delta_Max)^2
    CHECK(number_at(deck, "contact.pairs.0.restitution") == 0.9);
    CHECK(number_at(deck, "contact.pairs.0.damping_factor") == 100.0);
}

TEST_CASE("Imported deck: a shape for each size, or one that is scaled") {
    const PeridemFiles files;
    const Node deck = files.tree(peridem_deck);
    CHECK(at(deck, "shapes").names ==
          std::vector<std::string>{"zone_1", "zone_1_1500um", "zone_2_1500um", "zone_3"});
    CHECK(number_at(deck, "shapes.zone_1_1500um.unit") == 1.5);
    CHECK(at(deck, "shapes.zone_1").find("unit") == nullptr);
    CHECK(at(deck, "shapes.zone_3.file").text == "wall.msh");
    CHECK(at(deck, "grains.1.shape").text == "zone_1_1500um");
    CHECK(at(deck, "grains.1").find("scale") == nullptr);

    const Node scaled = files.tree(peridem_deck, ImportedHorizon::scaled);
    CHECK(at(scaled, "shapes").names == std::vector<std::string>{"zone_1", "zone_2", "zone_3"});
    CHECK(number_at(scaled, "grains.1.scale") == 1.5);
    CHECK(contains(files.text(), "# - the horizon of a grain grows with its size"));

    // Horizon_Mesh_Ratio is one that grows with the grain in PeriDEM, too.
    const Node ratio = files.tree(replaced(peridem_deck, "Horizon: 6.0e-04", "Horizon_Mesh_Ratio: 3"));
    CHECK(at(ratio, "materials").names == std::vector<std::string>{"zone_1", "zone_2", "zone_3"});
    CHECK(number_at(ratio, "materials.zone_1.horizon") == doctest::Approx(7.5e-4).epsilon(1e-12));
    CHECK(number_at(ratio, "grains.1.scale") == 1.5);
    CHECK_FALSE(contains(files.text(), "Differs"));
}

TEST_CASE("Imported deck: the origin of the mesh goes where PeriDEM puts it") {
    const PeridemFiles files;
    const Node deck = files.tree(peridem_deck);
    // Zone by zone: both grains of zone 1 first. Centre of mass of its mesh: (1, 0.5) mm; of the wall's: (10,
    // 0.5).
    CHECK(at(deck, "grains").items.size() == 4);
    struct Place {
        double x, y, angle;
    };
    const double c = std::cos(1.570796), s = std::sin(1.570796);
    const Place expected[] = {{0.004, 0.0065, 0.0},
                              {0.008 + 1.5e-3 * (c - 0.5 * s), 0.006 + 1.5e-3 * (s + 0.5 * c), 1.570796},
                              {0.013, 0.006, 0.5},
                              {0.01, 0.0005, 0.0}};
    double error = 0.0;
    for (int i = 0; i < 4; ++i) {
        const std::string grain = fmt::format("grains.{}.", i);
        error = std::max({error, std::abs(number_at(deck, grain + "position.0") - expected[i].x),
                          std::abs(number_at(deck, grain + "position.1") - expected[i].y)});
        if (expected[i].angle != 0.0) CHECK(number_at(deck, grain + "angle") == expected[i].angle);
    }
    CHECK(error < 3e-16);  // measured 3.2e-17, bound 3e-16 [m]
    CHECK(number_at(deck, "grains.1.velocity.1") == -0.5);
    CHECK(at(deck, "grains.0").find("velocity") == nullptr);
    CHECK(at(deck, "grains.3.wall").text == "true");
    CHECK(at(deck, "grains.0").find("wall") == nullptr);
    // All_Dofs_Constrained
    CHECK(at(deck, "constraints.0.grains.0").text == "3");
    CHECK(at(deck, "constraints.0.velocity.1").text == "0");
}

TEST_CASE("Imported deck: in space, grains turned about z") {
    const PeridemFiles files;
    files.folder.write("first.msh", brick_mesh(2e-3, 1e-3, 4e-3, 4));
    files.folder.write("second.msh", brick_mesh(1e-3, 1e-3, 1e-3, 4));
    files.folder.write("wall.msh", brick_mesh(2e-2, 1e-3, 1e-2, 20));
    files.folder.write("particles.csv",
                       replaced(peridem_particles, "0.013, 0.006, 0.0,", "0.013, 0.006, 0.002,"));
    const std::string solid =
        replaced(replaced(peridem_deck, "Dimension: 2", "Dimension: 3"),
                 "    Type: rectangle\n    Parameters: [0.0, 0.0, 0.0, 2.0e-02, 1.0e-02, 0.0]",
                 "    Type: cuboid\n    Parameters: [0.0, 0.0, 0.0, 2.0e-02, 1.0e-02, 1.0e-02]");
    const Node deck = files.tree(solid);
    CHECK(at(deck, "gravity").items.size() == 3);
    CHECK(at(deck, "constraints.0.velocity").items.size() == 3);
    CHECK(at(deck, "grid.extent").items.size() == 3);
    CHECK(number_at(deck, "grains.2.angle.2") == 0.5);
    // Centre of the mesh of zone 2: 0.5 mm on each axis; the grain is 1.5 times as large.
    const double c = std::cos(0.5), s = std::sin(0.5);
    const double expected[] = {0.013 + 0.75e-3 * (c - s), 0.006 + 0.75e-3 * (s + c), 0.00275};
    for (int a = 0; a < 3; ++a)  // measured 8.7e-19, bound 1e-16 [m]
        CHECK(std::abs(number_at(deck, fmt::format("grains.2.position.{}", a)) - expected[a]) < 1e-16);
    // Cells of two spacings, (1 mm^3 / 125)^(1/3) each.
    CHECK(number_at(deck, "grid.spacing") == doctest::Approx(1.5 * 2.0 * 1e-3 / 5.0).epsilon(0.01));
}

TEST_CASE("Imported deck: many grains go to a table") {
    const PeridemFiles files;
    std::string rows = "i,x,y,z,r,o,extra\n";
    for (int k = 0; k < 30; ++k) rows += fmt::format("{},{},0.006,0,0.0005,0.1,7\n", k % 2, 1e-3 + 1e-3 * k);
    files.folder.write("particles.csv", rows);
    const Node deck = files.tree(peridem_deck);
    CHECK(at(deck, "grains.0.file").text == "deck_grains.csv");
    CHECK(contains(files.text(), "column extra of"));
    std::ifstream table(files.output.parent_path() / "deck_grains.csv");
    std::string line;
    std::getline(table, line);
    CHECK(line.substr(0, 1) == "#");
    std::getline(table, line);
    CHECK(line == "shape,material,x,y,angle,vx,vy");
    std::getline(table, line);
    CHECK(contains(line, "zone_1_500um,zone_1_2,0.0014725"));
    CHECK(contains(line, ",0.1,0,0"));
    std::getline(table, line);
    CHECK(contains(line, ",0.1,0,-0.5"));
    int n = 2;
    while (std::getline(table, line)) ++n;
    CHECK(n == 30);
}

TEST_CASE("Imported deck: angles that PeriDEM draws") {
    const PeridemFiles files;
    const std::string drawn = replaced(peridem_deck, "loc_rad_orient", "loc_rad");
    const Node deck = files.tree(drawn);
    // PeriDEM: std::uniform_real_distribution of std::mt19937(Seed), anew in each zone.
    std::mt19937 bits(1);
    std::uniform_real_distribution<> uniform(0.0, 1.0);
    const double first = 2.0 * std::numbers::pi * uniform(bits),
                 second = 2.0 * std::numbers::pi * uniform(bits);
    CHECK(number_at(deck, "grains.0.angle") == first);
    CHECK(number_at(deck, "grains.1.angle") == second);
    CHECK(number_at(deck, "grains.2.angle") == first);
    const Node seeded =
        files.tree(replaced(drawn, "  Time_Steps: 100000\n", "  Time_Steps: 100000\n  Seed: 7\n"));
    bits.seed(7);
    uniform.reset();
    CHECK(number_at(seeded, "grains.0.angle") == 2.0 * std::numbers::pi * uniform(bits));
    const Node two = files.tree(replaced(drawn, "Test_Name: small", "Test_Name: two_particle"));
    CHECK(at(two, "grains.0").find("angle") == nullptr);
    CHECK(number_at(two, "grains.1.angle") == std::numbers::pi);
}

TEST_CASE("Imported deck: the box holds the container, the bodies and their motions") {
    const PeridemFiles files;
    const Node deck = files.tree(peridem_deck + R"(Displacement_BC:
  Sets: 1
  Set_1:
    Particle_List: [3]
    Direction: [2]
    Time_Function: {Type: linear, Parameters: [-0.8]}
)");
    // The container, 20 by 10 mm, and a wall that sinks by 8 mm.
    for (int a = 0; a < 2; ++a) {
        const std::string axis = fmt::format(".{}", a);
        const double low = number_at(deck, "grid.origin" + axis);
        const double high = low + number_at(deck, "grid.extent" + axis);
        CHECK(low < (a == 0 ? 0.0 : -0.008));
        CHECK(low > (a == 0 ? -0.004 : -0.012));
        CHECK(high > (a == 0 ? 0.02 : 0.01));
        CHECK(high < (a == 0 ? 0.024 : 0.014));
    }
    // Twice the spacing of the finest mesh, (2 mm^2 / 45)^(1/2).
    CHECK(number_at(deck, "grid.spacing") == doctest::Approx(2e-3 * std::sqrt(2.0 / 45.0)).epsilon(0.005));
}

TEST_CASE("Imported deck: a time step that cannot be meant becomes auto, with a note") {
    const PeridemFiles files;
    const Node deck = files.tree(replaced(peridem_deck, "Time_Steps: 100000", "Time_Steps: 1"));
    CHECK(at(deck, "time.step").text == "auto");
    CHECK(at(deck, "output").find("interval") == nullptr);
    CHECK(contains(files.text(), "# - time.step and output: auto, because the step of the deck, 0.01"));
}

TEST_CASE("Imported deck: files of the user are safe") {
    const PeridemFiles files;
    CHECK(files.import(peridem_deck, ImportedHorizon::absolute, false).files.size() == 4);
    // The same files again: nothing to do, nothing to complain of.
    CHECK(files.import(peridem_deck, ImportedHorizon::absolute, false).files.empty());
    const std::string other = replaced(peridem_deck, "Gc: 50.0", "Gc: 60.0");
    CHECK_THROWS_WITH_AS(files.import(other, ImportedHorizon::absolute, false),
                         doctest::Contains("an existing file, expected a new one (--force overwrites it)"),
                         InputError);
    CHECK(contains(files.text(), "fracture_energy: 50"));
    CHECK(files.import(other).files == std::vector<std::string>{files.output.string()});
    CHECK(contains(files.text(), "fracture_energy: 60"));
    CHECK_THROWS_WITH_AS(import_peridem({files.input, files.input, ImportedHorizon::absolute, true}),
                         doctest::Contains("the file that is imported"), InputError);
}

}  // namespace quern::test
