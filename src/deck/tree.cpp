#include "src/deck/tree.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>

#include "grid/error.hpp"
#include "src/deck/names.hpp"
#include "src/deck/units.hpp"

namespace quern {
namespace {

// A private-use character on either side of the number of a formula set aside.
const std::string open_mark = "\xEE\x80\x80", close_mark = "\xEE\x80\x81";

/// Takes `${...}` out of the text before YAML sees it: inside [lists] its braces and commas would be YAML's.
std::string set_formulas_aside(const std::string& text, std::vector<std::string>& formulas) {
    std::string result;
    std::size_t at = 0;
    while (true) {
        const std::size_t begin = text.find("${", at);
        if (begin == std::string::npos) return result + text.substr(at);
        const std::size_t end = text.find_first_of("}\n", begin);
        if (end == std::string::npos || text[end] == '\n') {
            result += text.substr(at, begin + 2 - at);
            at = begin + 2;
            continue;
        }
        result += text.substr(at, begin - at) + open_mark + std::to_string(formulas.size()) + close_mark;
        formulas.push_back(text.substr(begin, end + 1 - begin));
        at = end + 1;
    }
}

std::string put_formulas_back(const std::string& text, const std::vector<std::string>& formulas) {
    std::string result;
    std::size_t at = 0;
    while (true) {
        const std::size_t begin = text.find(open_mark, at);
        if (begin == std::string::npos) return result + text.substr(at);
        const std::size_t end = text.find(close_mark, begin);
        std::size_t number = formulas.size();
        if (end != std::string::npos) {
            std::from_chars(text.data() + begin + open_mark.size(), text.data() + end, number);
        }
        if (number >= formulas.size()) return result + text.substr(at);
        result += text.substr(at, begin - at) + formulas[number];
        at = end + close_mark.size();
    }
}

/// Builds the tree from the parser's events.
class TreeBuilder : public YAML::EventHandler {
  public:
    TreeBuilder(const std::string& file, const std::vector<std::string>& formulas, bool with_lines)
        : file_(file), formulas_(formulas), with_lines_(with_lines) {}

    Node take() { return std::move(root_); }

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        add(make(Node::Kind::null, mark), anchor);
    }
    void OnAlias(const YAML::Mark&, YAML::anchor_t anchor) override { add(anchors_[anchor], 0); }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override {
        Node node = make(Node::Kind::scalar, mark);
        node.text = put_formulas_back(value, formulas_);
        node.quoted = tag == "!";
        add(std::move(node), anchor);
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        open_.push_back({make(Node::Kind::list, mark), anchor, {}, 0});
    }
    void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        open_.push_back({make(Node::Kind::map, mark), anchor, {}, 0});
    }
    void OnSequenceEnd() override { close(); }
    void OnMapEnd() override { close(); }

  private:
    struct Open {
        Node node;
        YAML::anchor_t anchor;
        std::optional<std::string> key;
        int key_line;
    };

    Node make(Node::Kind kind, const YAML::Mark& mark) const {
        Node node;
        node.kind = kind;
        node.line = with_lines_ ? mark.line + 1 : 0;
        return node;
    }

    void close() {
        Open done = std::move(open_.back());
        open_.pop_back();
        add(std::move(done.node), done.anchor);
    }

    void add(Node node, YAML::anchor_t anchor) {
        if (anchor != 0) anchors_[anchor] = node;
        if (open_.empty()) {
            root_ = std::move(node);
            return;
        }
        Open& parent = open_.back();
        if (parent.node.kind == Node::Kind::list) {
            parent.node.items.push_back(std::move(node));
            return;
        }
        if (!parent.key) {
            start_entry(parent, node);
            return;
        }
        node.line = parent.key_line;
        parent.node.names.push_back(std::move(*parent.key));
        parent.node.items.push_back(std::move(node));
        parent.key.reset();
    }

    void start_entry(Open& parent, const Node& key) const {
        const std::string where = Place{file_, key.line, ""}.text();
        if (key.kind != Node::Kind::scalar)
            throw InputError(where, key.description() + " as a key", "a name");
        if (const Node* first = parent.node.find(key.text)) {
            throw InputError(Place{file_, key.line, key.text}.text(), "the key a second time",
                             "each key once in a section", fmt::format("first in line {}", first->line));
        }
        parent.key = key.text;
        parent.key_line = key.line;
    }

    const std::string& file_;
    const std::vector<std::string>& formulas_;
    bool with_lines_;
    Node root_;
    std::vector<Open> open_;
    std::map<YAML::anchor_t, Node> anchors_;
};

Node parse_yaml(const std::string& text, const std::string& file, bool with_lines) {
    std::vector<std::string> formulas;
    std::istringstream stream(set_formulas_aside(text, formulas));
    TreeBuilder builder(file, formulas, with_lines);
    try {
        YAML::Parser parser(stream);
        parser.HandleNextDocument(builder);
        Node root = builder.take();
        if (parser.HandleNextDocument(builder)) {
            throw InputError(file, "a second document after '---'", "one YAML document");
        }
        return root;
    } catch (const YAML::Exception& error) {
        const Place place{file, with_lines ? error.mark.line + 1 : 0, ""};
        throw InputError(place.text(), "text that is not YAML", "valid YAML", error.msg);
    }
}

