// The table of grains.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numbers>
#include <random>

#include "grid/error.hpp"
#include "src/deck/names.hpp"
#include "src/import/peridem_bodies.hpp"

namespace quern {
namespace {

std::vector<std::string> split_row(const std::string& line) {
    std::vector<std::string> cells;
    for (std::size_t begin = 0; begin <= line.size();) {
        const std::size_t end = std::min(line.size(), line.find(',', begin));
        cells.emplace_back(trim(std::string_view(line).substr(begin, end - begin)));
        begin = end + 1;
    }
    return cells;
}

/// A uniform number of [0, 1): std::uniform_real_distribution of libstdc++, which PeriDEM runs with.
double uniform(std::mt19937& bits) {
    const double low = static_cast<double>(bits()), high = static_cast<double>(bits());
    return std::min((low + high * 0x1p32) * 0x1p-64, std::nextafter(1.0, 0.0));
}

class GrainTable {
  public:
    GrainTable(const PeridemDeck& deck, ImportNotes& notes) : deck_(deck), notes_(notes) {
        stream_.open(deck.particles);
        if (!stream_) throw InputError(deck.particles_where, "'" + deck.particles + "'", "an existing file");
    }

    std::vector<PeridemGrain> read() {
        std::vector<PeridemGrain> grains;
        for (std::string line; std::getline(stream_, line);) {
            ++line_;
            if (trim(line).empty()) continue;
            if (n_columns_ == 0)
                read_header(split_row(line));
            else
                grains.push_back(read_row(split_row(line)));
        }
        if (grains.empty()) throw InputError(deck_.particles, "no rows", "a header and one row a grain");
        return grains;
    }

  private:
    std::string where(const std::string& column = {}) const {
        return Place{deck_.particles, line_, column}.text();
    }

    void read_header(std::vector<std::string> cells) {
        n_columns_ = cells.size();
        for (std::string& name : cells)
            std::transform(name.begin(), name.end(), name.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        std::vector<std::string> needed = {"i", "x", "y", "r"};
        if (deck_.dimension == 3) needed.insert(needed.begin() + 3, "z");
        if (deck_.oriented) needed.push_back("o");
        for (const std::string& name : needed) {
            const auto found = std::find(cells.begin(), cells.end(), name);
            if (found == cells.end())
                throw InputError(where(), "no column " + name, "the columns " + join(needed),
                                 name == "o" ? "File_Data_Type: loc_rad has no angles" : "");
            column_[name] = static_cast<std::size_t>(found - cells.begin());
        }
        for (const std::string& name : cells)
            if (!column_.contains(name) && name != "z")
                notes_.unused.push_back(fmt::format("column {} of {}", name, deck_.particles));
    }

    double number(const std::vector<std::string>& cells, const std::string& name) const {
        const std::string& cell = cells[column_.at(name)];
        const std::optional<NumberAndRest> value = split_number(cell);
        if (!value || !value->rest.empty())
            throw InputError(where("column " + name), "'" + cell + "'", "a number");
        return value->number;
    }

    PeridemGrain read_row(const std::vector<std::string>& cells) const {
        if (cells.size() != n_columns_)
            throw InputError(where(), fmt::format("{} cells", cells.size()),
                             fmt::format("{} cells as in the header", n_columns_));
        PeridemGrain grain;
        const double zone = number(cells, "i");
        const double n_zones = static_cast<double>(deck_.zones.size());
        if (zone != std::floor(zone) || zone < 0.0 || zone >= n_zones)
            throw InputError(where("column i"), fmt::format("zone {}", zone),
                             fmt::format("a whole number from 0 to {}", n_zones - 1.0),
                             "the table counts zones from 0");
        grain.zone = static_cast<int>(zone);
        if (deck_.zones[static_cast<std::size_t>(grain.zone)].as_meshed)
            throw InputError(where("column i"), fmt::format("zone {}", zone), "a zone of grains",
                             fmt::format("Zone_{} is one body, where its mesh stands", grain.zone + 1));
        grain.centre = {number(cells, "x"), number(cells, "y"),
                        deck_.dimension == 3 ? number(cells, "z") : 0.0};
        grain.radius = number(cells, "r");
        if (!(grain.radius > 0.0))
            throw InputError(where("column r"), fmt::format("{}", grain.radius), "a number > 0");
        if (deck_.oriented) grain.angle = number(cells, "o");
        return grain;
    }

    const PeridemDeck& deck_;
    ImportNotes& notes_;
    std::ifstream stream_;
    int line_ = 0;
    std::size_t n_columns_ = 0;
    std::map<std::string, std::size_t> column_;
};

}  // namespace

std::vector<PeridemGrain> read_peridem_grains(const PeridemDeck& deck, ImportNotes& notes) {
    std::vector<PeridemGrain> grains = GrainTable(deck, notes).read();
    std::stable_sort(grains.begin(), grains.end(),
                     [](const PeridemGrain& a, const PeridemGrain& b) { return a.zone < b.zone; });
    if (deck.oriented) return grains;
    int zone = -1, in_zone = 0;
    std::mt19937 bits;
    for (PeridemGrain& grain : grains) {
        if (grain.zone != zone) {
            zone = grain.zone;
            in_zone = 0;
            bits.seed(static_cast<std::uint32_t>(deck.seed));
        }
        const bool two = deck.test_name == "two_particle";
        grain.angle = two ? std::numbers::pi * in_zone : 2.0 * std::numbers::pi * uniform(bits);
        ++in_zone;
    }
    return grains;
}

}  // namespace quern
