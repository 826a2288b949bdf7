// A small PeriDEM deck on disk for the tests of its import: grains off the origin of their mesh, and a wall.
#pragma once

#include <doctest/doctest.h>

#include <charconv>
#include <sstream>

#include "grid/error.hpp"
#include "src/deck/tree.hpp"
#include "src/import/import_peridem.hpp"
#include "tests/deck/deck_files.hpp"

namespace quern::test {

/// A gmsh mesh, version 2.2: nx by ny squares over [x0, x1] x [y0, y1], with a point and lines of its outline
/// and a name for its inside, as published meshes have them.
inline std::string block_mesh(double x0, double y0, double x1, double y1, int nx, int ny) {
    std::string text =
        "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n2 1 \"a\"\n$EndPhysicalNames\n$Nodes\n";
    text += fmt::format("{}\n", (nx + 1) * (ny + 1));
    const auto node = [&](int i, int j) { return 1 + i + j * (nx + 1); };
    for (int j = 0; j <= ny; ++j)
        for (int i = 0; i <= nx; ++i)
            text += fmt::format("{} {} {} 0\n", node(i, j), x0 + (x1 - x0) * i / nx, y0 + (y1 - y0) * j / ny);
    text += fmt::format("$EndNodes\n$Elements\n{}\n1 15 2 0 1 1\n2 1 2 0 1 1 2\n", nx * ny + 2);
    int tag = 2;
    for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i)
            text += fmt::format("{} 3 2 1 1 {} {} {} {}\n", ++tag, node(i, j), node(i + 1, j),
                                node(i + 1, j + 1), node(i, j + 1));
    return text + "$EndElements\n";
}

/// A box of n^3 bricks from the origin to (x, y, z).
inline std::string brick_mesh(double x, double y, double z, int n) {
    const auto node = [&](int i, int j, int k) { return 1 + i + (n + 1) * (j + (n + 1) * k); };
    std::string text =
        fmt::format("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n{}\n", (n + 1) * (n + 1) * (n + 1));
    for (int k = 0; k <= n; ++k)
        for (int j = 0; j <= n; ++j)
            for (int i = 0; i <= n; ++i)
                text += fmt::format("{} {} {} {}\n", node(i, j, k), x * i / n, y * j / n, z * k / n);
    text += fmt::format("$EndNodes\n$Elements\n{}\n", n * n * n);
    int tag = 0;
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i)
                text += fmt::format("{} 5 2 1 1 {} {} {} {} {} {} {} {}\n", ++tag, node(i, j, k),
                                    node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k),
                                    node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1),
                                    node(i, j + 1, k + 1));
    return text + "$EndElements\n";
}

/// Two zones of grains and one wall. Lines are counted by the tests of messages.
inline const std::string peridem_deck = R"(Model:
  Dimension: 2
  Discretization_Type:
    Spatial: finite_difference
    Time: central_difference
  Final_Time: 1.000000e-02
  Time_Steps: 100000
Container:
  Geometry:
    Type: rectangle
    Parameters: [0.0, 0.0, 0.0, 2.0e-02, 1.0e-02, 0.0]
Zone:
  Zones: 3
  Zone_1:
    Is_Wall: false
  Zone_2:
    Is_Wall: false
  Zone_3:
    Is_Wall: true
Particle:
  Test_Name: small
  Zone_1:
    Type: circle
    Parameters: [1.0e-03, 0.0, 0.0, 0.0]
  Zone_2:
    Type: hexagon
    Parameters: [1.0e-03, 0.0, 0.0, 0.0]
  Zone_3:
    Type: rectangle
    Parameters: [0.0, 0.0, 0.0, 2.0e-02, 1.0e-03, 0.0]
    All_Dofs_Constrained: true
    Create_Particle_Using_ParticleZone_GeomObject: true
Particle_Generation:
  From_File: particles.csv
  File_Data_Type: loc_rad_orient
Mesh:
  Zone_1:
    File: first.msh
  Zone_2:
    File: second.msh
  Zone_3:
    File: wall.msh
