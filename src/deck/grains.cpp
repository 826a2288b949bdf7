// From entries of `grains` to single grains: tables of a file, arrays.
#include <algorithm>
#include <charconv>
#include <fstream>
#include <random>

#include "src/deck/deck_input.hpp"
#include "src/deck/names.hpp"

namespace quern {
namespace {

/// What a column of the file sets: a number or a name.
struct Column {
    const char* name;
    double* (*number)(GrainDeck&);
    std::string* (*text)(GrainDeck&);
    int dimension;  ///< 0: both
};

template <Numbers3 GrainDeck::*member, std::size_t axis>
double* component(GrainDeck& grain) {
    return &(grain.*member)[axis];
}

const Column columns[] = {
    {"x", component<&GrainDeck::position, 0>, nullptr, 0},
    {"y", component<&GrainDeck::position, 1>, nullptr, 0},
    {"z", component<&GrainDeck::position, 2>, nullptr, 3},
    {"scale", [](GrainDeck& grain) { return &grain.scale; }, nullptr, 0},
    {"radius", [](GrainDeck& grain) { return &grain.scale; }, nullptr, 0},
    {"angle", component<&GrainDeck::angle, 2>, nullptr, 2},
    {"angle_x", component<&GrainDeck::angle, 0>, nullptr, 3},
    {"angle_y", component<&GrainDeck::angle, 1>, nullptr, 3},
    {"angle_z", component<&GrainDeck::angle, 2>, nullptr, 3},
    {"vx", component<&GrainDeck::velocity, 0>, nullptr, 0},
    {"vy", component<&GrainDeck::velocity, 1>, nullptr, 0},
    {"vz", component<&GrainDeck::velocity, 2>, nullptr, 3},
    {"spin", component<&GrainDeck::spin, 2>, nullptr, 2},
    {"spin_x", component<&GrainDeck::spin, 0>, nullptr, 3},
    {"spin_y", component<&GrainDeck::spin, 1>, nullptr, 3},
    {"spin_z", component<&GrainDeck::spin, 2>, nullptr, 3},
    {"shape", nullptr, [](GrainDeck& grain) { return &grain.shape; }, 0},
    {"material", nullptr, [](GrainDeck& grain) { return &grain.material; }, 0},
    {"group", nullptr, [](GrainDeck& grain) { return &grain.group; }, 0},
};

/// Reads the rows of one file as grains that start from the entry's own keys.
class GrainFile {
  public:
    GrainFile(const GrainInput& entry, const std::vector<ShapeDeck>& shapes, int dimension)
        : entry_(entry), shapes_(shapes), dimension_(dimension), file_(*entry.file) {}

    void read(std::vector<GrainDeck>& grains) {
        std::ifstream stream(file_);
        Place place = entry_.place;
        place.key += ".file";
        if (!stream) throw InputError(place.text(), "'" + file_ + "'", "an existing file");
        const std::size_t before = grains.size();
        for (std::string line; std::getline(stream, line);) {
            ++line_;
            const std::string_view row = trim(line);
            if (row.empty() || row.front() == '#') continue;
            if (header_.empty()) {
                read_header(row);
            } else {
                grains.push_back(read_row(row));
            }
        }
        if (grains.size() == before) throw InputError(file_, "no rows", "a header and one row a grain");
    }

  private:
    std::string where(const std::string& column = {}) const { return Place{file_, line_, column}.text(); }

    bool has(const std::string& name) const {
        return std::any_of(header_.begin(), header_.end(), [&](const Column* c) { return c->name == name; });
    }

    void read_header(std::string_view row) {
        std::vector<std::string> known;
        for (const Column& column : columns) {
            if (column.dimension == 0 || column.dimension == dimension_) known.push_back(column.name);
        }
        for (const std::string_view cell : split_cells(row)) {
            const std::string name(cell);
            if (std::find(known.begin(), known.end(), name) == known.end()) {
                throw InputError(where(), "the unknown column '" + name + "'", "columns among " + join(known),
                                 did_you_mean(name, known));
            }
            if (has(name))
                throw InputError(where(), "the column " + name + " a second time", "each column once");
            header_.push_back(std::find_if(std::begin(columns), std::end(columns),
                                           [&](const Column& column) { return column.name == name; }));
        }
        for (const char* needed : {"x", "y", "z"}) {
            if (has(needed) || (dimension_ == 2 && needed[0] == 'z')) continue;
            throw InputError(where(), fmt::format("no column {}", needed),
                             dimension_ == 2 ? "x and y" : "x, y and z");
        }
        if (has("scale") && has("radius")) throw InputError(where(), "scale and radius", "one of them");
    }

