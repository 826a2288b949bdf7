// One table describes a section of the deck: it reads it, writes it back, and makes the schema and the
// reference.
//
// A table belongs to a struct; each of its fields binds a key to a member. Defaults are those of the struct.
#pragma once

#include <fmt/format.h>

#include <functional>
#include <limits>
#include <utility>

#include "grid/error.hpp"
#include "src/deck/values.hpp"

namespace quern {

/// A key and the way from its value to a member of T and back.
template <class T>
struct KeyField {
    Key key;
    std::function<void(T&, const Cursor&, const Context&)> read;
    /// Value as YAML in one line, or a block of lines for sections; "": the key is left out.
    std::function<std::string(const T&, int dimension)> write;

    KeyField& require() {
        key.required = true;
        return *this;
    }
    KeyField& in_dimension(int dimension) {
        key.dimension = dimension;
        return *this;
    }
    KeyField& only_for(std::vector<std::string> types) {
        key.types = std::move(types);
        return *this;
    }
};

/// The fields of a section. `type_of` gives the word that `only_for` speaks of; `finish` checks what one key
/// alone does not tell. Fields are read in order, so that the type comes first.
template <class T>
class Table {
  public:
    std::vector<KeyField<T>> fields;
    std::function<std::string(const T&)> type_of;
    std::function<void(T&, const Cursor&, const Context&)> finish;

    KeyField<T>& add(Key key, std::function<void(T&, const Cursor&, const Context&)> read,
                     std::function<std::string(const T&, int)> write) {
        fields.push_back({std::move(key), std::move(read), std::move(write)});
        return fields.back();
    }

