// Sections of the deck that is written: materials, contact, box, loads and constraints.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/deck/names.hpp"
#include "src/import/peridem_motion.hpp"
#include "src/import/peridem_writer.hpp"

namespace quern {
namespace {

/// Nothing tells the zones apart, neither matter nor contact with any zone.
bool alike(const PeridemDeck& deck, std::size_t a, std::size_t b) {
    if (!(deck.zones[a].material == deck.zones[b].material)) return false;
    if (deck.zones[a].material.horizon == 0.0 && deck.zones[a].mesh != deck.zones[b].mesh) return false;
    for (std::size_t k = 0; k < deck.contact.size(); ++k)
        if (!(deck.contact[a][k] == deck.contact[b][k])) return false;
    return true;
}

std::string rounded(double value) {
    return fmt::format("{:.3g}", value);
}

double up_to_digits(double value) {
    return std::stod(rounded(value));
}

std::string formulas(const std::vector<std::string>& values) {
    std::string text;
    for (const std::string& value : values) {
        const std::optional<NumberAndRest> split = split_number(value);
        const bool plain = value == "free" || (split && split->rest.empty());
        text += (text.empty() ? "" : ", ") + (plain ? value : quoted(value));
    }
    return fmt::format("[{}]", text);
}

std::string selection(const std::vector<int>& ids, const std::optional<PeridemGeometry>& region,
                      int dimension) {
    std::string text = fmt::format("grains: {}", ids.empty() ? "all" : ids_text(ids));
    if (region) text += fmt::format(", region: {}", quoted(region_formula(*region, dimension)));
    return text;
}

/// What contact of node pairs is told of two materials.
std::vector<std::string> pair_keys(const PeridemContact& c, bool damped) {
    std::vector<std::string> keys = {c.radius > 0.0
                                         ? fmt::format("contact_radius: {}", number_text(c.radius))
                                         : fmt::format("radius_factor: {}", number_text(c.radius_factor)),
                                     fmt::format("stiffness: {}", number_text(c.stiffness))};
    if (damped) {
        keys.push_back(fmt::format("restitution: {}", number_text(c.restitution)));
        keys.push_back(fmt::format("damping_factor: {}", number_text(c.damping_factor)));
    }
    return keys;
}

/// Materials of walls alone: no contact among them.
std::vector<bool> walls_only(const PeridemDeck& deck, const ImportedMaterials& materials) {
    std::vector<bool> result;
    for (const std::size_t first : materials.first_zone) {
        bool all = true;
        for (std::size_t z = 0; z < deck.zones.size(); ++z)
            all = all && (materials.name[z] != materials.name[first] || deck.zones[z].wall);
        result.push_back(all);
    }
    return result;
}

/// Whether one set prescribes every axis of a whole body.
bool is_led(const PeridemDeck& deck, const PeridemBodies& bodies, int id) {
    return std::any_of(deck.displacements.begin(), deck.displacements.end(), [&](const PeridemSet& set) {
        if (set.region || set.direction.size() < static_cast<std::size_t>(deck.dimension)) return false;
        const std::vector<int> ids = bodies_of(set, bodies);
        return std::find(ids.begin(), ids.end(), id) != ids.end();
    });
}

}  // namespace

ImportedMaterials group_materials(const PeridemDeck& deck) {
    ImportedMaterials materials;
    std::vector<std::size_t> group(deck.zones.size());
    std::vector<std::string> names;
    for (std::size_t z = 0; z < deck.zones.size(); ++z) {
        const auto first = std::find_if(materials.first_zone.begin(), materials.first_zone.end(),
                                        [&](std::size_t other) { return alike(deck, z, other); });
        group[z] = static_cast<std::size_t>(first - materials.first_zone.begin());
        if (first == materials.first_zone.end()) {
            materials.first_zone.push_back(z);
            names.push_back(fmt::format("zone_{}", z + 1));
        } else {
            names[group[z]] += fmt::format("_{}", z + 1);
        }
    }
    for (const std::size_t g : group) materials.name.push_back(names[g]);
    return materials;
}

std::string materials_section(const PeridemDeck& deck, const PeridemBodies& bodies,
                              const ImportedMaterials& materials) {
    std::string text = "materials:\n";
    for (const std::size_t z : materials.first_zone) {
        const PeridemMaterial& m = deck.zones[z].material;
        text += fmt::format("  {}:\n    model: peridem\n    density: {}\n", materials.name[z],
                            number_text(m.density));
        const auto modulus = [&](const char* name, const std::optional<double>& value) {
            if (value) text += fmt::format("    {}: {}\n", name, number_text(*value));
        };
        modulus("bulk_modulus", m.bulk);
        modulus("shear_modulus", m.shear);
        modulus("young_modulus", m.young);
        modulus("poisson_ratio", m.poisson);
        if (m.horizon > 0.0)
            text += fmt::format("    horizon: {}\n", number_text(m.horizon));
        else
            text +=
                fmt::format("    horizon: {} # {} times the least distance of two nodes\n",
                            number_text(m.mesh_ratio * bodies.meshes[z].least), number_text(m.mesh_ratio));
        modulus("fracture_energy", m.fracture_energy);
        text += fmt::format("    influence: {}\n", m.influence);
    }
    return text;
}

std::string contact_section(const PeridemDeck& deck, const ImportedMaterials& materials) {
    const std::vector<std::size_t>& zones = materials.first_zone;
    const std::vector<bool> walls = walls_only(deck, materials);
    std::vector<std::pair<std::size_t, std::size_t>> touching;
    bool damped = false, rubbing = false;
    for (std::size_t i = 0; i < zones.size() && !deck.contact.empty(); ++i)
        for (std::size_t j = i; j < zones.size(); ++j) {
            if (walls[i] && walls[j]) continue;
            touching.emplace_back(i, j);
            const PeridemContact& c = deck.contact[zones[i]][zones[j]];
            damped = damped || c.restitution < 1.0;
            rubbing = rubbing || c.friction > 0.0;
        }
    if (touching.empty()) return "contact: {rule: none}\n";
    const PeridemContact& common = deck.contact[zones[touching[0].first]][zones[touching[0].second]];
    std::vector<std::string> keys = {"radius: published"};
    for (const std::string& key : pair_keys(common, damped)) keys.push_back(key);
    keys.push_back(damped ? "damping: centres" : "damping: none");
    if (rubbing) keys.push_back("friction_law: published");
    keys.push_back("particles: all");
    std::string text = fmt::format("contact:\n  method: node_pair\n  friction: {}\n  node_pair:\n    {}\n",
                                   number_text(common.friction), join(keys, "\n    "));
    std::string pairs;
    for (const auto& [i, j] : touching) {
        const PeridemContact& c = deck.contact[zones[i]][zones[j]];
        if (c == common) continue;
        pairs += fmt::format("    - {{between: [{}, {}], friction: {}, {}}}\n", materials.name[zones[i]],
                             materials.name[zones[j]], number_text(c.friction), join(pair_keys(c, damped)));
    }
    if (!pairs.empty()) text += fmt::format("  pairs:\n{}", pairs);
    return text;
}

std::string grid_section(const PeridemDeck& deck, const PeridemBodies& bodies) {
    const std::size_t n = static_cast<std::size_t>(deck.dimension);
    constexpr double none = std::numeric_limits<double>::infinity();
    Numbers3 low{none, none, none}, high{-none, -none, -none};
    const auto include = [&](const Numbers3& x) {
        for (std::size_t a = 0; a < n; ++a) {
            low[a] = std::min(low[a], x[a]);
            high[a] = std::max(high[a], x[a]);
        }
    };
    if (const auto box = bounding_box(deck.container, deck.dimension)) {
        include((*box)[0]);
        include((*box)[1]);
    }
    double spacing = none;
    for (const PeridemBody& body : bodies.bodies) {
        const PeridemMesh& mesh = bodies.meshes[static_cast<std::size_t>(body.zone)];
        spacing = std::min(spacing, 2.0 * body.scale * mesh.spacing);
        for (const Numbers3& X : mesh.X) include(body.at(X));
    }
    constexpr int n_samples = 64;
    for (const PeridemSet& set : deck.displacements)
        for (const int id : set.bodies ? bodies_of(set, bodies) : std::vector<int>()) {
            const PeridemBody& body = bodies.bodies[static_cast<std::size_t>(id)];
            for (const Numbers3& X : bodies.meshes[static_cast<std::size_t>(body.zone)].X)
                for (int k = 1; k <= n_samples; ++k) {
                    const Numbers3 x = body.at(X), u = displacement(set, x, deck.end * k / n_samples);
                    include({x[0] + u[0], x[1] + u[1], x[2] + u[2]});
                }
        }
    double longest = 0.0;
    for (std::size_t a = 0; a < n; ++a) longest = std::max(longest, high[a] - low[a]);
    spacing = up_to_digits(spacing);
    const double margin = spacing * std::ceil(std::max(4.0, 0.1 * longest / spacing));
    Numbers3 origin{}, extent{};
    for (std::size_t a = 0; a < n; ++a) {
        origin[a] = low[a] - margin;
        extent[a] = spacing * std::ceil((high[a] - low[a] + 2.0 * margin) / spacing);
    }
    const auto list = [&](const Numbers3& v) {
        std::string text;
        for (std::size_t a = 0; a < n; ++a) text += fmt::format("{}{:.6g}", a > 0 ? ", " : "", v[a]);
        return fmt::format("[{}]", text);
    };
    return fmt::format("grid: {{origin: {}, extent: {}, spacing: {}}}\n", list(origin), list(extent),
                       number_text(spacing));
}

std::string loads_section(const PeridemDeck& deck, const PeridemBodies& bodies, bool fixed_step,
                          ImportNotes& notes) {
    std::string held, loads;
    const std::vector<std::string> still(static_cast<std::size_t>(deck.dimension), "0");
    std::vector<int> ids;
    for (int id = 0; id < static_cast<int>(bodies.bodies.size()); ++id) {
        const int zone = bodies.bodies[static_cast<std::size_t>(id)].zone;
        if (deck.zones[static_cast<std::size_t>(zone)].held && !is_led(deck, bodies, id)) ids.push_back(id);
    }
    if (!ids.empty())
        held += fmt::format("  - {{grains: {}, velocity: {}}} # All_Dofs_Constrained\n", ids_text(ids),
                            formulas(still));
    for (const PeridemSet& set : deck.displacements)
        held += fmt::format("  - {{{}, velocity: {}}}\n",
                            selection(bodies_of(set, bodies), set.region, deck.dimension),
                            formulas(velocity_formulas(set, deck.dimension, fixed_step, notes)));
    for (const PeridemSet& set : deck.forces)
        loads += fmt::format("  - {{{}, force_density: {}}}\n",
                             selection(bodies_of(set, bodies), set.region, deck.dimension),
                             formulas(force_formulas(set, deck.dimension)));
    std::string text;
    if (!loads.empty()) text += fmt::format("loads:\n{}", loads);
    if (!held.empty()) text += fmt::format("constraints:\n{}", held);
    return text;
}

}  // namespace quern
