// Gravity, sets of forces and displacements, initial velocities.
#include <fmt/format.h>

#include "grid/error.hpp"
#include "src/import/peridem_deck.hpp"

namespace quern {
namespace {

/// Words of PeriDEM in the order of the enumerators.
const std::vector<std::string> time_words = {"constant", "linear",      "quadratic",       "sin",
                                             "rotation", "linear_step", "linear_slow_fast"};
const std::vector<std::string> space_words = {"constant", "hat_x",    "hat_y",    "sin_x",
                                              "sin_y",    "linear_x", "linear_y", "rotation"};

std::vector<std::string> only(const std::vector<std::string>& words, const std::vector<std::size_t>& which) {
    std::vector<std::string> result;
    for (const std::size_t i : which) result.push_back(words[i]);
    return result;
}

/// The enumerator of a word, among those that the kind of set knows.
template <class Enum>
Enum read_function(const Section& section, const std::vector<std::string>& words,
                   const std::vector<std::size_t>& which) {
    return static_cast<Enum>(which[section.word("Type", only(words, which))]);
}

/// {Type, Parameters}, also below `Geometry`, or {Rectangle: [...]} and the like.
PeridemGeometry read_region(const Section& set) {
    const SectionKeys keys{{"Geometry", "Type", "Parameters", "Rectangle", "Circle", "Cuboid", "Sphere"}, {}};
    const Section region(set, "Region", keys);
    if (region.has("Geometry"))
        return read_peridem_geometry(Section(region, "Geometry", {{"Type", "Parameters"}, {}}));
    if (region.has("Type")) return read_peridem_geometry(region);
    const std::pair<const char*, const char*> names[] = {
        {"Rectangle", "rectangle"}, {"Circle", "circle"}, {"Cuboid", "cuboid"}, {"Sphere", "sphere"}};
    for (const auto& [key, type] : names)
        if (region.has(key)) return {type, region.numbers(key), region.where(key)};
    throw InputError(region.where(), "a section without a shape", "Rectangle, Circle, Cuboid or Sphere");
}

void require_parameters(const Section& function, std::size_t given, std::size_t needed) {
    if (given < needed) function.refuse("Parameters", fmt::format("{} numbers or more", needed));
}

std::size_t parameters_of(TimeFunction function) {
    switch (function) {
        case TimeFunction::constant:
        case TimeFunction::linear:
            return 1;
        case TimeFunction::quadratic:
        case TimeFunction::sine:
            return 2;
        case TimeFunction::linear_step:
            return 3;
        case TimeFunction::rotation:
        case TimeFunction::linear_slow_fast:
            return 4;
    }
    return 0;
}

void read_functions(const Section& section, bool displacement, PeridemSet& set) {
    using Which = std::vector<std::size_t>;
    if (section.has("Time_Function")) {
        const Section time(section, "Time_Function", {{"Type", "Parameters"}, {}});
        set.time = read_function<TimeFunction>(time, time_words,
                                               displacement ? Which{0, 1, 2, 3, 4} : Which{0, 1, 3, 5, 6});
        set.time_parameters = time.numbers_or_none("Parameters");
        if (!set.zero) require_parameters(time, set.time_parameters.size(), parameters_of(set.time));
    } else if (!set.zero) {
        throw InputError(section.where(), "no Time_Function", "a Time_Function or Zero_Displacement: true");
    }
    if (!section.has("Spatial_Function")) return;
    const Section space(section, "Spatial_Function", {{"Type", "Parameters"}, {}});
    set.space = read_function<SpatialFunction>(
        space, space_words, displacement ? Which{0, 3, 4, 5, 6, 7} : Which{0, 1, 2, 3, 4, 5, 6});
    set.space_parameters = space.numbers_or_none("Parameters");
    const bool bare = set.space == SpatialFunction::constant || set.space == SpatialFunction::rotation;
    if (!bare) require_parameters(space, set.space_parameters.size(), 1);
    const bool hat = set.space == SpatialFunction::hat_x || set.space == SpatialFunction::hat_y;
    if (hat && !set.region)
        throw InputError(space.where("Type"), "a hat without a Region", "a Region: the hat spans it");
}

PeridemSet read_set(const Section& sets, const std::string& name, bool displacement, int dimension) {
    SectionKeys keys{{"Particle_List", "Wall_List", "Particle_Exclude_List", "Region", "Direction",
                      "Time_Function", "Spatial_Function"},
                     {"Selection_Type"}};
    if (displacement) keys.used.push_back("Zero_Displacement");
    const Section section(sets, name, keys);
    PeridemSet set;
    set.where = section.where();
    set.key = section.key();
    if (section.has("Particle_List") && section.has("Wall_List"))
        section.refuse("Wall_List", "Particle_List or Wall_List, not both");
    set.walls_only = section.has("Wall_List");
    if (set.walls_only || section.has("Particle_List"))
        set.bodies = section.integers(set.walls_only ? "Wall_List" : "Particle_List");
    if (section.has("Particle_Exclude_List")) set.excluded = section.integers("Particle_Exclude_List");
    if (section.has("Region")) set.region = read_region(section);
    if (!set.bodies && !set.region)
        throw InputError(section.where(), "neither Particle_List nor Region", "what the set acts on");
    for (const int axis : section.integers("Direction")) {
        if (axis < 1 || axis > 3) section.refuse("Direction", "axes among 1, 2, 3");
        if (axis <= dimension) set.direction.push_back(axis - 1);
    }
    if (set.direction.empty()) section.refuse("Direction", "one axis at least");
    set.zero = displacement && section.flag_or("Zero_Displacement", false);
    read_functions(section, displacement, set);
    return set;
}

std::vector<PeridemSet> read_sets(const Section& loads, bool displacement, int dimension) {
    std::vector<PeridemSet> sets;
    const int n = loads.has("Sets") ? loads.integer("Sets", not_negative) : 0;
    for (int s = 1; s <= n; ++s)
        sets.push_back(read_set(loads, fmt::format("Set_{}", s), displacement, dimension));
    return sets;
}

SectionKeys set_keys(const Section& root, const std::string& name, std::vector<std::string> more) {
    const Section any(root, name);
    const int n = any.has("Sets") ? any.integer("Sets", not_negative) : 0;
    for (int s = 1; s <= n; ++s) more.push_back(fmt::format("Set_{}", s));
    more.push_back("Sets");
    return {std::move(more), {}};
}

Numbers3 read_vector3(const Section& section, const std::string& name) {
    const std::vector<double> values = section.numbers(name);
    if (values.size() > 3) section.refuse(name, "at most 3 numbers");
    Numbers3 result{};
    std::copy(values.begin(), values.end(), result.begin());
    return result;
}

}  // namespace

void read_peridem_loads(const Section& root, PeridemDeck& deck) {
    if (root.has("Force_BC")) {
        const Section forces(root, "Force_BC", set_keys(root, "Force_BC", {"Gravity"}));
        if (forces.has("Gravity")) deck.gravity = read_vector3(forces, "Gravity");
        deck.forces = read_sets(forces, false, deck.dimension);
    }
    if (root.has("Displacement_BC")) {
        const Section held(root, "Displacement_BC", set_keys(root, "Displacement_BC", {}));
        deck.displacements = read_sets(held, true, deck.dimension);
    }
    if (!root.has("IC")) return;
    const Section start(root, "IC", {{"Constant_Velocity"}, {}});
    if (!start.has("Constant_Velocity")) return;
    const Section moving(start, "Constant_Velocity", {{"Velocity_Vector", "Particle_List"}, {}});
    deck.velocity = read_vector3(moving, "Velocity_Vector");
    deck.moving = moving.integers("Particle_List");
    deck.moving_where = moving.where("Particle_List");
}

}  // namespace quern
