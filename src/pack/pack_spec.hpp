// What a packing is asked to be: the YAML file as plain data, SI units.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "src/deck/deck.hpp"
#include "src/pack/region.hpp"

namespace quern {

enum class SizeKind { list, file, uniform, lognormal, power_law, weibull };

/// Sizes are diameters of the disks of equal area [m]; distributions are of the number of grains.
struct SizeSpec {
    SizeKind kind = SizeKind::list;
    std::vector<double> values;  ///< list; of `file` after reading
    std::string file, column = "size";
    double unit = 1.0;               ///< file: metres per unit
    double min = 0.0, max = 0.0;     ///< limits of a distribution [m]
    std::optional<double> mean;      ///< of what lies within the limits [m]
    std::optional<double> exponent;  ///< power law: number density ~ size^-exponent
    double deviation = 0.0;          ///< lognormal: standard deviation of ln size before truncation
    double modulus = 0.0;            ///< Weibull: k of exp(-(size/scale)^k)
    Place place;
};

struct PackShape : ShapeDeck {
    double share = 1.0;  ///< of the number of grains, over the sum of all shares
};

/// Names of groups for the grains at an edge; "": none.
struct EdgeGroups {
    std::string x_low, x_high, y_low, y_high, rim;
};

struct RegionSpec : Region {
    Numbers3 origin{}, extent{}, middle{};
    Place place;
};

struct PackSpec {
    std::string title;
    int seed = 0;
    RegionSpec region;
    std::optional<double> solid_fraction;
    int count = 0;  ///< 0: as many as fill
    SizeSpec sizes;
    std::vector<PackShape> shapes;  ///< none: disks
    EdgeGroups edges;
    int rounds = 400;  ///< of exchanges, at most
    std::string file;  ///< path of the file
};

/// Reads and checks a file. `overrides`: "key=value" as given by --set. Throws InputError.
PackSpec read_pack_spec(const std::string& path, const std::vector<std::string>& overrides = {});

/// The keys as Markdown: the reference in docs/pack.md.
std::string pack_reference();
/// JSON Schema of the file, for editors.
std::string pack_schema();

}  // namespace quern
