// What a key accepts, and the values themselves: from a place in the tree to numbers, words and formulas and
// back.
#pragma once

#include <cmath>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "src/deck/parameters.hpp"

namespace quern {

struct Range {
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    bool low_open = false, high_open = false;
    bool infinite = false;  ///< .inf is a value

    bool contains(double value) const;
    std::string text() const;  ///< "> 0", "in (0, 1]", "" without bounds
};

inline constexpr double no_limit = std::numeric_limits<double>::infinity();
inline constexpr Range any_number{};
inline constexpr Range positive{0.0, no_limit, true, false, false};
inline constexpr Range or_infinite{0.0, no_limit, true, false, true};  ///< > 0, or .inf
constexpr Range at_least(double low) {
    return {low, no_limit, false, false, false};
}
inline constexpr Range not_negative{0.0, no_limit, false, false, false};

/// How a value is written.
enum class Form {
    number,  ///< `words` may stand in its place
    integer,
    flag,
    word,  ///< one of `words`
    text,
    vector,    ///< a number an axis
    turn,      ///< a number in 2D, a vector in 3D
    pair,      ///< two numbers
    numbers,   ///< a list of numbers
    counts,    ///< an integer an axis
    points,    ///< a list of pairs
    formula,   ///< of the variables in `words`
    formulas,  ///< a formula an axis; `words` as above
    axes,      ///< a list of axis letters
    names,     ///< a list of two names
    ids,       ///< all, the name of a group, or a list of grain numbers and names
    section,
    list,   ///< of sections
    named,  ///< sections by name
};

/// One key of the deck.
struct Key {
    std::string name = {};
    Form form = Form::number;
    std::string unit = {};  ///< SI; "" for pure numbers
    Range range = {};
    std::vector<std::string> words = {};
    bool required = false;
    int dimension = 0;                    ///< 0: both
    std::vector<std::string> types = {};  ///< the types of its section it applies to; empty: all
    std::string about = {};
    std::string fallback = {};  ///< default as YAML; "": none
    std::vector<Key> children = {};

    std::string expectation(int dimension) const;  ///< "a number > 0 in kg/m^3", "one of pair, seed"
    /// Why the key does not apply, "in 2D" or "to a disk"; "" if it does.
    std::string obstacle(int deck_dimension, const std::string& type) const;
};

/// What a value may depend on besides its own text.
struct Context {
    const Parameters& parameters;
    int dimension = 2;
    std::filesystem::path folder;  ///< of the deck: files are named relative to it
};

// Readers. All throw InputError at the place of the cursor, with the expectation of the key.
double read_number(const Cursor& at, const Context& now, const Key& key);
int read_integer(const Cursor& at, const Context& now, const Key& key);
std::size_t read_word(const Cursor& at, const Context& now, const Key& key);  ///< index into key.words
std::string read_text(const Cursor& at, const Context& now, const Key& key);
Numbers3 read_vector(const Cursor& at, const Context& now, const Key& key);
Numbers3 read_turn(const Cursor& at, const Context& now, const Key& key);
Expression read_formula(const Cursor& at, const Context& now, const Key& key);
std::vector<Expression> read_formulas(const Cursor& at, const Context& now, const Key& key);
bool says(const Cursor& at, const Context& now, const std::string& word);

void check_list(const Cursor& at);
void check_size(const Cursor& at, std::size_t size, const Key& key, int dimension);
/// Throws InputError if the section at the cursor has a name that is none of `names`.
void check_names(const Cursor& at, const std::vector<std::string>& names);

/// Throws InputError unless `grains` can call a group by this name: no number, not "all", no comma.
void check_group_name(const std::string& name, const std::string& where);

/// Keys as JSON Schema (draft 2020-12), and as Markdown.
std::string schema_text(const std::vector<Key>& keys, const std::string& title);
std::string reference_text(const std::vector<Key>& keys);

// Writers: YAML in one line.
std::string number_text(double value);  ///< shortest text that reads back to the same bits
std::string vector_text(const Numbers3& values, int dimension);
std::string quoted(const std::string& text);
std::string quoted_name(const std::string& name);  ///< in quotes only where YAML needs them
std::string formula_text(const Expression& formula);
std::string formulas_text(const std::vector<Expression>& formulas);  ///< "" for none
std::string ids_text(const std::vector<int>& ids);
std::string indented(const std::string& lines);

}  // namespace quern
