#include "src/import/peridem_section.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "grid/error.hpp"
#include "src/deck/names.hpp"

namespace quern {
namespace {

/// PeriDEM has neither parameters nor units; its numbers are read as bare numbers of a deck.
Context plain_context() {
    static const Parameters none;
    return {none, 3, {}};
}

Key number_key(const Range& range, Form form) {
    return {.form = form, .range = range};
}

/// "Policy" for a key of the file, "Output.Tags" for one of a section.
std::string path_of(const Cursor& at, const std::string& name) {
    return at.place_of(name).key;
}

}  // namespace

void ImportNotes::add_difference(const std::string& text) {
    if (std::find(differs.begin(), differs.end(), text) == differs.end()) differs.push_back(text);
}

Section::Section(const Cursor& at, const SectionKeys& keys, ImportNotes& notes) : at_(at), notes_(notes) {
    if (at.node().kind != Node::Kind::map)
        throw InputError(at.where(), at.node().description(), "a section (key: value)");
    std::vector<std::string> names = keys.used;
    names.insert(names.end(), keys.unused.begin(), keys.unused.end());
    check_names(at, names);
    for (const std::string& name : keys.unused)
        if (at.has(name)) notes.unused.push_back(path_of(at, name));
}

Section::Section(const Section& parent, const std::string& name, const SectionKeys& keys)
    : Section(parent.value(name, "a section"), keys, parent.notes_) {}

Section::Section(const Section& parent, const std::string& name)
    : at_(parent.value(name, "a section")), notes_(parent.notes_) {}

Cursor Section::value(const std::string& name, const std::string& expected) const {
    const Node* node = at_.node().find(name);
    if (!node) throw InputError(at_.where(), "no " + name, expected);
    return Cursor(at_, *node, name);
}

double Section::number(const std::string& name, const Range& range) const {
    const Key key = number_key(range, Form::number);
    return read_number(value(name, key.expectation(3)), plain_context(), key);
}

double Section::number_or(const std::string& name, double fallback, const Range& range) const {
    return has(name) ? number(name, range) : fallback;
}

int Section::integer(const std::string& name, const Range& range) const {
    const Key key = number_key(range, Form::integer);
    return read_integer(value(name, key.expectation(3)), plain_context(), key);
}

bool Section::flag_or(const std::string& name, bool fallback) const {
    if (!has(name)) return fallback;
    std::string said = text(name);
    for (char& c : said) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (const char* yes : {"true", "yes", "on", "y"})
        if (said == yes) return true;
    for (const char* no : {"false", "no", "off", "n"})
        if (said == no) return false;
    refuse(name, "true or false");
}

std::string Section::text(const std::string& name) const {
    return read_text(value(name, "text"), plain_context(), {.form = Form::text});
}

std::string Section::text_or(const std::string& name, const std::string& fallback) const {
    return has(name) ? text(name) : fallback;
}

std::size_t Section::word(const std::string& name, const std::vector<std::string>& words) const {
    const Key key{.form = Form::word, .words = words};
    return read_word(value(name, key.expectation(3)), plain_context(), key);
}

std::vector<double> Section::numbers(const std::string& name) const {
    const Cursor list = value(name, "a list of numbers");
    check_list(list);
    std::vector<double> result;
    const Key key = number_key(any_number, Form::number);
    for (std::size_t i = 0; i < list.node().items.size(); ++i)
        result.push_back(read_number(list.entry(i), plain_context(), key));
    return result;
}

std::vector<double> Section::numbers_or_none(const std::string& name) const {
    return has(name) ? numbers(name) : std::vector<double>();
}

std::vector<int> Section::integers(const std::string& name) const {
    const Cursor list = value(name, "a list of whole numbers");
    check_list(list);
    std::vector<int> result;
    const Key key = number_key(not_negative, Form::integer);
    for (std::size_t i = 0; i < list.node().items.size(); ++i)
        result.push_back(read_integer(list.entry(i), plain_context(), key));
    return result;
}

void Section::refuse(const std::string& name, const std::string& expected, const std::string& hint) const {
    const Node* node = at_.node().find(name);
    throw InputError(at_.where(name), node ? node->description() : "no " + name, expected, hint);
}

SectionKeys zone_keys(int n_zones, const std::vector<std::string>& more,
                      const std::vector<std::string>& unused) {
    SectionKeys keys{more, unused};
    for (int zone = 1; zone <= n_zones; ++zone) keys.used.push_back(fmt::format("Zone_{}", zone));
    return keys;
}

}  // namespace quern
