// From sections to the deck: walls on the box, grains one by one, and the checks that see more than one
// section.
#include <algorithm>

#include "src/deck/deck_input.hpp"
#include "src/deck/names.hpp"

namespace quern {
namespace {

template <class Named>
std::vector<std::string> names_of(const std::vector<Named>& things) {
    std::vector<std::string> names;
    for (const Named& thing : things) names.push_back(thing.name);
    return names;
}

std::string place_text(Place place, const char* key) {
    if (!place.key.empty()) place.key += ".";
    place.key += key;
    return place.text();
}

/// `kind`: what the name is of. `where` makes the place, asked only if there is something to report.
template <class Where>
void check_name(const std::string& name, const std::vector<std::string>& names, const char* kind,
                const Where& where) {
    if (std::find(names.begin(), names.end(), name) != names.end()) return;
    throw InputError(where(), fmt::format("the unknown {} '{}'", kind, name),
                     names.empty() ? fmt::format("a {}", kind) : "one of " + join(names),
                     did_you_mean(name, names));
}

/// Distance of a point from a wall, positive on the side of the grains.
double distance(const WallDeck& wall, const Numbers3& point) {
    double sum = 0.0;
    for (std::size_t i = 0; i < 3; ++i) sum += (point[i] - wall.point[i]) * wall.normal[i];
    return sum;
}

WallDeck place_wall(WallInput wall, const GridDeck& grid, int dimension) {
    if (!wall.side) return wall;
    const std::size_t axis = *wall.side / 2;
    const bool upper = *wall.side % 2 == 1;
    for (std::size_t i = 0; i < static_cast<std::size_t>(dimension); ++i) {
        wall.point[i] = grid.origin[i] + 0.5 * grid.extent[i];
    }
    wall.point[axis] = grid.origin[axis] + (upper ? grid.extent[axis] : 0.0);
    wall.normal = {};
    wall.normal[axis] = upper ? -1.0 : 1.0;
    return wall;
}

void check_wall(const WallDeck& wall, const GridDeck& grid, int dimension) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(dimension); ++i) {
        if (!grid.periodic[i] || std::abs(wall.normal[i]) < 1e-12) continue;
        throw InputError(wall.place.text(), fmt::format("a wall across {}, which is periodic", "xyz"[i]),
                         "a wall along each periodic axis");
    }
    double farthest = -no_limit;
    for (int corner = 0; corner < 1 << dimension; ++corner) {
        Numbers3 point = grid.origin;
        for (std::size_t i = 0; i < 3; ++i) point[i] += (corner >> i & 1) * grid.extent[i];
        farthest = std::max(farthest, distance(wall, point));
    }
    if (farthest > 0.0) return;
    throw InputError(place_text(wall.place, "normal"), "a wall with the whole grid box behind it",
                     "a normal that points to the grains", "turn it round?");
}

void check_grain(const GrainDeck& grain, const Deck& deck, std::size_t number) {
    const auto who = [&] {
        return fmt::format("grain {} at {}", number, vector_text(grain.position, deck.dimension));
    };
    for (std::size_t i = 0; i < static_cast<std::size_t>(deck.dimension); ++i) {
        const double low = deck.grid.origin[i], high = low + deck.grid.extent[i];
        if (grain.position[i] >= low && grain.position[i] <= high) continue;
        throw InputError(place_text(grain.place, "position"), who(),
                         fmt::format("a centre inside the grid box, {} in [{}, {}]", "xyz"[i], low, high));
    }
    for (const WallDeck& wall : deck.walls) {
        if (distance(wall, grain.position) > 0.0) continue;
        throw InputError(place_text(grain.place, "position"), who() + ", behind wall " + wall.name,
                         "a centre on the side that the wall's normal points to");
    }
}