    GrainDeck read_row(std::string_view row) const {
        const std::vector<std::string_view> cells = split_cells(row);
        if (cells.size() != header_.size()) {
            throw InputError(where(), fmt::format("{} cells", cells.size()),
                             fmt::format("{} cells as in the header", header_.size()));
        }
        GrainDeck grain = entry_;
        grain.place = {file_, line_, ""};
        for (std::size_t i = 0; i < cells.size(); ++i) {
            const std::string place = fmt::format("column {} ({})", i + 1, header_[i]->name);
            if (header_[i]->text) {
                const bool group = std::string_view(header_[i]->name) == "group";
                if (cells[i].empty() && !group) throw InputError(where(place), "nothing", "a name");
                *header_[i]->text(grain) = std::string(cells[i]);
                if (group && !cells[i].empty()) check_group_name(grain.group, where(place));
            } else {
                *header_[i]->number(grain) = read_cell(cells[i], place, *header_[i]);
            }
        }
        if (has("radius")) grain.scale /= shape_radius(grain);
        return grain;
    }

    double read_cell(std::string_view cell, const std::string& place, const Column& column) const {
        const std::optional<NumberAndRest> number = split_number(cell);
        if (!number || !number->rest.empty()) {
            throw InputError(where(place), "'" + std::string(cell) + "'", "a number in SI units");
        }
        const std::string name = column.name;
        const bool size = name == "scale" || name == "radius";
        if (size && number->number <= 0.0) throw InputError(where(place), std::string(cell), "a number > 0");
        return number->number;
    }

    double shape_radius(const GrainDeck& grain) const {
        for (const ShapeDeck& shape : shapes_) {
            if (shape.name != grain.shape) continue;
            if (shape.radius > 0.0) return shape.radius;
            throw InputError(where("radius"), "a radius for shape " + shape.name, "a shape with a radius",
                             "give a column scale instead");
        }
        return 1.0;  // an unknown shape: reported with all others
    }

    const GrainInput& entry_;
    const std::vector<ShapeDeck>& shapes_;
    int dimension_;
    std::string file_;
    int line_ = 0;
    std::vector<const Column*> header_;
};

/// 53 random bits, the same on every machine; std::uniform_real_distribution does not promise that.
double uniform(std::mt19937_64& bits) {
    return static_cast<double>(bits() >> 11) * 0x1.0p-53;
}

void add_array(const GrainInput& entry, int dimension, std::vector<GrainDeck>& grains) {
    const ArrayInput& array = *entry.array;
    std::mt19937_64 bits(static_cast<std::uint64_t>(array.seed));
    for (int k = 0; k < array.counts[2]; ++k) {
        for (int j = 0; j < array.counts[1]; ++j) {
            for (int i = 0; i < array.counts[0]; ++i) {
                const int at[] = {i, j, k};
                GrainDeck grain = entry;
                for (std::size_t axis = 0; axis < static_cast<std::size_t>(dimension); ++axis) {
                    const double shift = array.jitter * (2.0 * uniform(bits) - 1.0);
                    grain.position[axis] = array.origin[axis] + (at[axis] + shift) * array.step[axis];
                }
                grain.scale = array.scale[0] + (array.scale[1] - array.scale[0]) * uniform(bits);
                grains.push_back(grain);
            }
        }
    }
}

}  // namespace

std::vector<GrainDeck> expand_grains(const std::vector<GrainInput>& entries,
                                     const std::vector<ShapeDeck>& shapes, const Context& now) {
    std::vector<GrainDeck> grains;
    for (const GrainInput& entry : entries) {
        if (entry.file) {
            GrainFile(entry, shapes, now.dimension).read(grains);
        } else if (entry.array) {
            add_array(entry, now.dimension, grains);
        } else {
            grains.push_back(entry);
        }
    }
    return grains;
}

}  // namespace quern
