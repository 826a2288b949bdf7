// PeriDEM decks that cannot be imported: one message that names file, line and key.
#include "tests/import/peridem_files.hpp"

namespace quern::test {

namespace {

struct Bad {
    const char *from, *to, *message;
};

}  // namespace

TEST_CASE("Bad PeriDEM deck: a message for each slip") {
    const PeridemFiles files;
    const Bad cases[] = {
        {"  Final_Time:", "  Final_Tme:", "input_0.yaml:6: Model.Final_Tme: got an unknown key"},
        {"  Final_Time:", "  Final_Tme:", "(did you mean Final_Time?)"},
        {"Neighbor:\n", "Neighbour:\n", "input_0.yaml:69: Neighbour: got an unknown key"},
        {"    Density: 1.2e+03\n", "    Densty: 1.2e+03\n", "(did you mean Density?)"},
        {"Time_Steps: 100000", "Time_Steps: 0", "input_0.yaml:7: Model.Time_Steps: got '0', expected"},
        {"Dimension: 2", "Dimension: 4", "input_0.yaml:2: Model.Dimension: got '4'"},
        {"Spatial: finite_difference", "Spatial: weak_finite_element",
         "input_0.yaml:4: Model.Discretization_Type.Spatial: got 'weak_finite_element'"},
        {"  Zones: 3", "  Zones: 4", "input_0.yaml:12: Zone: got no Zone_4"},
        {"  Zones: 3", "  Zones: 2", "input_0.yaml:18: Zone.Zone_3: got an unknown key"},
        {"    File: wall.msh", "    File: wal.msh", "input_0.yaml:42: Mesh.Zone_3.File: got 'wal.msh'"},
        {"    File: wall.msh", "    File: particles.csv", "expected a gmsh mesh (.msh)"},
        {"    File: wall.msh", "    File: wall.vtu", "write it with gmsh"},
        {"    File: wall.msh", "    CreateMesh: {Flag: true, Info: uniform}",
         "a mesh that PeriDEM would make"},
        {"From_File: particles.csv", "From_File: particle.csv",
         "input_0.yaml:34: Particle_Generation.From_File: got"},
        {"  Zone_12:\n    Copy_Contact_Data: [1, 1]\n", "", "input_0.yaml:43: Contact: got no Zone_12"},
        {"Copy_Contact_Data: [1, 3]", "Copy_Contact_Data: [3, 3]",
         "input_0.yaml:63: Contact.Zone_23.Copy_Contact_Data: got a list, expected two zones"},
        {"    Damping_On: false\n", "", "Contact.Zone_11: got no Epsilon"},
        {"    Kn: 2.0e+22\n", "    Kn: 0\n", "Contact.Zone_11.Kn: got '0'"},
        {"    Kn: 2.0e+22\n", "", "Contact.Zone_11: got no V_Max"},
        {"    Damping_On: false\n", "    Damping_On: maybe\n", "got 'maybe', expected true or false"},
        {"Type: PDState", "Type: PMBBond", "input_0.yaml:75: Material.Zone_1.Type: got 'PMBBond'"},
        {"    K: 2.16e+07\n", "", "Material.Zone_1: got 1 of the moduli, expected exactly two"},
        {"Copy_Material_Data: 1", "Copy_Material_Data: 2", "expected the number of a zone before 2"},
        {"      Type: 1\n", "      Type: 2\n", "Influence_Function.Parameters: got no Parameters"},
        {"      Type: 1\n", "      Type: 1\n      Parameters: [1, -0.5]\n", "expected a and -a"},
        {"    Particle_List: [1]", "    Particle_List: [7]", "got body 7, expected a number from 0 to 3"},
        {"HPX:\n", "Restart:\n  File: output_6.vtu\n  Step: 6\nHPX:\n", "Restart: got a restart"},
        {"    Parameters: [1.0e-03, 0.0, 0.0, 0.0]\n  Zone_2", "  Zone_2",
         "expected Parameters that begin with the size of the meshed grain"},
        {"File_Data_Type: loc_rad_orient", "File_Data_Type: rad_loc", "one of loc_rad, loc_rad_orient"},
    };
    for (const Bad& bad : cases) {
        const std::string message = files.error(replaced(peridem_deck, bad.from, bad.to));
        CHECK_MESSAGE(contains(message, bad.message), message << " WANTED " << std::string(bad.message));
        CHECK_FALSE(std::filesystem::exists(files.output));
    }
}

TEST_CASE("Bad table of grains: a message for each slip") {
    const PeridemFiles files;
    const Bad cases[] = {
        {"i, x", "I, X", ""},  // names in capitals are no slip
        {"i, x, y", "i, x, t", "particles.csv:1: got no column y, expected the columns i, x, y, r, o"},
        {"r, o", "r, w", "got no column o"},
        {"1, 0.013", "2, 0.013", "particles.csv:3: column i: got zone 2, expected a zone of grains"},
        {"1, 0.013", "3, 0.013",
         "particles.csv:3: column i: got zone 3, expected a whole number from 0 to 2"},
        {"1, 0.013", "0.5, 0.013", "column i: got zone 0.5"},
        {"0.013", "left", "particles.csv:3: column x: got 'left', expected a number"},
        {"0.0015, 0.5", "-0.0015, 0.5", "particles.csv:3: column r: got -0.0015, expected a number > 0"},
        {"0.0015, 0.5", "0.0015", "particles.csv:3: got 5 cells, expected 6 cells as in the header"},
    };
    for (const Bad& bad : cases) {
        files.folder.write("particles.csv", replaced(peridem_particles, bad.from, bad.to));
        if (std::string(bad.message).empty()) {
            CHECK_NOTHROW(files.import(peridem_deck));
            continue;
        }
        const std::string message = files.error(peridem_deck);
        CHECK_MESSAGE(contains(message, bad.message), message << " WANTED " << std::string(bad.message));
    }
    files.folder.write("particles.csv", "i, x, y, z, r, o\n");
    CHECK(contains(files.error(peridem_deck), "particles.csv: got no rows"));
}

TEST_CASE("Bad mesh: the message names the deck's key and the file") {
    const PeridemFiles files;
    files.folder.write("second.msh", "$MeshFormat\n4.0 0 8\n$EndMeshFormat\n");
    const std::string message = files.error(peridem_deck);
    CHECK(contains(message, "input_0.yaml:40: Mesh.Zone_2.File"));
    CHECK(contains(message, "second.msh' of mesh version '4.0'"));
}

}  // namespace quern::test