void check_pairs(const Deck& deck, const Cursor& at) {
    const std::vector<std::string> materials = names_of(deck.materials);
    for (std::size_t i = 0; i < deck.contact.pairs.size(); ++i) {
        const ContactPair& pair = deck.contact.pairs[i];
        const auto where = [&] { return at.where(fmt::format("contact.pairs.{}.between", i)); };
        check_name(pair.first, materials, "material", where);
        check_name(pair.second, materials, "material", where);
        for (std::size_t j = 0; j < i; ++j) {
            const ContactPair& other = deck.contact.pairs[j];
            const bool same = (pair.first == other.first && pair.second == other.second) ||
                              (pair.first == other.second && pair.second == other.first);
            if (same) throw InputError(where(), "a pair of materials a second time", "each pair once");
        }
    }
}

void check_ids(const std::vector<int>& ids, std::size_t n_grains, const std::string& where) {
    for (const int id : ids) {
        if (static_cast<std::size_t>(id) < n_grains) continue;
        throw InputError(where, fmt::format("grain {}", id),
                         fmt::format("a number from 0 to {}", n_grains - 1));
    }
}

/// Puts the grains of groups beside the numbers: in order, each once.
void add_groups(const Deck& deck, std::vector<int>& ids, std::vector<std::string>& groups,
                const std::string& where) {
    for (const std::string& group : groups) {
        std::vector<std::string> known;
        const std::size_t before = ids.size();
        for (std::size_t i = 0; i < deck.grains.size(); ++i) {
            const std::string& name = deck.grains[i].group;
            if (name == group) ids.push_back(static_cast<int>(i));
            if (!name.empty() && std::find(known.begin(), known.end(), name) == known.end())
                known.push_back(name);
        }
        if (ids.size() > before) continue;
        known.push_back("all");
        throw InputError(where, fmt::format("the unknown group '{}'", group),
                         "a group among " + join(known) + ", or grain numbers", did_you_mean(group, known));
    }
    if (groups.empty()) return;
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    groups.clear();
}

ForceModel model_of(const Deck& deck, const GrainDeck& grain) {
    return std::find_if(deck.materials.begin(), deck.materials.end(),
                        [&](const Material& material) { return material.name == grain.material; })
        ->model;
}

/// What acts on bonds is of no use to material points.
template <class Target>
void check_peridynamic(const Deck& deck, const Target& target, const std::string& shape, const char* what) {
    for (std::size_t i = 0; i < deck.grains.size(); ++i) {
        const GrainDeck& grain = deck.grains[i];
        const bool chosen = target.grains.empty() || std::find(target.grains.begin(), target.grains.end(),
                                                               static_cast<int>(i)) != target.grains.end();
        if (!chosen || !(shape.empty() || shape == grain.shape)) continue;
        if (model_of(deck, grain) != ForceModel::material_points) continue;
        throw InputError(target.place.text(),
                         fmt::format("{} in grain {}, which is made of material points", what, i),
                         "peridynamic grains", "choose them by grains, groups or shape");
    }
}

void check_points(const Deck& deck) {
    const bool any = std::any_of(deck.grains.begin(), deck.grains.end(), [&](const GrainDeck& grain) {
        return model_of(deck, grain) == ForceModel::material_points;
    });
    const bool grid =
        deck.contact.method == ContactMethodKind::grid && deck.contact.rule != ContactRule::none;
    if (any && grid && deck.contact.coupling == ContactCoupling::flip)
        throw InputError(place_text(deck.contact.place, "coupling"), "flip with material points", "impulse",
                         "they are moved by FLIP as they are");
    if (deck.contact.rule != ContactRule::no_slip) return;
    const std::string rule = place_text(deck.contact.place, "rule");
    if (deck.contact.method == ContactMethodKind::node_pair)
        throw InputError(rule, "no_slip with method node_pair", "method: grid",
                         "grains stick by their common field");
    if (!deck.walls.empty())
        throw InputError(rule, fmt::format("no_slip with wall '{}'", deck.walls.front().name), "no walls",
                         "hold grains by constraints instead");
    for (std::size_t i = 0; i < deck.grains.size(); ++i)
        if (model_of(deck, deck.grains[i]) != ForceModel::material_points)
            throw InputError(rule,
                             fmt::format("no_slip with grain {}, which is not made of material points", i),
                             "model: material_points in every material", "peridynamic grains have no field");
}

