#include "src/deck/read_deck.hpp"

#include <fmt/format.h>

#include <cstdint>

#include "src/deck/deck_input.hpp"

namespace quern {
namespace {

LoadInput load_input(const LoadDeck& load) {
    LoadInput entry{load, {}, {}};
    (load.per_mass ? entry.acceleration : entry.force_density) = load.value;
    return entry;
}

/// The dimension decides how vectors are written, so it is known before anything else is read.
int read_dimension(const Cursor& at, const Parameters& parameters) {
    const Context context{parameters, 2, {}};
    for (const KeyField<DeckInput>& field : deck_table().fields) {
        const Node* node = at.node().find("dimension");
        if (node && field.key.name == "dimension") {
            return read_integer(Cursor(at, *node, field.key.name), context, field.key);
        }
    }
    return DeckInput{}.dimension;
}

/// The way back: sections as they would be written.
DeckInput make_input(const Deck& deck) {
    DeckInput input;
    input.title = deck.title;
    input.dimension = deck.dimension;
    input.time = deck.time;
    input.gravity = deck.gravity;
    for (const Material& material : deck.materials) {
        input.materials.push_back({material, material.bulk_modulus, material.shear_modulus, {}, {}});
    }
    input.shapes = deck.shapes;
    for (const GrainDeck& grain : deck.grains) input.grains.push_back({grain, {}, {}, true});
    input.grid = deck.grid;
    for (const WallDeck& wall : deck.walls) {
        const auto side = std::find(wall_sides.begin(), wall_sides.end(), wall.name);
        std::optional<std::size_t> index;
        if (side != wall_sides.end()) index = static_cast<std::size_t>(side - wall_sides.begin());
        input.walls.push_back({wall, index});
    }
    input.contact = deck.contact;
    input.damping.mass = deck.mass_damping;
    for (const LoadDeck& load : deck.loads) input.loads.push_back(load_input(load));
    input.constraints = deck.constraints;
    input.cracks = deck.cracks;
    input.no_fail = deck.no_fail;
    static_cast<PrepareDeck&>(input.prepare) = deck.prepare;
    for (const LoadDeck& load : deck.prepare.loads) input.prepare.load_entries.push_back(load_input(load));
    input.compute = deck.compute;
    input.output = deck.output;
    input.observe = deck.observe;
    return input;
}

}  // namespace

Deck read_deck(const std::string& path, const std::vector<std::string>& overrides) {
    Node root = read_tree(path);
    for (const std::string& text : overrides) apply_override(root, text);
    const Cursor at(root, path);
    const Node* params = root.find("params");
    const Parameters parameters = params ? Parameters(Cursor(at, *params, "params")) : Parameters();
    const int dimension = read_dimension(at, parameters);
    const Context context{parameters, dimension, std::filesystem::path(path).parent_path()};
    Deck deck = make_deck(read_section(at, context, deck_table()), at, context);
    deck.file = path;
    return deck;
}

std::string resolved_yaml(const Deck& deck) {
    return write_section(make_input(deck), deck_table(), deck.dimension, Layout::block);
}

std::string deck_hash(const Deck& deck) {
    std::uint64_t hash = 14695981039346656037ull;
    for (const char c : resolved_yaml(deck)) hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ull;
    return fmt::format("{:016x}", hash);
}

}  // namespace quern