[[noreturn]] void lead_nowhere(const std::string& where, const std::string& name, const Node& node) {
    if (node.kind == Node::Kind::list) {
        throw InputError(where, "'" + name + "'",
                         fmt::format("a number from 0 to {}", node.items.size() - 1));
    }
    throw InputError(where, "the unknown name '" + name + "'",
                     node.names.empty() ? "a key of a section" : "one of " + join(node.names),
                     did_you_mean(name, node.names));
}

/// A parameter "60 deg" set to "45" becomes "45 deg".
void keep_unit(Node& value, const Node& before) {
    const auto unit_of = [](const std::string& text) {
        if (text.starts_with("${"))
            return std::string(trim(text.substr(std::min(text.size(), text.find('}') + 1))));
        const std::optional<NumberAndRest> split = split_number(text);
        return split ? std::string(split->rest) : std::string();
    };
    const std::optional<NumberAndRest> bare = split_number(value.text);
    if (value.kind != Node::Kind::scalar || before.kind != Node::Kind::scalar) return;
    if (before.quoted || !bare || !bare->rest.empty()) return;
    const std::string unit = unit_of(before.text);
    if (!unit.empty()) value.text += " " + unit;
}

}  // namespace

std::string Place::text() const {
    std::string result = file;
    if (line > 0) result += fmt::format(":{}", line);
    if (!key.empty()) result += fmt::format(": {}", key);
    return result;
}

const Node* Node::find(const std::string& name) const {
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == name) return &items[i];
    }
    return nullptr;
}

std::string Node::description() const {
    if (kind == Kind::scalar) return "'" + text + "'";
    return kind == Kind::list ? "a list" : kind == Kind::map ? "a section" : "nothing";
}

Node read_tree(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    std::ostringstream text;
    if (std::filesystem::is_directory(path)) throw InputError(path, "a folder", "a deck (YAML file)");
    if (!file || !(text << file.rdbuf())) {
        const bool exists = std::filesystem::exists(path);
        throw InputError(path, exists ? "an empty or unreadable file" : "no such file", "a deck (YAML file)");
    }
    Node root = parse_yaml(text.str(), path, true);
    if (root.kind != Node::Kind::map) throw InputError(path, root.description(), "a deck: a map of sections");
    return root;
}

void apply_override(Node& root, const std::string& override_text) {
    const std::size_t equals = override_text.find('=');
    const std::string path = override_text.substr(0, equals);
    const std::string where = "--set: " + path;
    if (equals == std::string::npos || equals == 0)
        throw InputError("--set", "'" + override_text + "'", "key=value");
    Node value = parse_yaml(override_text.substr(equals + 1), where, false);
    Node* node = &root;
    for (std::size_t begin = 0; begin <= path.size();) {
        const std::size_t end = std::min(path.size(), path.find('.', begin));
        const std::string name = path.substr(begin, end - begin);
        const bool last = end == path.size(), in_params = node != &root && path.starts_with("params.");
        begin = end + 1;
        std::size_t index = node->items.size();
        if (node->kind == Node::Kind::list) {
            std::from_chars(name.data(), name.data() + name.size(), index);
        } else if (node->kind != Node::Kind::scalar) {
            index = static_cast<std::size_t>(std::find(node->names.begin(), node->names.end(), name) -
                                             node->names.begin());
        }
        if (index >= node->items.size()) {
            // New keys and sections may be set; that they are known is checked with all others. New
            // parameters would do nothing, and a part of a new material or shape is a name misspelt.
            const bool named_by_user =
                node != &root && (node == root.find("materials") || node == root.find("shapes"));
            const bool may_be_new = node->kind != Node::Kind::list && node->kind != Node::Kind::scalar &&
                                    (last || !named_by_user) && !in_params;
            if (!may_be_new) lead_nowhere(where, name, *node);
            node->kind = Node::Kind::map;
            node->names.push_back(name);
            index = node->items.size();
            node->items.emplace_back();
        }
        node = &node->items[index];
        if (last && in_params) keep_unit(value, *node);
    }
    *node = std::move(value);
}

Cursor Cursor::entry(std::size_t i) const {
    return Cursor(*this, node_.items[i], node_.kind == Node::Kind::map ? node_.names[i] : std::to_string(i));
}

std::string Cursor::path() const {
    if (!parent_) return {};
    const std::string above = parent_->path();
    return above.empty() ? name_ : above + "." + name_;
}

Place Cursor::place() const {
    const bool given = node_.line > 0 || !parent_;
    return {given ? file_ : "--set", node_.line, path()};
}

Place Cursor::place_of(const std::string& path) const {
    const std::size_t dot = path.find('.');
    const std::string name = path.substr(0, dot);
    for (std::size_t i = 0; i < node_.items.size(); ++i) {
        const Cursor below = entry(i);
        if (below.name_ != name) continue;
        return dot == std::string::npos ? below.place() : below.place_of(path.substr(dot + 1));
    }
    Place here = place();
    here.key += (here.key.empty() ? "" : ".") + path;
    return here;
}

}  // namespace quern
