// Sentences from numbers, and the choice of variants.
#include "src/study/verdicts.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "grid/error.hpp"
#include "src/study/comparison.hpp"
#include "src/study/table.hpp"
#include "src/study/variants.hpp"
#include "tests/deck/deck_files.hpp"

using namespace quern;

namespace {

using Names = std::vector<std::string>;

template <class Call>
std::string message_of(Call&& call) {
    try {
        call();
    } catch (const InputError& error) {
        return error.what();
    }
    FAIL_CHECK("no error");
    return {};
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

Names names_of(const VariantChoice& choice) {
    Names names;
    for (const Variant& variant : choice.variants) names.push_back(variant.name);
    return names;
}

}  // namespace

TEST_CASE("Verdict: the best by more than the noise, and by how much") {
    const Verdict verdict = judge({{"a", 6.0, 0.1}, {"b", 2.0, 0.1}, {"c", 3.0, 0.1}}, 0.0);
    CHECK(verdict.best == Names{"b"});
    CHECK(verdict.factor == doctest::Approx(1.5));
    CHECK(verdict.text == "`b` (2), 33 % less than `c` (3), 3.0 times less than `a` (6)");
}

TEST_CASE("Verdict: what is within the noise or below round-off is equally good") {
    CHECK(judge({{"a", 1.0, 0.1}, {"b", 1.2, 0.1}}, 0.0).text ==
          "a tie, within the noise: `a` (1) and `b` (1.2)");
    CHECK(judge({{"a", 1.0, 0.1}, {"b", 1.22, 0.1}}, 0.0).best == Names{"a"});
    const Verdict small = judge({{"a", 3e-16, 0.02}, {"b", -1e-15, 0.02}, {"c", 1e-3, 0.02}}, 1e-12);
    CHECK(small.best == Names{"a", "b"});
    CHECK(small.text ==
          "`a` (3e-16) and `b` (1e-15) are equally good (at most 1e-12, the round-off), "
          "1e+12 times less than `c` (0.001)");
    CHECK(std::isnan(judge({{"a", 0.0, 0.0}, {"b", 0.0, 0.0}}, 0.0).factor));
    CHECK(judge({{"a", 0.0, 0.0}, {"b", 1.0, 0.0}}, 0.0).text == "`a` (0), infinitely less than `b` (1)");
}

TEST_CASE("Verdict: none without two numbers") {
    CHECK(judge({{"a", 1.0, 0.1}}, 0.0).best.empty());
    CHECK(judge({{"a", 1.0, 0.1}, {"b", std::nan(""), 0.1}}, 0.0).best.empty());
    CHECK(judge({{"a", 1.0, 0.1}, {"b", 9.0, 0.1}, {"c", std::nan(""), 0.1}}, 0.0).best == Names{"a"});
}

TEST_CASE("Slope: of powers, without points that have no logarithm") {
    CHECK(log_slope({1, 2, 4}, {3, 0.75, 0.1875}) == doctest::Approx(-2.0));
    CHECK(log_slope({1, 2, 4, 8}, {1, -2, 0, std::nan("")}) == doctest::Approx(1.0));
    CHECK(std::isnan(log_slope({1, 2}, {1, 0})));
    CHECK(std::isnan(log_slope({2, 2}, {1, 3})));
}

TEST_CASE("Table: the same cells as CSV, JSON and Markdown") {
    Table table({"name", "value"});
    table.add({"a, \"b\" | c", 0.1});
    table.add({"d", std::nan("")});
    CHECK(table.csv() == "name,value\n\"a, \"\"b\"\" | c\",0.1\nd,\n");
    CHECK(table.json() ==
          "[\n  {\"name\": \"a, \\\"b\\\" | c\", \"value\": 0.1},\n  {\"name\": \"d\", \"value\": null}\n]");
    CHECK(table.markdown() == "| name | value |\n| --- | ---: |\n| a, \"b\" \\| c | 0.1 |\n| d | - |\n");
    CHECK_THROWS_AS(table.add({"a"}), std::invalid_argument);
    CHECK(readable(12740) == "12740");
    CHECK(readable(1.0 / 3.0) == "0.3333");
}

TEST_CASE("Variants: name and settings") {
    const Variant variant = parse_variant("flip: contact.rule=seed, gravity=[0, -1], title='a: b, c'");
    CHECK(variant.name == "flip");
    CHECK(variant.overrides == Names{"contact.rule=seed", "gravity=[0, -1]", "title='a: b, c'"});
    CHECK(parse_variant("as it is").overrides.empty());
    CHECK(contains(message_of([] { parse_variant("a: b"); }), "--variant: a: got 'b', expected key=value"));
    CHECK(contains(message_of([] { parse_variant("a: b=1,"); }), "--variant: a"));
    CHECK(contains(message_of([] { parse_variant("a=1"); }), "NAME: key=value"));
    CHECK(contains(message_of([] { parse_variant(""); }), "--variant"));
}

TEST_CASE("Variants: defaults that are refused are dropped, those of the user are errors") {
    const TempFolder folder;
    const std::string deck = folder.write("deck.yaml", plain_deck);
    const std::vector<Variant> defaults = {{"pair", {"contact.rule=pair"}, true},
                                           {"future", {"contact.rule=quantum"}, true},
                                           {"seed", {"contact.rule=seed"}, true}};
    const VariantChoice choice = choose_variants({}, defaults, deck, {});
    CHECK(names_of(choice) == Names{"pair", "seed"});
    REQUIRE(choice.dropped.size() == 1);
    CHECK(choice.dropped[0].name == "future");
    CHECK(contains(choice.dropped[0].reason, "quantum"));
    CHECK(names_of(choose_variants({"a: contact.friction=0", "default"}, defaults, deck, {})) ==
          Names{"a", "pair", "seed"});

    const auto message = [&](const Names& given, const Names& settings = {}) {
        return message_of([&] { choose_variants(given, defaults, deck, settings); });
    };
    CHECK(contains(message({"a: contact.rule=quantum"}), "quantum"));
    CHECK(contains(message({"a: contact.fricton=1"}), "did you mean friction?"));
    CHECK(contains(message({"a: contact.friction=1", "a: contact.friction=0"}), "the name 'a' twice"));
    CHECK(contains(message({"default", "pair: contact.friction=0"}), "the name 'pair' twice"));
    CHECK(contains(message({}, {"contact.fricton=1"}), "did you mean friction?"));
    CHECK(contains(message_of([&] { choose_variants({}, {defaults[1]}, deck, {}); }), "quantum"));
}
