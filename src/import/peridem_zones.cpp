// Zones, the grains and walls in them, their meshes and materials.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>

#include "grid/error.hpp"
#include "src/import/peridem_deck.hpp"

namespace quern {
namespace {

void read_shape(const Section& section, PeridemZone& zone) {
    zone.held = section.flag_or("All_Dofs_Constrained", false);
    zone.as_meshed = section.flag_or("Create_Particle_Using_ParticleZone_GeomObject", false);
    if (!section.has("Type")) return;
    zone.type = section.text("Type");
    const std::vector<double> parameters = section.numbers_or_none("Parameters");
    if (!parameters.empty()) zone.radius = parameters.front();
}

/// The section of walls that decks before 0.2 have.
void read_old_wall(const Section& section, PeridemZone& zone) {
    if (section.word("Type", {"flexible", "rigid"}) == 1 || !section.flag_or("Mesh", false))
        throw InputError(section.where(), "a wall without a mesh", "a wall of Type: flexible with Mesh: true",
                         "a plane is a wall of ours: walls in docs/deck.md");
    zone.held = section.flag_or("All_Dofs_Constrained", false);
    zone.as_meshed = true;
}

void read_mesh(const Section& meshes, const std::string& name, PeridemDeck& deck, PeridemZone& zone) {
    const Section mesh(meshes, name, {{"File", "CreateMesh"}, {"Mesh_Size", "Reference_Particle"}});
    if (mesh.has("CreateMesh")) {
        const Section made(mesh, "CreateMesh", {{"Flag"}, {"Info", "Geometry"}});
        if (made.flag_or("Flag", true))
            throw InputError(made.where(), "a mesh that PeriDEM would make", "File: a gmsh mesh (.msh)",
                             "write it to a file with gmsh");
    }
    const std::string file = mesh.text("File");
    zone.mesh_where = mesh.where("File");
    const std::filesystem::path path =
        (std::filesystem::path(deck.file).parent_path() / file).lexically_normal();
    const std::string extension = path.extension().string();
    if (extension != ".msh")
        mesh.refuse("File", "a gmsh mesh (.msh)",
                    extension == ".vtu" || extension == ".csv"
                        ? "nodes alone have no surface: write it with gmsh"
                        : "");
    if (!std::filesystem::is_regular_file(path))
        mesh.refuse("File", "an existing file", "looked for " + path.string());
    zone.mesh = path.string();
}

/// J of a bond of relative length r: 0: a0; 1: a0 + a1 r; 2: a exp(-r^2/b); a common factor cancels.
std::string read_influence(const Section& section) {
    if (!section.has("Influence_Function")) return "constant";
    const Section influence(section, "Influence_Function", {{"Type", "Parameters"}, {}});
    const std::vector<double> p = influence.numbers_or_none("Parameters");
    switch (influence.integer("Type", {0, 2, false, false, false})) {
        case 0:
            return "constant";
        case 1:
            if (p.size() > 1 && p[1] != -p[0])
                influence.refuse("Parameters", "a and -a, the influence a (1 - r)");
            return "conical";
        default:
            if (p.size() < 2 || std::abs(p[1] - 0.25) > 1e-12)
                influence.refuse("Parameters", "a and 0.25, the influence a exp(-(2 r)^2)",
                                 p.empty() ? "without parameters PeriDEM takes 0.2" : "");
            return "gaussian";
    }
}

PeridemMaterial read_material(const Section& section) {
    PeridemMaterial m;
    if (section.text("Type") != "PDState")
        section.refuse("Type", "PDState", "only the state-based material of PeriDEM can be imported");
    if (!section.flag_or("Compute_From_Classical", true))
        section.refuse("Compute_From_Classical", "true", "moduli, not parameters of a potential");
    m.density = section.number("Density", positive);
    const auto modulus = [&](const char* name, std::optional<double>& value, const Range& range) {
        if (section.has(name)) value = section.number(name, range);
        return value ? 1 : 0;
    };
    const Range ratio{-1.0, 0.5, true, true, false};
    const int given = modulus("K", m.bulk, positive) + modulus("G", m.shear, positive) +
                      modulus("E", m.young, positive) + modulus("Poisson_Ratio", m.poisson, ratio);
    if (given != 2)
        throw InputError(section.where(), fmt::format("{} of the moduli", given),
                         "exactly two of K, G, E, Poisson_Ratio");
    if (section.has("Gc")) m.fracture_energy = section.number("Gc", positive);
    if (!m.fracture_energy && section.has("KIc")) {
        if (!m.young) section.refuse("KIc", "Gc instead, where E is not given", "Gc = KIc^2/E");
        const double toughness = section.number("KIc", positive);
        m.fracture_energy = toughness * toughness / *m.young;
    }
    if (section.has("Horizon_Mesh_Ratio")) m.mesh_ratio = section.number("Horizon_Mesh_Ratio", positive);
    if (m.mesh_ratio == 0.0) m.horizon = section.number("Horizon", positive);
    m.influence = read_influence(section);
    return m;
}

}  // namespace

void read_peridem_zones(const Section& root, PeridemDeck& deck) {
    const Section any_zones(root, "Zone");
    const int n_zones = any_zones.integer("Zones", {1, 1000, false, false, false});
    deck.zones.resize(static_cast<std::size_t>(n_zones));
    const Section zones(root, "Zone", zone_keys(n_zones, {"Zones"}));
    const Section particles(root, "Particle", zone_keys(n_zones, {"Test_Name", "Compressive_Test"}));
    const Section meshes(root, "Mesh", zone_keys(n_zones, {}, {"Mesh_Size"}));
    deck.walls_apart = root.has("Wall");
    for (int z = 0; z < n_zones; ++z) {
        PeridemZone& zone = deck.zones[static_cast<std::size_t>(z)];
        const std::string name = fmt::format("Zone_{}", z + 1);
        const Section about(zones, name, {{"Is_Wall"}, {"Type", "Parameters", "Vec_Type", "Vec_Flag"}});
        zone.wall = about.flag_or("Is_Wall", false);
        if (particles.has(name)) {
            const Section shape(particles, name,
                                {{"Type", "Parameters", "All_Dofs_Constrained",
                                  "Create_Particle_Using_ParticleZone_GeomObject"},
                                 {"Is_Wall", "Vec_Type", "Vec_Flag", "Near_Bd_Nodes_Tol"}});
            read_shape(shape, zone);
        } else if (zone.wall && deck.walls_apart) {
            const Section walls(root, "Wall", zone_keys(n_zones));
            const Section wall(walls, name, {{"Type", "Mesh", "All_Dofs_Constrained"}, {}});
            read_old_wall(wall, zone);
        } else {
            throw InputError(particles.where(), "no " + name, "what the grains of the zone are");
        }
        if (!zone.as_meshed && !(zone.radius > 0.0))
            particles.refuse(name, "Parameters that begin with the size of the meshed grain");
        read_mesh(meshes, name, deck, zone);
    }
}

void read_peridem_materials(const Section& root, PeridemDeck& deck) {
    const Section materials(root, "Material", zone_keys(static_cast<int>(deck.zones.size())));
    const SectionKeys keys{
        {"Type", "Copy_Material_Data", "Horizon", "Horizon_Mesh_Ratio", "Density", "Compute_From_Classical",
         "K", "G", "E", "Poisson_Ratio", "Gc", "KIc", "Influence_Function"},
        {"Is_Plane_Strain", "Lambda", "Mu", "Bond_Potential", "State_Potential"}};
    for (std::size_t z = 0; z < deck.zones.size(); ++z) {
        const Section own(materials, fmt::format("Zone_{}", z + 1), keys);
        if (!own.has("Copy_Material_Data")) {
            deck.zones[z].material = read_material(own);
            continue;
        }
        const int from = own.integer("Copy_Material_Data", at_least(1));
        if (from > static_cast<int>(z))
            own.refuse("Copy_Material_Data", fmt::format("the number of a zone before {}", z + 1));
        deck.zones[z].material = deck.zones[static_cast<std::size_t>(from - 1)].material;
    }
}

}  // namespace quern
