// From YAML to Deck: parameters, units, formulas, defaults, and every check that needs no mesh.
#pragma once

#include <string>
#include <vector>

#include "src/deck/deck.hpp"

namespace quern {

/// Reads and validates a deck. `overrides` are "path.to.key=value" as given by --set, applied before
/// parameters are resolved. Throws InputError with file, line, key, what was got and what is expected.
Deck read_deck(const std::string& path, const std::vector<std::string>& overrides = {});

/// The deck with every default and parameter resolved, SI numbers, as YAML that read_deck accepts again.
std::string resolved_yaml(const Deck& deck);

/// FNV-1a of the resolved deck, 16 hexadecimal digits: `deck_hash` in summary.json.
std::string deck_hash(const Deck& deck);

/// JSON Schema (draft 2020-12) of the deck, made from the same table of keys as the reader.
std::string deck_schema();

/// The same table as Markdown: the reference in docs/deck.md.
std::string deck_reference();

}  // namespace quern