    KeyField<T>& number(const char* name, double T::*member, const char* unit, const Range& range,
                        const char* about) {
        const Key key{.name = name, .form = Form::number, .unit = unit, .range = range, .about = about};
        return add(
            key, [=](T& t, const Cursor& at, const Context& now) { t.*member = read_number(at, now, key); },
            [=](const T& t, int) { return number_text(t.*member); });
    }
    KeyField<T>& number(const char* name, std::optional<double> T::*member, const char* unit,
                        const Range& range, const char* about) {
        const Key key{.name = name, .form = Form::number, .unit = unit, .range = range, .about = about};
        return add(
            key, [=](T& t, const Cursor& at, const Context& now) { t.*member = read_number(at, now, key); },
            [=](const T& t, int) { return t.*member ? number_text(*(t.*member)) : std::string(); });
    }
    /// A number for which 0 in the struct stands for the word, e.g. "auto".
    KeyField<T>& number_or(const char* name, double T::*member, const char* word, const char* unit,
                           const Range& range, const char* about) {
        const Key key{.name = name,
                      .form = Form::number,
                      .unit = unit,
                      .range = range,
                      .words = {word},
                      .about = about};
        return add(
            key,
            [=](T& t, const Cursor& at, const Context& now) {
                t.*member = says(at, now, word) ? 0.0 : read_number(at, now, key);
            },
            [=](const T& t, int) { return t.*member == 0.0 ? std::string(word) : number_text(t.*member); });
    }
    KeyField<T>& integer(const char* name, int T::*member, const Range& range, const char* about) {
        const Key key{.name = name, .form = Form::integer, .range = range, .about = about};
        return add(
            key, [=](T& t, const Cursor& at, const Context& now) { t.*member = read_integer(at, now, key); },
            [=](const T& t, int) { return std::to_string(t.*member); });
    }
    KeyField<T>& flag(const char* name, bool T::*member, const char* about) {
        const Key key{.name = name, .form = Form::flag, .words = {"true", "false"}, .about = about};
        return add(
            key,
            [=](T& t, const Cursor& at, const Context& now) { t.*member = read_word(at, now, key) == 0; },
            [=](const T& t, int) { return std::string(t.*member ? "true" : "false"); });
    }
    /// Words stand in the order of the enumerators.
    template <class Base, class Enum>
    KeyField<T>& word(const char* name, Enum Base::*member, const std::vector<std::string>& words,
                      const char* about) {
        const Key key{.name = name, .form = Form::word, .words = words, .about = about};
        return add(
            key,
            [=](T& t, const Cursor& at, const Context& now) {
                t.*member = static_cast<Enum>(read_word(at, now, key));
            },
            [=](const T& t, int) { return words[static_cast<std::size_t>(t.*member)]; });
    }
    KeyField<T>& text(const char* name, std::string T::*member, const char* about) {
        const Key key{.name = name, .form = Form::text, .about = about};
        return add(
            key, [=](T& t, const Cursor& at, const Context& now) { t.*member = read_text(at, now, key); },
            [=](const T& t, int) { return (t.*member).empty() ? std::string() : quoted(t.*member); });
    }
    /// One number an axis.
    KeyField<T>& vector(const char* name, Numbers3 T::*member, const char* unit, const Range& range,
                        const char* about) {
        const Key key{.name = name, .form = Form::vector, .unit = unit, .range = range, .about = about};
        return add(
            key, [=](T& t, const Cursor& at, const Context& now) { t.*member = read_vector(at, now, key); },
            [=](const T& t, int dimension) { return vector_text(t.*member, dimension); });
    }
    KeyField<T>& vector(const char* name, std::optional<Numbers3> T::*member, const char* unit,
                        const Range& range, const char* about) {
        const Key key{.name = name, .form = Form::vector, .unit = unit, .range = range, .about = about};
        return add(
            key, [=](T& t, const Cursor& at, const Context& now) { t.*member = read_vector(at, now, key); },
            [=](const T& t, int dimension) {
                return t.*member ? vector_text(*(t.*member), dimension) : std::string();
            });
    }
    /// Angle or spin: a number (about z) in 2D, a vector in 3D.
    KeyField<T>& turn(const char* name, Numbers3 T::*member, const char* unit, const char* about) {
        const Key key{.name = name, .form = Form::turn, .unit = unit, .range = any_number, .about = about};
        return add(
            key, [=](T& t, const Cursor& at, const Context& now) { t.*member = read_turn(at, now, key); },
            [=](const T& t, int dimension) {
                return dimension == 2 ? number_text((t.*member)[2]) : vector_text(t.*member, 3);
            });
    }
    /// One formula an axis; none at all if the list is empty.
    KeyField<T>& formulas(const char* name, std::vector<Expression> T::*member, const char* unit,
                          const std::vector<std::string>& variables, const char* about) {
        const Key key{.name = name, .form = Form::formulas, .unit = unit, .words = variables, .about = about};
        return add(
            key, [=](T& t, const Cursor& at, const Context& now) { t.*member = read_formulas(at, now, key); },
            [=](const T& t, int) { return formulas_text(t.*member); });
    }
    KeyField<T>& formula(const char* name, std::optional<Expression> T::*member,
                         const std::vector<std::string>& variables, const char* about) {
        const Key key{.name = name, .form = Form::formula, .words = variables, .about = about};
        return add(
            key, [=](T& t, const Cursor& at, const Context& now) { t.*member = read_formula(at, now, key); },
            [=](const T& t, int) { return t.*member ? formula_text(*(t.*member)) : std::string(); });
    }

