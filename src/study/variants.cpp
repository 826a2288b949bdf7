#include "src/study/variants.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "grid/error.hpp"
#include "src/deck/names.hpp"
#include "src/deck/read_deck.hpp"
#include "src/study/settings.hpp"

namespace quern {

namespace {

const std::string all_defaults = "default";

void add(VariantChoice& choice, const Variant& variant) {
    const auto same = [&](const Variant& other) {
        return folder_name(other.name) == folder_name(variant.name);
    };
    if (std::any_of(choice.variants.begin(), choice.variants.end(), same))
        throw InputError("--variant", "the name '" + variant.name + "' twice",
                         "a name of its own for each variant");
    choice.variants.push_back(variant);
}

}  // namespace

Variant parse_variant(const std::string& text) {
    const std::string expected = "NAME: key=value, key=value";
    const std::vector<std::string> parts = split_outside(text, ':', "--variant");
    Variant variant{parts.front(), {}};
    if (variant.name.find('=') != std::string::npos)
        throw InputError("--variant", "'" + text + "'", expected);
    if (parts.size() == 1) return variant;
    const std::string where = "--variant: " + variant.name;
    const std::string rest = text.substr(text.find(':') + 1);
    for (const std::string& one : split_outside(rest, ',', where)) {
        const std::size_t equals = one.find('=');
        if (equals == std::string::npos || equals == 0) throw InputError(where, "'" + one + "'", "key=value");
        variant.overrides.push_back(one);
    }
    return variant;
}

const std::vector<Variant>& default_variants() {
    static const std::vector<Variant> variants = {
        {"pair", {"contact.method=grid", "contact.rule=pair"}, true},
        {"surface", {"contact.method=grid", "contact.rule=surface"}, true},
        {"seed", {"contact.method=grid", "contact.rule=seed"}, true},
        {"node_pair", {"contact.method=node_pair"}, true}};
    return variants;
}

VariantChoice choose_variants(const std::vector<std::string>& given, const std::vector<Variant>& defaults,
                              const std::string& deck, const std::vector<std::string>& settings) {
    const auto try_variant = [&](const Variant& variant) {
        std::vector<std::string> overrides = settings;
        overrides.insert(overrides.end(), variant.overrides.begin(), variant.overrides.end());
        read_deck(deck, overrides);
    };
    try_variant({});
    VariantChoice choice;
    std::vector<std::string> wanted = given;
    if (wanted.empty()) wanted = {all_defaults};
    for (const std::string& text : wanted) {
        if (text != all_defaults) {
            const Variant variant = parse_variant(text);
            try_variant(variant);
            add(choice, variant);
            continue;
        }
        for (const Variant& variant : defaults) {
            try {
                try_variant(variant);
                add(choice, variant);
            } catch (const InputError& error) {
                choice.dropped.push_back({variant.name, error.what()});
            }
        }
    }
    if (choice.variants.empty())
        throw InputError("--variant", "no variant that this version takes", "at least one",
                         choice.dropped.empty() ? "" : "first refused: " + choice.dropped.front().reason);
    return choice;
}

}  // namespace quern
