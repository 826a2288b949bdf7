// A YAML file as a tree of texts, each with its line, and a cursor that knows the way to where it stands.
#pragma once

#include <string>
#include <vector>

#include "src/deck/deck.hpp"

namespace quern {

/// Scalars stay text: what they mean is decided by the key they belong to.
struct Node {
    enum class Kind { null, scalar, list, map };
    Kind kind = Kind::null;
    bool quoted = false;             ///< scalar in quotes: text whatever it looks like
    int line = 0;                    ///< of the key for entries of a map; 0: from the command line
    std::string text;                ///< scalar
    std::vector<std::string> names;  ///< map: names of `items`
    std::vector<Node> items;         ///< map, list

    const Node* find(const std::string& name) const;
    std::string description() const;  ///< "'text'", "a list", "a section", "nothing"
};

/// Reads a file. Throws InputError (with line) on a syntax error, a duplicate key, or if it cannot be read.
/// `${...}` may stand unquoted anywhere, also in [lists], whatever characters it holds.
Node read_tree(const std::string& path);

/// Sets "path.to.key=value"; value is YAML, list items are addressed by number. A bare number that replaces a
/// parameter with a unit keeps that unit. Throws InputError if the path leads nowhere.
void apply_override(Node& root, const std::string& override_text);

/// A node and the way to it. Lives on the stack of the reader; holds no copy of its parents.
class Cursor {
  public:
    Cursor(const Node& root, const std::string& file) : node_(root), file_(file) {}
    Cursor(const Cursor& parent, const Node& node, std::string name)
        : node_(node), file_(parent.file_), parent_(&parent), name_(std::move(name)) {}

    const Node& node() const { return node_; }
    Cursor entry(std::size_t i) const;  ///< of a map or a list
    bool has(const std::string& name) const { return node_.find(name) != nullptr; }

    Place place() const;
    std::string where() const { return place().text(); }
    /// The place of a descendant, "pairs.0.between"; of the nearest one that exists where it does not.
    Place place_of(const std::string& path) const;
    std::string where(const std::string& path) const { return place_of(path).text(); }

  private:
    std::string path() const;
    const Node& node_;
    const std::string& file_;
    const Cursor* parent_ = nullptr;
    std::string name_;
};

}  // namespace quern