void check_walls(const Deck& deck) {
    for (std::size_t i = 0; i < deck.walls.size(); ++i) {
        check_wall(deck.walls[i], deck.grid, deck.dimension);
        for (std::size_t j = 0; j < i; ++j) {
            if (deck.walls[i].name != deck.walls[j].name) continue;
            throw InputError(place_text(deck.walls[i].place, "name"),
                             "wall " + deck.walls[i].name + " a second time", "each wall once");
        }
    }
}

}  // namespace

Deck make_deck(DeckInput input, const Cursor& at, const Context& now) {
    Deck deck;
    deck.title = std::move(input.title);
    deck.dimension = input.dimension;
    deck.materials.assign(input.materials.begin(), input.materials.end());
    deck.shapes = std::move(input.shapes);
    deck.grid = input.grid;
    for (WallInput& wall : input.walls)
        deck.walls.push_back(place_wall(std::move(wall), deck.grid, deck.dimension));
    deck.contact = std::move(input.contact);
    deck.gravity = input.gravity;
    deck.mass_damping = input.damping.mass;
    deck.loads.assign(input.loads.begin(), input.loads.end());
    deck.constraints = std::move(input.constraints);
    deck.cracks = std::move(input.cracks);
    deck.no_fail = std::move(input.no_fail);
    deck.prepare = input.prepare;
    deck.prepare.loads.assign(input.prepare.load_entries.begin(), input.prepare.load_entries.end());
    deck.time = input.time;
    deck.compute = input.compute;
    deck.material_points = input.material_points;
    deck.output = std::move(input.output);
    deck.observe = std::move(input.observe);
    deck.grains = expand_grains(input.grains, deck.shapes, now);

    if (deck.grains.empty()) throw InputError(at.where("grains"), "an empty list", "one grain at least");
    check_walls(deck);
    for (const WallDeck& wall : deck.walls)
        if (wall.servo && deck.contact.rule == ContactRule::none)
            throw InputError(wall.servo->place.text(), "a servo without contact", "a contact.rule but none",
                             "nothing would ever press on the wall");
    check_pairs(deck, at);
    const std::vector<std::string> shapes = names_of(deck.shapes), materials = names_of(deck.materials);
    for (std::size_t i = 0; i < deck.grains.size(); ++i) {
        const GrainDeck& grain = deck.grains[i];
        check_name(grain.shape, shapes, "shape", [&] { return place_text(grain.place, "shape"); });
        check_name(grain.material, materials, "material",
                   [&] { return place_text(grain.place, "material"); });
        check_grain(grain, deck, i);
    }
    const auto settle = [&](std::vector<int>& ids, std::vector<std::string>& groups,
                            const std::string& where) {
        check_ids(ids, deck.grains.size(), where);
        add_groups(deck, ids, groups, where);
    };
    for (std::vector<LoadDeck>* loads : {&deck.loads, &deck.prepare.loads})
        for (LoadDeck& load : *loads) settle(load.grains, load.groups, place_text(load.place, "grains"));
    for (ConstraintDeck& held : deck.constraints)
        settle(held.grains, held.groups, place_text(held.place, "grains"));
    const auto settle_target = [&](auto& target) {
        settle(target.grains, target.groups, place_text(target.place, "grains"));
        if (target.shape.empty()) return;
        check_name(target.shape, shapes, "shape", [&] { return place_text(target.place, "shape"); });
    };
    for (CrackDeck& crack : deck.cracks) settle_target(crack);
    for (NoFailDeck& zone : deck.no_fail) settle_target(zone);
    for (const CrackDeck& crack : deck.cracks) check_peridynamic(deck, crack, crack.shape, "a crack");
    for (const NoFailDeck& zone : deck.no_fail)
        check_peridynamic(deck, zone, zone.shape, "a zone without failure");
    check_points(deck);
    settle(deck.output.track, deck.output.groups, at.where("output.track"));
    return deck;
}

}  // namespace quern
