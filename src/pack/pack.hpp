// `quern pack`: a packing from a file to files.
#pragma once

#include <string>
#include <vector>

namespace quern {

struct PackOptions {
    std::string spec;    ///< YAML
    std::string output;  ///< CSV; .json and .png lie beside it
    std::vector<std::string> overrides;
    bool terminal = false;  ///< progress as one line that is rewritten
};

struct PackReport {
    int n_grains = 0, rounds = 0;
    double fraction = 0.0, deepest = 0.0, coordination = 0.0, size_factor = 1.0;
    std::vector<std::string> files;
};

/// Packs and writes. Throws InputError, OutputError, or SimulationError for a fraction out of reach: the
/// densest packing found is written nevertheless.
PackReport pack(const PackOptions& options);

}  // namespace quern