Contact:
  Zone_11:
    Contact_Radius_Factor: 9.5e-01
    Damping_On: false
    Friction_On: false
    Kn: 2.0e+22
    Kn_Factor: 5.0
  Zone_12:
    Copy_Contact_Data: [1, 1]
  Zone_13:
    Contact_Radius: 1.0e-04
    Friction_On: true
    V_Max: 4.0e+11
    Delta_Max: 2.0
    Epsilon: 0.9
    Friction_Coeff: 0.3
    Beta_n_Factor: 100.0
  Zone_22:
    Copy_Contact_Data: [1, 1]
  Zone_23:
    Copy_Contact_Data: [1, 3]
  Zone_33:
    Contact_Radius_Factor: 9.5e-01
    Kn: 0.0
    Epsilon: 0.9
    Friction_Coeff: 0.3
Neighbor:
  Update_Criteria: simple_all
  Search_Factor: 5.0
  Search_Interval: 40
Material:
  Zone_1:
    Type: PDState
    Horizon: 6.0e-04
    Density: 1.2e+03
    Compute_From_Classical: true
    K: 2.16e+07
    G: 1.296e+07
    Gc: 50.0
    Influence_Function:
      Type: 1
  Zone_2:
    Copy_Material_Data: 1
  Zone_3:
    Type: PDState
    Horizon: 5.0e-04
    Density: 2.0e+03
    E: 1.0e+08
    Poisson_Ratio: 0.25
    KIc: 1.0e+05
Force_BC:
  Gravity: [0.0, -10.0, 0.0]
IC:
  Constant_Velocity:
    Velocity_Vector: [0.0, -0.5, 0.0]
    Particle_List: [1]
Output:
  Path: ../out/
  Tags:
    - Displacement
  Output_Interval: 1000
  Test_Output_Interval: 100
HPX:
  Partitions: 1
)";

/// Sizes 1 and 1.5 mm; the second row belongs to zone 2, which comes last.
inline const std::string peridem_particles =
    "i, x, y, z, r, o\n"
    "0, 0.003, 0.006, 0.0, 0.001, 0.0\n"
    "1, 0.013, 0.006, 0.0, 0.0015, 0.5\n"
    "0, 0.008, 0.006, 0.0, 0.0015, 1.570796\n";

/// Files of a PeriDEM deck and what becomes of them, in a folder that vanishes.
class PeridemFiles {
  public:
    PeridemFiles() {
        folder.write("first.msh", block_mesh(0.0, 0.0, 2e-3, 1e-3, 8, 4));
        folder.write("second.msh", block_mesh(-1e-3, -1e-3, 1e-3, 1e-3, 8, 8));
        folder.write("wall.msh", block_mesh(0.0, 0.0, 2e-2, 1e-3, 80, 4));
        folder.write("particles.csv", peridem_particles);
        input = folder.write("input_0.yaml", peridem_deck);
        output = std::filesystem::path(input).parent_path() / "quern" / "deck.yaml";
    }

    ImportReport import(const std::string& text, ImportedHorizon horizon = ImportedHorizon::absolute,
                        bool force = true) const {
        folder.write("input_0.yaml", text);
        return import_peridem({input, output.string(), horizon, force});
    }
    /// The deck made of a PeriDEM deck; it is one that `quern check` accepts.
    Node tree(const std::string& text, ImportedHorizon horizon = ImportedHorizon::absolute) const {
        import(text, horizon);
        CHECK_NOTHROW(read_deck(output.string()));
        return read_tree(output.string());
    }
    std::string text() const {
        std::ostringstream all;
        all << std::ifstream(output).rdbuf();
        return all.str();
    }
    std::string error(const std::string& text) const {
        try {
            import(text);
        } catch (const InputError& refused) {
            return refused.what();
        }
        FAIL_CHECK("no error");
        return {};
    }

    TempFolder folder;
    std::string input;
    std::filesystem::path output;
};

/// A node by its path, "grains.0.position.1".
inline const Node& at(const Node& root, const std::string& path) {
    const Node* node = &root;
    std::istringstream names(path);
    for (std::string name; std::getline(names, name, '.');) {
        const Node* next = nullptr;
        if (node->kind == Node::Kind::list) {
            const std::size_t i = std::stoul(name);
            if (i < node->items.size()) next = &node->items[i];
        } else {
            next = node->find(name);
        }
        REQUIRE_MESSAGE(next, path);
        node = next;
    }
    return *node;
}

inline double number_at(const Node& root, const std::string& path) {
    return std::stod(at(root, path).text);
}

inline bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace quern::test