    template <class S>
    KeyField<T>& section(const char* name, S T::*member, const Table<S>& table, const char* about);
    template <class S>
    KeyField<T>& section(const char* name, std::optional<S> T::*member, const Table<S>& table,
                         const char* about);
    /// A list of sections.
    template <class S>
    KeyField<T>& list(const char* name, std::vector<S> T::*member, const Table<S>& table, const char* about);
    /// A section of sections whose names the user chooses; they become S::name.
    template <class S>
    KeyField<T>& named(const char* name, std::vector<S> T::*member, const Table<S>& table, const char* about);
};

enum class Layout { block, flow };

/// The keys of a table with their defaults, for the schema and the reference.
template <class T>
std::vector<Key> keys_of(const Table<T>& table) {
    std::vector<Key> keys;
    for (const KeyField<T>& field : table.fields) {
        keys.push_back(field.key);
        const bool has_default = !field.key.required && field.key.children.empty();
        if (has_default) keys.back().fallback = field.write(T{}, 2);
    }
    return keys;
}

/// Throws InputError for an unknown or missing key, or one that does not go with the type or the dimension.
template <class T>
T read_section(const Cursor& at, const Context& now, const Table<T>& table) {
    const Node::Kind kind = at.node().kind;
    if (kind != Node::Kind::map && kind != Node::Kind::null) {
        throw InputError(at.where(), at.node().description(), "a section (key: value)");
    }
    std::vector<std::string> names;
    for (const KeyField<T>& field : table.fields) names.push_back(field.key.name);
    check_names(at, names);
    T result{};
    for (const KeyField<T>& field : table.fields) {
        const std::string type = table.type_of ? table.type_of(result) : std::string();
        const std::string obstacle = field.key.obstacle(now.dimension, type);
        const Node* node = at.node().find(field.key.name);
        if (node && !obstacle.empty()) {
            throw InputError(at.where(field.key.name), "a key that does not apply " + obstacle,
                             "no such key here");
        }
        if (node) {
            field.read(result, Cursor(at, *node, field.key.name), now);
        } else if (field.key.required && obstacle.empty()) {
            throw InputError(at.where(), "no " + field.key.name, field.key.expectation(now.dimension),
                             "required: " + field.key.about);
        }
    }
    if (table.finish) table.finish(result, at, now);
    return result;
}

template <class T>
std::string write_section(const T& section, const Table<T>& table, int dimension, Layout layout) {
    std::string text;
    const std::string type = table.type_of ? table.type_of(section) : std::string();
    for (const KeyField<T>& field : table.fields) {
        if (!field.key.obstacle(dimension, type).empty()) continue;
        const std::string value = field.write(section, dimension);
        if (value.empty()) continue;
        if (layout == Layout::flow) {
            text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", field.key.name, value);
        } else if (value.back() == '\n') {
            text += fmt::format("{}:\n{}", field.key.name, indented(value));
        } else {
            text += fmt::format("{}: {}\n", field.key.name, value);
        }
    }
    return layout == Layout::flow ? fmt::format("{{{}}}", text) : text;
}

template <class T>
template <class S>
KeyField<T>& Table<T>::section(const char* name, S T::*member, const Table<S>& table, const char* about) {
    return add(
        {.name = name, .form = Form::section, .about = about, .children = keys_of(table)},
        [=](T& t, const Cursor& at, const Context& now) { t.*member = read_section(at, now, table); },
        [=](const T& t, int dimension) { return write_section(t.*member, table, dimension, Layout::block); });
}

template <class T>
template <class S>
KeyField<T>& Table<T>::section(const char* name, std::optional<S> T::*member, const Table<S>& table,
                               const char* about) {
    return add(
        {.name = name, .form = Form::section, .about = about, .children = keys_of(table)},
        [=](T& t, const Cursor& at, const Context& now) { t.*member = read_section(at, now, table); },
        [=](const T& t, int dimension) {
            if (!(t.*member)) return std::string();
            return write_section(*(t.*member), table, dimension, Layout::flow);
        });
}

template <class T>
template <class S>
KeyField<T>& Table<T>::list(const char* name, std::vector<S> T::*member, const Table<S>& table,
                            const char* about) {
    return add(
        {.name = name, .form = Form::list, .about = about, .children = keys_of(table)},
        [=](T& t, const Cursor& at, const Context& now) {
            check_list(at);
            for (std::size_t i = 0; i < at.node().items.size(); ++i) {
                (t.*member).push_back(read_section(at.entry(i), now, table));
            }
        },
        [=](const T& t, int dimension) {
            std::string text;
            for (const S& entry : t.*member) {
                text += fmt::format("- {}\n", write_section(entry, table, dimension, Layout::flow));
            }
            return text.empty() ? "[]" : text;
        });
}

template <class T>
template <class S>
KeyField<T>& Table<T>::named(const char* name, std::vector<S> T::*member, const Table<S>& table,
                             const char* about) {
    return add(
        {.name = name, .form = Form::named, .about = about, .children = keys_of(table)},
        [=](T& t, const Cursor& at, const Context& now) {
            if (at.node().kind != Node::Kind::map) {
                throw InputError(at.where(), at.node().description(), "names, each with its section");
            }
            for (std::size_t i = 0; i < at.node().items.size(); ++i) {
                (t.*member).push_back(read_section(at.entry(i), now, table));
                (t.*member).back().name = at.node().names[i];
            }
        },
        [=](const T& t, int dimension) {
            std::string text;
            for (const S& entry : t.*member) {
                text += quoted_name(entry.name) + ":\n" +
                        indented(write_section(entry, table, dimension, Layout::block));
            }
            return text;
        });
}

}  // namespace quern
