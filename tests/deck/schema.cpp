// The schema is valid JSON, speaks of every key, and the documentation agrees with the table of keys.
#include <doctest/doctest.h>
#include <yaml-cpp/yaml.h>

#include <cctype>
#include <sstream>

#include "tests/deck/deck_files.hpp"

using namespace quern;

namespace {

/// Strict JSON (RFC 8259), nothing kept.
class JsonChecker {
  public:
    explicit JsonChecker(const std::string& text) : text_(text) {}
    bool valid() {
        const bool one_value = value();
        space();
        return one_value && at_ == text_.size();
    }

  private:
    void space() {
        while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_]))) ++at_;
    }
    bool take(const std::string& word) {
        space();
        if (text_.compare(at_, word.size(), word) != 0) return false;
        at_ += word.size();
        return true;
    }
    bool string() {
        if (!take("\"")) return false;
        for (; at_ < text_.size() && text_[at_] != '"'; ++at_) {
            if (static_cast<unsigned char>(text_[at_]) < 0x20) return false;
            if (text_[at_] != '\\') continue;
            ++at_;
            if (at_ >= text_.size() || std::string("\"\\/bfnrt").find(text_[at_]) == std::string::npos)
                return false;
        }
        return take("\"");
    }
    bool members(const std::string& end, bool named) {
        if (take(end)) return true;
        do {
            if (named && !(string() && take(":"))) return false;
            if (!value()) return false;
        } while (take(","));
        return take(end);
    }
    bool number() {
        space();
        const std::size_t begin = at_;
        while (at_ < text_.size() && std::string("0123456789+-.eE").find(text_[at_]) != std::string::npos)
            ++at_;
        std::istringstream stream(text_.substr(begin, at_ - begin));
        double parsed = 0;
        return at_ > begin && stream >> parsed && stream.eof();
    }
    bool value() {
        if (take("{")) return members("}", true);
        if (take("[")) return members("]", false);
        space();
        if (at_ < text_.size() && text_[at_] == '"') return string();
        return take("true") || take("false") || take("null") || number();
    }
    const std::string text_;
    std::size_t at_ = 0;
};

}  // namespace

TEST_CASE("deck_schema: is valid JSON") {
    CHECK(JsonChecker(deck_schema()).valid());
    for (const char* broken : {"{", "{\"a\": }", "[1,]", "{a: 1}", "\"\n\"", "01x", "{} {}"}) {
        CAPTURE(broken);
        CHECK_FALSE(JsonChecker(broken).valid());
    }
}

TEST_CASE("deck_schema: knows keys, words, bounds and what is required") {
    const YAML::Node schema = YAML::Load(deck_schema());  // JSON is YAML
    CHECK(schema["$schema"].as<std::string>() == "https://json-schema.org/draft/2020-12/schema");
    CHECK(schema["additionalProperties"].as<bool>() == false);
    CHECK(schema["required"].size() == 5);
    const YAML::Node keys = schema["properties"];
    const YAML::Node material = keys["materials"]["additionalProperties"];
    CHECK(material["required"][0].as<std::string>() == "density");
    const YAML::Node density = material["properties"]["density"];
    CHECK(density["anyOf"][0]["exclusiveMinimum"].as<double>() == 0.0);
    CHECK(density["description"].as<std::string>() == "Mass per volume [kg/m^3]");
    const YAML::Node influence = material["properties"]["influence"];
    CHECK(influence["anyOf"][0]["enum"].size() == 4);
    CHECK(influence["default"].as<std::string>() == "conical");
    CHECK(keys["grains"]["items"]["properties"]["array"]["properties"]["counts"]["type"].as<std::string>() ==
          "array");
}

TEST_CASE("docs/deck.md: holds the reference made from the table of keys") {
    std::ifstream file("docs/deck.md");
    REQUIRE(file.good());
    std::ostringstream text;
    text << file.rdbuf();
    CHECK(text.str().find(deck_reference()) != std::string::npos);
}

TEST_CASE("docs/deck.md: its example is a valid deck") {
    std::ifstream file("docs/deck.md");
    std::ostringstream text;
    text << file.rdbuf();
    const std::string docs = text.str(), open = "```yaml\n# incline.yaml\n";
    const std::size_t begin = docs.find(open), end = docs.find("```", begin + open.size());
    REQUIRE(begin != std::string::npos);
    const Deck deck = read_text(docs.substr(begin + 8, end - begin - 8));
    CHECK(deck.grains.size() == 1);
    CHECK(read_text(docs.substr(begin + 8, end - begin - 8), {"params.theta=0"}).gravity[0] == 0.0);
}
