// quern import peridem: a PeriDEM deck with its meshes and table of grains becomes a deck of ours.
#pragma once

#include <string>
#include <vector>

namespace quern {

/// What the horizon of a grain does that is larger or smaller than its mesh.
enum class ImportedHorizon {
    absolute,  ///< stays as given, as in PeriDEM: a shape for each size
    scaled     ///< grows with the grain: one shape a zone, whose grains are computed together
};

struct ImportOptions {
    std::string input;   ///< PeriDEM's YAML file
    std::string output;  ///< deck to write; tables and meshes go beside it
    ImportedHorizon horizon = ImportedHorizon::absolute;
    bool force = false;  ///< overwrite files that exist
};

struct ImportReport {
    std::vector<std::string> files;    ///< written, the deck first
    std::vector<std::string> differs;  ///< what the deck does otherwise than PeriDEM
    int n_bodies = 0, n_shapes = 0;
};

/// Throws InputError for a deck that cannot be imported or a file that would be overwritten, before anything
/// is written; OutputError if writing fails.
ImportReport import_peridem(const ImportOptions& options);

}  // namespace quern
