// The table of keys as JSON Schema, for editors, and as the reference of the documentation.
#include <utility>

#include "src/deck/deck_input.hpp"
#include "src/deck/names.hpp"
#include "src/deck/read_deck.hpp"

namespace quern {
namespace {

std::string json_text(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        result += c;
    }
    return result + '"';
}

/// Lines of a nested object move in by two spaces.
std::string object(const std::vector<std::pair<std::string, std::string>>& entries) {
    std::string lines;
    for (const auto& [name, value] : entries) {
        lines += fmt::format("{}\n{}: {}", lines.empty() ? "" : ",", json_text(name), value);
    }
    std::string result = "{";
    for (const char c : lines) {
        result += c;
        if (c == '\n') result += "  ";
    }
    return result + "\n}";
}

std::string array(const std::vector<std::string>& values) {
    return fmt::format("[{}]", join(values));
}

std::string words_json(const std::vector<std::string>& words) {
    std::vector<std::string> quoted_words;
    for (const std::string& word : words) quoted_words.push_back(json_text(word));
    return array(quoted_words);
}

/// Numbers may be written as quantities ("7.5 GPa") or formulas ("${K/2}"); those are checked by the program.
std::string number_schema(const Key& key, const char* type) {
    std::string bounds;
    const auto bound = [&bounds](const char* name, double value) {
        if (std::isfinite(value)) bounds += fmt::format(", \"{}\": {}", name, value);
    };
    bound(key.range.low_open ? "exclusiveMinimum" : "minimum", key.range.low);
    bound(key.range.high_open ? "exclusiveMaximum" : "maximum", key.range.high);
    return fmt::format(R"({{"anyOf": [{{"type": "{}"{}}}, {{"type": "string"}}]}})", type, bounds);
}

std::string list_schema(const std::string& items, int least, int most) {
    const std::string limit = most > 0 ? fmt::format(R"(, "maxItems": {})", most) : "";
    return fmt::format(R"({{"type": "array", "items": {}, "minItems": {}{}}})", items, least, limit);
}

const std::string formula_schema = R"({"anyOf": [{"type": "number"}, {"type": "string"}, {"type": "null"}]})";
const std::string parameter_schema = R"({"type": "string", "pattern": "\\$\\{"})";

std::string object_schema(const std::vector<Key>& keys);

std::string value_schema(const Key& key) {
    const std::string number = number_schema(key, "number"), whole = number_schema(key, "integer");
    switch (key.form) {
        case Form::number:
            return number;
        case Form::integer:
            return whole;
        case Form::flag:
            return fmt::format(R"({{"anyOf": [{{"type": "boolean"}}, {}]}})", parameter_schema);
        case Form::word:
            return fmt::format(R"({{"anyOf": [{{"enum": {}}}, {}]}})", words_json(key.words),
                               parameter_schema);
        case Form::text:
            return R"({"type": ["string", "number", "boolean"]})";
        case Form::vector:
            return list_schema(number, 2, 3);
        case Form::turn:
            return fmt::format(R"({{"anyOf": [{}, {}]}})", number, list_schema(number, 3, 3));
        case Form::pair:
            return list_schema(number, 2, 2);
        case Form::numbers:
            return list_schema(number, 1, 0);
        case Form::counts:
            return list_schema(whole, 2, 3);
        case Form::points:
            return list_schema(list_schema(number, 2, 2), 3, 0);
        case Form::formula:
            return formula_schema;
        case Form::formulas:
            return list_schema(formula_schema, 2, 3);
        case Form::axes:
            return list_schema(fmt::format(R"({{"enum": {}}})", words_json(key.words)), 0, 3);
        case Form::names:
            return list_schema(R"({"type": "string"})", 2, 2);
        case Form::ids:
            return fmt::format(R"({{"anyOf": [{{"type": "string"}}, {}]}})", list_schema(whole, 0, 0));
        case Form::section:
            return object_schema(key.children);
        case Form::list:
            return list_schema(object_schema(key.children), 0, 0);
        case Form::named: {
            const std::string value = key.children.empty() ? R"({"type": ["number", "string", "boolean"]})"
                                                           : object_schema(key.children);
            return fmt::format(R"({{"type": "object", "additionalProperties": {}}})", value);
        }
    }
    return "{}";
}

std::string with_description(const Key& key) {
    std::string about = key.about;
    if (!key.unit.empty()) about += fmt::format(" [{}]", key.unit);
    if (!key.types.empty()) about += fmt::format(" ({})", join(key.types));
    if (key.dimension != 0) about += fmt::format(" ({}D)", key.dimension);
    const bool has_default = key.form == Form::number || key.form == Form::integer || key.form == Form::word;
    std::string schema = value_schema(key);
    std::string note = fmt::format("\"description\": {}, ", json_text(about));
    if (has_default && !key.fallback.empty() && key.fallback != ".inf") {
        const bool number = key.fallback.find_first_not_of("0123456789.e+-") == std::string::npos;
        note += fmt::format("\"default\": {}, ", number ? key.fallback : json_text(key.fallback));
    }
    return schema.insert(1, note);
}

std::string object_schema(const std::vector<Key>& keys) {
    std::vector<std::pair<std::string, std::string>> properties;
    std::vector<std::string> required;
    for (const Key& key : keys) {
        properties.emplace_back(key.name, with_description(key));
        const bool always = key.required && key.types.empty() && key.dimension == 0;
        if (always) required.push_back(json_text(key.name));
    }
    return fmt::format(
        R"({{"type": "object", "additionalProperties": false, "required": {}, "properties": {}}})",
        array(required), object(properties));
}

std::string type_text(const Key& key) {
    switch (key.form) {
        case Form::number:
            return key.words.empty() ? "number" : "number, " + join(key.words);
        case Form::integer:
            return "whole number";
        case Form::flag:
            return "true, false";
        case Form::word:
            return join(key.words);
        case Form::text:
            return "text";
        case Form::vector:
            return "vector";
        case Form::turn:
            return "number; 3D: vector";
        case Form::pair:
            return "[number, number]";
        case Form::numbers:
            return "list of numbers";
        case Form::counts:
            return "vector of whole numbers";
        case Form::points:
            return "list of [x, y]";
        case Form::formula:
            return "formula of " + join(key.words);
        case Form::formulas:
            return "vector of formulas of " + join(key.words);
        case Form::axes:
            return "list of " + join(key.words);
        case Form::names:
            return "[name, name]";
        case Form::ids:
            return "all, group, list of grain numbers and groups";
        case Form::section:
            return "section";
        case Form::list:
            return "list of sections";
        case Form::named:
            return "sections by name";
    }
    return {};
}

/// A table of one section, followed by those of its sections.
void add_reference(std::string& text, const std::string& path, const std::vector<Key>& keys) {
    if (!path.empty()) text += fmt::format("\n### {}\n\n", path);
    text += "| key | value | unit | default | range | meaning |\n| --- | --- | --- | --- | --- | --- |\n";
    for (const Key& key : keys) {
        std::string only = join(key.types);
        if (key.dimension != 0) only = fmt::format("{}D", key.dimension);
        const std::string fallback = key.required ? "required" : key.fallback.empty() ? "-" : key.fallback;
        text +=
            fmt::format("| {} | {} | {} | {} | {} | {}{} |\n", key.name, type_text(key), key.unit, fallback,
                        key.range.text(), key.about, only.empty() ? "" : fmt::format(" ({} only)", only));
    }
    for (const Key& key : keys) {
        if (key.children.empty()) continue;
        const std::string name = path.empty() ? key.name : path + "." + key.name;
        const char* suffix = key.form == Form::named ? ".NAME" : key.form == Form::list ? "[]" : "";
        add_reference(text, name + suffix, key.children);
    }
}

}  // namespace

std::string schema_text(const std::vector<Key>& keys, const std::string& title) {
    const std::string head = fmt::format(
        R"("$schema": "https://json-schema.org/draft/2020-12/schema", "title": {}, )", json_text(title));
    return object_schema(keys).insert(1, head) + "\n";
}

std::string reference_text(const std::vector<Key>& keys) {
    std::string text;
    add_reference(text, "", keys);
    return text;
}

std::string deck_schema() {
    return schema_text(keys_of(deck_table()), "Quern deck");
}

std::string deck_reference() {
    return reference_text(keys_of(deck_table()));
}

}  // namespace quern
