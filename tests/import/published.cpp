// Decks published with PeriDEM 0.1.0: they become decks of ours, with every particle where PeriDEM has it.
#include <cmath>

#include "src/sim/scene.hpp"
#include "tests/import/peridem_files.hpp"

namespace quern::test {

namespace {

namespace fs = std::filesystem;

const fs::path published = "tests/import/peridem_0.1.0", compression = "tests/benchmark/compression_502";

std::string contents(const fs::path& path) {
    std::ostringstream text;
    text << std::ifstream(path).rdbuf();
    REQUIRE_MESSAGE(!text.str().empty(), path.string());
    return text.str();
}

/// Nodes of a mesh in the order of their numbers.
std::vector<Vec<2>> nodes_of(const fs::path& path) {
    std::istringstream file(contents(path));
    std::string word;
    while (file >> word && word != "$Nodes") {
    }
    int n = 0;
    file >> n;
    std::vector<Vec<2>> nodes;
    for (int i = 0; i < n; ++i) {
        double tag = 0.0, x = 0.0, y = 0.0, z = 0.0;
        file >> tag >> x >> y >> z;
        nodes.emplace_back(x, y);
    }
    return nodes;
}

/// Largest distance of a particle of grain `id` from place + scale R(angle) X.
double misplacement(const Scene<2>& scene, int id, const fs::path& mesh, const Vec<2>& place, double scale,
                    double angle) {
    const std::vector<Vec<2>> nodes = nodes_of(mesh);
    const Grain<2>& grain = scene.grains[scene.grain_of_id[static_cast<std::size_t>(id)]];
    REQUIRE(grain.count == static_cast<int>(nodes.size()));
    const double c = std::cos(angle), s = std::sin(angle);
    double error = 0.0;
    for (int i = 0; i < grain.count; ++i) {
        const Vec<2>& X = nodes[static_cast<std::size_t>(i)];
        const Vec<2> x = place + scale * Vec<2>(c * X[0] - s * X[1], s * X[0] + c * X[1]);
        error = std::max(error, (scene.particles.x[grain.first + i] - x).norm());
    }
    return error;
}

}  // namespace

TEST_CASE("Published deck: two disks") {
    const TempFolder folder;
    const std::string text = contents(published / "circ_damp.yaml");
    for (const char* file : {"mesh_cir_1_0.msh", "mesh_cir_2_0.msh", "particle_locations_0.csv"})
        folder.write(file, contents(published / file));
    const std::string deck_file = folder.write("deck.yaml", "") + ".new";
    const ImportReport report =
        import_peridem({folder.write("input_0.yaml", text), deck_file, ImportedHorizon::absolute, false});
    CHECK(report.n_bodies == 2);
    CHECK(report.differs.empty());
    const Deck deck = read_deck(deck_file);
    CHECK(deck.contact.method == ContactMethodKind::node_pair);
    CHECK(deck.contact.node_pair.damping == NodePairDamping::centres);
    CHECK(deck.contact.node_pair.restitution == 0.9);
    CHECK(deck.contact.node_pair.damping_factor == 100.0);
    CHECK(deck.contact.node_pair.stiffness == 1.591549e24);
    CHECK(deck.time.step == doctest::Approx(2e-7).epsilon(1e-15));
    CHECK(deck.materials.size() == 1);
    const auto scene = make_scene<2>(deck);
    CHECK(misplacement(*scene, 0, published / "mesh_cir_1_0.msh", {1e-3, 1e-3}, 1.0, 0.0) < 1e-17);
    // measured 4.5e-19, bound 1e-17 [m]
    CHECK(misplacement(*scene, 1, published / "mesh_cir_2_0.msh", {1e-3, 3.6e-3}, 1.0, 1.570796) < 1e-17);
    set_initial_velocities(deck, *scene);
    CHECK(scene->particles.v[scene->grains[1].first][1] == -8.944272e-2);
}

TEST_CASE("Published deck: compression, with its walls and sizes") {
    const TempFolder folder;
    for (const char* file : {"circle.msh", "hexagon.msh"})
        folder.write(file == std::string("circle.msh") ? "mesh_particle_1_0.msh" : "mesh_particle_2_0.msh",
                     contents(compression / file));
    // The real walls: a U and a lid that touches it along both sides. Here a floor and a lid at one edge of
    // it.
    folder.write("mesh_rigid_wall_0.msh", block_mesh(-0.82e-3, -0.82e-3, 69.32e-3, -0.22e-3, 200, 2));
    folder.write("mesh_moving_wall_0.msh", block_mesh(-0.22e-3, -0.22e-3, 0.5e-3, 0.38e-3, 4, 3));
    folder.write("particle_locations_0.csv",
                 "i, x, y, z, r, o\n"
                 "0, 0.067190, 0.001249, 0.000000, 0.000949, 2.414390\n"
                 "1, 0.065125, 0.004202, 0.000000, 0.000902, 0.231303\n"
                 "0, 0.062931, 0.001243, 0.000000, 0.000943, 4.178628\n"
                 "1, 0.060731, 0.001253, 0.000000, 0.000949, 5.000000\n");
    const std::string text = contents(published / "compression_502.yaml");
    const std::string deck_file = folder.write("deck.yaml", "") + ".new";
    const ImportReport report =
        import_peridem({folder.write("input_0.yaml", text), deck_file, ImportedHorizon::absolute, false});
    CHECK(report.n_bodies == 6);
    CHECK(report.n_shapes == 6);
    CHECK(report.differs.size() == 2);  // Output_Criteria, Time_Steps: 1
    const Deck deck = read_deck(deck_file);
    CHECK(deck.materials.size() == 1);
    CHECK(deck.time.step == 0.0);
    CHECK(deck.grains[4].wall);
    CHECK(deck.grains[5].wall);
    CHECK_FALSE(deck.grains[3].wall);
    // Wall_List counts walls: the second one sinks, and is free to move sideways.
    REQUIRE(deck.constraints.size() == 2);
    CHECK(deck.constraints[0].grains == std::vector<int>{4});
    CHECK(deck.constraints[1].grains == std::vector<int>{5});
    CHECK_FALSE(deck.constraints[1].velocity[0]);
    CHECK((*deck.constraints[1].velocity[1])(0.03) == -0.06);
    const auto scene = make_scene<2>(deck);
    const double errors[] = {
        misplacement(*scene, 0, compression / "circle.msh", {0.067190, 0.001249}, 0.949, 2.414390),
        misplacement(*scene, 1, compression / "circle.msh", {0.062931, 0.001243}, 0.943, 4.178628),
        misplacement(*scene, 3, compression / "hexagon.msh", {0.060731, 0.001253}, 0.949, 5.0)};
    for (const double error : errors) CHECK(error < 1e-16);  // measured 1.4e-17, bound 1e-16 [m]

    // One shape a zone, scaled: the same places.
    import_peridem({folder.write("input_0.yaml", text), deck_file, ImportedHorizon::scaled, true});
    const Deck scaled = read_deck(deck_file);
    CHECK(scaled.shapes.size() == 4);
    const auto same = make_scene<2>(scaled);
    CHECK(misplacement(*same, 3, compression / "hexagon.msh", {0.060731, 0.001253}, 0.949, 5.0) < 1e-16);
}

}  // namespace quern::test
