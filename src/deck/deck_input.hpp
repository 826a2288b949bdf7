// The deck as it is written, before sections are combined: what the tables of keys read and write.
#pragma once

#include "src/deck/keys.hpp"

namespace quern {

/// Two of the four moduli, one of each pair of the other alternatives.
struct MaterialInput : Material {
    std::optional<double> bulk, shear, young, poisson;
};

inline const std::vector<std::string> material_models = {"lps", "bond_based", "peridem", "correspondence",
                                                         "material_points"};

/// A regular arrangement: counts along the axes, x fastest.
struct ArrayInput {
    std::array<int, 3> counts{1, 1, 1};
    Numbers3 origin{};  ///< of the first grain [m]
    Numbers3 step{};    ///< from one grain to the next, per axis [m]
    double jitter = 0.0;
    std::array<double, 2> scale{1.0, 1.0};
    int seed = 0;
};

/// One grain, or an entry that stands for many.
struct GrainInput : GrainDeck {
    std::optional<std::string> file;
    std::optional<ArrayInput> array;
    bool has_position = false;
};

struct WallInput : WallDeck {
    std::optional<std::size_t> side;  ///< index into wall_sides
};

struct LoadInput : LoadDeck {
    std::vector<Expression> acceleration, force_density;
};

struct PrepareInput : PrepareDeck {
    std::vector<LoadInput> load_entries;
};

struct DampingInput {
    double mass = 0.0;
};

struct DeckInput {
    std::string title;
    int dimension = 2;
    TimeDeck time;
    ComputeDeck compute;
    PointOptions material_points;
    Numbers3 gravity{};
    std::vector<MaterialInput> materials;
    std::vector<ShapeDeck> shapes;
    std::vector<GrainInput> grains;
    GridDeck grid;
    std::vector<WallInput> walls;
    ContactDeck contact;
    DampingInput damping;
    std::vector<LoadInput> loads;
    std::vector<ConstraintDeck> constraints;
    std::vector<CrackDeck> cracks;
    std::vector<NoFailDeck> no_fail;
    PrepareInput prepare;
    OutputDeck output;
    ObserveDeck observe;
};

inline const std::vector<std::string> wall_sides = {"x-", "x+", "y-", "y+", "z-", "z+"};

/// The whole deck: the one table that reads, writes and documents it.
const Table<DeckInput>& deck_table();

// Parts of it that stand in a file of their own.
Table<MaterialInput> material_table();
Table<ShapeDeck> shape_table();
Table<GrainInput> grain_table();
Table<CrackDeck> crack_table();
Table<NoFailDeck> no_fail_table();
Table<ObserveDeck> observe_table();

// Checks of single sections, run as soon as each is read.
void finish_material(MaterialInput& material, const Cursor& at, const Context& now);
void finish_shape(ShapeDeck& shape, const Cursor& at, const Context& now);
void finish_grid(GridDeck& grid, const Cursor& at, const Context& now);

/// Key of grain numbers.
Key grain_ids_key(const char* name, const char* about);
/// Adds to `ids` and `groups` what it says; nothing for the word all.
void read_grain_ids(std::vector<int>& ids, std::vector<std::string>& groups, const Cursor& at,
                    const Context& now, const Key& key);

/// The word of a shape's type: "disk", ...
const std::vector<std::string>& shape_types();

/// Replaces `file` and `array` entries by grains. Shapes give the radius that a `radius` column scales.
std::vector<GrainDeck> expand_grains(const std::vector<GrainInput>& entries,
                                     const std::vector<ShapeDeck>& shapes, const Context& now);

/// Combines the sections and checks what concerns more than one of them.
Deck make_deck(DeckInput input, const Cursor& at, const Context& now);

}  // namespace quern
