#include "src/import/peridem_deck.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "grid/error.hpp"

namespace quern {
namespace {

const SectionKeys root_keys = {
    {"Model", "Restart", "Container", "Zone", "Particle", "Wall", "Particle_Generation", "Mesh", "Contact",
     "Neighbor", "Material", "Force_BC", "Displacement_BC", "IC", "Output"},
    {"Policy", "HPX"}};

void read_model(const Section& root, PeridemDeck& deck) {
    const Section model(
        root, "Model",
        {{"Dimension", "Discretization_Type", "Final_Time", "Time_Steps", "Particle_Sim_Type", "Seed"},
         {"Mesh_Size", "Horizon", "Horizon_h_Ratio", "Quad_Approximation_Order",
          "Populate_ElementNodeConnectivity"}});
    deck.dimension = model.integer("Dimension", {2, 3, false, false, false});
    if (model.has("Discretization_Type")) {
        const Section how(model, "Discretization_Type", {{"Spatial", "Time"}, {}});
        if (how.has("Spatial") && how.text("Spatial") != "finite_difference")
            how.refuse("Spatial", "finite_difference", "PeriDEM itself does nothing else with grains");
        if (how.has("Time") && how.word("Time", {"central_difference", "velocity_verlet"}) == 1)
            root.notes().add_difference("time steps: leapfrog instead of velocity Verlet");
    }
    deck.end = model.number("Final_Time", positive);
    deck.n_steps = model.integer("Time_Steps", at_least(1));
    deck.step = deck.end / deck.n_steps;
    if (model.has("Seed")) deck.seed = model.integer("Seed", not_negative);
    if (model.has("Particle_Sim_Type"))
        model.word("Particle_Sim_Type", {"Multi_Particle", "Single_Particle"});
}

void read_particle_table(const Section& root, PeridemDeck& deck) {
    if (!root.has("Particle_Generation")) return;
    const Section made(root, "Particle_Generation", {{"From_File", "File_Data_Type"}, {}});
    deck.particles =
        (std::filesystem::path(deck.file).parent_path() / made.text("From_File")).lexically_normal().string();
    deck.particles_where = made.where("From_File");
    if (made.has("File_Data_Type"))
        deck.oriented = made.word("File_Data_Type", {"loc_rad", "loc_rad_orient"}) == 1;
}

void read_output(const Section& root, PeridemDeck& deck) {
    if (!root.has("Output")) return;
    const Section output(root, "Output",
                         {{"Output_Interval", "Test_Output_Interval", "Output_Criteria"},
                          {"Path", "Tags", "File_Format", "Perform_Out", "Perform_FE_Out", "Compress_Type",
                           "Debug", "Tag_PP"}});
    const auto interval = [&](const char* name) {
        return output.has(name) ? deck.end * output.integer(name, at_least(1)) / deck.n_steps : 0.0;
    };
    deck.frame_interval = interval("Output_Interval");
    deck.row_interval = interval("Test_Output_Interval");
    if (!output.has("Output_Criteria")) return;
    const Section stop(output, "Output_Criteria", {{"Type"}, {"New_Interval", "Parameters"}});
    root.notes().add_difference(fmt::format(
        "Output.Output_Criteria ({}) is left out: the run goes on to its end", stop.text("Type")));
}

/// The body whose force PeriDEM writes in its compression test; old decks count the walls alone.
void read_test(const Section& root, PeridemDeck& deck) {
    const Section particle(root, "Particle");
    deck.test_name = particle.text_or("Test_Name", "");
    if (!particle.has("Compressive_Test")) return;
    const Section test(particle, "Compressive_Test",
                       {{"Particle_Id", "Wall_Id"}, {"Particle_Force_Direction", "Wall_Force_Direction"}});
    const char* key = test.has("Wall_Id") ? "Wall_Id" : "Particle_Id";
    deck.watched = test.integer(key, not_negative);
    deck.watched_where = test.where(key);
    deck.watched_is_wall = test.has("Wall_Id");
}

}  // namespace

PeridemGeometry read_peridem_geometry(const Section& section) {
    return {section.text("Type"), section.numbers_or_none("Parameters"), section.where("Parameters")};
}

PeridemDeck read_peridem_deck(const std::string& path, ImportNotes& notes) {
    const Node tree = read_tree(path);
    const Cursor at(tree, path);
    const Section root(at, root_keys, notes);
    if (root.has("Restart"))
        throw InputError(root.where("Restart"), "a restart", "a deck that starts at its first step",
                         "import the deck of the first run and give it the time of both");
    PeridemDeck deck;
    deck.file = path;
    read_model(root, deck);
    const Section container(root, "Container", {{"Geometry"}, {}});
    deck.container = read_peridem_geometry(
        Section(container, "Geometry", {{"Type", "Parameters"}, {"Vec_Type", "Vec_Flag"}}));
    read_peridem_zones(root, deck);
    read_test(root, deck);
    read_particle_table(root, deck);
    read_peridem_materials(root, deck);
    read_peridem_contact(root, deck);
    if (root.has("Neighbor")) {
        const Section neighbor(root, "Neighbor",
                               {{}, {"Update_Criteria", "Search_Factor", "Search_Interval"}});
    }
    read_peridem_loads(root, deck);
    read_output(root, deck);
    return deck;
}

}  // namespace quern
