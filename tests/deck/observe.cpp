// The section observe: what it says, how it is written back, and its errors.
#include <doctest/doctest.h>

#include "grid/error.hpp"
#include "tests/deck/deck_files.hpp"

namespace quern {

namespace {

Deck deck_with(const std::string& section) {
    const TempFolder folder;
    return read_deck(folder.write("deck.yaml", plain_deck + section));
}

std::string error_of(const std::string& section) {
    try {
        deck_with(section);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

}  // namespace

TEST_CASE("Deck: observe is off unless it stands there, and survives being written back") {
    const Deck off = deck_with("");
    CHECK_FALSE(off.observe.on);
    CHECK(resolved_yaml(off).find("observe") == std::string::npos);
    CHECK(deck_with("observe: {}\n").observe.on);
    const Deck deck = deck_with(
        "observe:\n  regions:\n    low: {from: [0, 0], to: [1 mm, 2 mm]}\n    round: {where: \"x^2 + y^2 < "
        "t\"}\n"
        "  profiles:\n    up: {axis: x, bins: 7, to: 3 mm}\n  force_bin: 0.5\n");
    const TempFolder folder;
    const Deck again = read_deck(folder.write("again.yaml", resolved_yaml(deck)));
    CHECK(resolved_yaml(again) == resolved_yaml(deck));
    for (const Deck& read : {deck, again}) {
        CHECK(read.observe.on);
        CHECK(read.observe.force_bin == 0.5);
        REQUIRE(read.observe.regions.size() == 2);
        CHECK(read.observe.regions[0].name == "low");
        CHECK((*read.observe.regions[0].to)[1] == 2e-3);
        CHECK_FALSE(read.observe.regions[0].where);
        CHECK_FALSE(read.observe.regions[1].from);
        CHECK((*read.observe.regions[1].where)(1.0, 1.0, 0.0, 3.0) == 1.0);
        REQUIRE(read.observe.profiles.size() == 1);
        CHECK(read.observe.profiles[0].axis == Axis::x);
        CHECK(read.observe.profiles[0].bins == 7);
        CHECK_FALSE(read.observe.profiles[0].from);
        CHECK(*read.observe.profiles[0].to == 3e-3);
    }
}

TEST_CASE("Deck: bad input to observe is named by line, key, what was got and what is expected") {
    struct Case {
        const char* section;
        std::vector<std::string> parts;
    };
    const Case cases[] = {
        {"{regions: {low: {from: [0, 0]}}}", {"observe.regions.low", "got from without to", "both corners"}},
        {"{regions: {low: {from: [0, 0], to: [1, 0]}}}", {"observe.regions.low.to", "a corner above [0, 0]"}},
        {"{regions: {all: {}}}", {"observe.regions.all", "another name"}},
        {"{profiles: {up: {axis: z}}}", {"observe.profiles.up.axis", "one of x, y", "the deck is 2D"}},
        {"{profiles: {up: {from: 2, to: 1 mm}}}", {"observe.profiles.up.to", "more than from"}},
        {"{profiles: {up: {bins: 0}}}", {"observe.profiles.up.bins"}},
        {"{profile: {}}", {"observe.profile", "did you mean profiles?"}},
        {"{force_bin: -1}", {"observe.force_bin", "> 0"}},
    };
    for (const Case& one : cases) {
        const std::string message = error_of(std::string("observe: ") + one.section + "\n");
        CAPTURE(message);
        CHECK(message.find("deck.yaml:35") != std::string::npos);
        for (const std::string& part : one.parts)
            CHECK_MESSAGE(message.find(part) != std::string::npos, part);
    }
}

}  // namespace quern
