// What `quern compare` compares: variants of a deck by name.
#pragma once

#include <string>
#include <vector>

namespace quern {

struct Variant {
    std::string name;
    std::vector<std::string> overrides;  ///< "key=value"
    bool may_be_dropped = false;         ///< of the defaults: nobody has asked for it by name
};

/// A default variant that this version of the program, or this deck, refuses.
struct DroppedVariant {
    std::string name, reason;
};

struct VariantChoice {
    std::vector<Variant> variants;
    std::vector<DroppedVariant> dropped;
};

/// "NAME: key=value, key=value"; a name alone is the deck as it is. Throws InputError.
Variant parse_variant(const std::string& text);

/// Ways of contact: pair, surface and seed on the grid, and node_pair.
const std::vector<Variant>& default_variants();

/// The variants `given` by the user, of which "default" stands for all of `defaults`; the defaults if none is
/// given. Those of the defaults that the deck (with `settings`) refuses are dropped. Throws InputError for a
/// mistake in the deck, the settings or a given variant, for a name given twice, and if nothing is left.
VariantChoice choose_variants(const std::vector<std::string>& given, const std::vector<Variant>& defaults,
                              const std::string& deck, const std::vector<std::string>& settings);

}  // namespace quern
