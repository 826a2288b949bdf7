// From a PeriDEM deck and its bodies to the text of a deck of ours and the files beside it.
#pragma once

#include "src/import/import_peridem.hpp"
#include "src/import/peridem_bodies.hpp"

namespace quern {

struct ImportedFile {
    std::string name;    ///< beside the deck
    std::string source;  ///< a file to copy; "": `text` instead
    std::string text;
};

struct ImportedDeck {
    std::string text;
    std::vector<ImportedFile> files;
    int n_shapes = 0;
};

/// `stem`: name of the deck without folder and extension, with which the tables of grains begin.
ImportedDeck write_imported_deck(const PeridemDeck& deck, const PeridemBodies& bodies,
                                 ImportedHorizon horizon, const std::string& stem, ImportNotes& notes);

// Its sections, each as YAML.
/// Zones of one material and one behaviour in contact share a material.
struct ImportedMaterials {
    std::vector<std::string> name;        ///< [zone]
    std::vector<std::size_t> first_zone;  ///< of each material
};
ImportedMaterials group_materials(const PeridemDeck& deck);
std::string materials_section(const PeridemDeck& deck, const PeridemBodies& bodies,
                              const ImportedMaterials& materials);
std::string contact_section(const PeridemDeck& deck, const ImportedMaterials& materials);
std::string grid_section(const PeridemDeck& deck, const PeridemBodies& bodies);
std::string loads_section(const PeridemDeck& deck, const PeridemBodies& bodies, bool fixed_step,
                          ImportNotes& notes);

}  // namespace quern
