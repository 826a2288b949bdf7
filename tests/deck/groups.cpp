// Groups of grains: named by keys and columns, chosen by loads, constraints and outputs.
#include <doctest/doctest.h>

#include "grid/error.hpp"
#include "tests/deck/deck_files.hpp"

using namespace quern;

namespace {

/// Grains 0 and 1 from the deck, 2 to 4 from a file; `more`: further sections.
Deck read_grouped(const std::string& more,
                  const std::string& rows = "3e-3,6e-3,held\n5e-3,6e-3,\n7e-3,6e-3,moved\n") {
    const TempFolder folder;
    folder.write("g.csv", "x,y,group\n" + rows);
    const std::string first = "  - {shape: disk, material: glass, position: [2 mm, 2 mm]}\n";
    const std::string grouped = "  - {shape: disk, material: glass, position: [2 mm, 2 mm], group: held}\n";
    const std::string deck = replaced(plain_deck, first, grouped) + more;
    return read_deck(folder.write(
        "deck.yaml",
        replaced(deck, "output:\n", "  - {shape: disk, material: glass, file: g.csv}\noutput:\n")));
}

}  // namespace

TEST_CASE("groups: stand for their grains, beside numbers and each other") {
    const Deck deck = read_grouped(R"(constraints:
  - {grains: held, velocity: [0, 0]}
  - {grains: [moved, 1, held, 2], velocity: [0, 1]}
loads:
  - {grains: [moved], acceleration: [0, 1]}
prepare: {duration: 1 ms, loads: [{grains: held, acceleration: [1, 0]}]}
)");
    CHECK(deck.grains[0].group == "held");
    CHECK(deck.grains[1].group == "");
    CHECK(deck.grains[3].group == "");
    CHECK(deck.grains[4].group == "moved");
    CHECK(deck.constraints[0].grains == std::vector<int>{0, 2});
    CHECK(deck.constraints[1].grains == std::vector<int>{0, 1, 2, 4});
    CHECK(deck.loads[0].grains == std::vector<int>{4});
    CHECK(deck.prepare.loads[0].grains == std::vector<int>{0, 2});
}

TEST_CASE("groups: the resolved deck holds them and reads back the same") {
    const Deck deck = read_grouped("constraints: [{grains: moved, velocity: [0, 0]}]\n");
    const std::string text = resolved_yaml(deck);
    CHECK(text.find("group: \"moved\"") != std::string::npos);
    CHECK(resolved_yaml(read_text(text)) == text);
}

TEST_CASE("groups: an output tracks them") {
    const TempFolder folder;
    const std::string deck =
        replaced(plain_deck, "position: [5 mm, 2 mm]", "position: [5 mm, 2 mm], group: seen");
    const Deck read = read_text(replaced(deck, "interval: 10 us", "track: seen"));
    CHECK(read.output.track == std::vector<int>{1});
    CHECK_FALSE(read.output.track_all);
}

TEST_CASE("groups: unknown and unusable names are refused with the nearest") {
    const auto message = [](const std::string& more, const std::string& rows = "3e-3,6e-3,held\n") {
        try {
            read_grouped(more, rows);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    const std::string unknown = message("constraints: [{grains: hold, velocity: [0, 0]}]\n");
    CHECK(unknown.find("constraints.0.grains") != std::string::npos);
    CHECK(unknown.find("the unknown group 'hold', expected a group among held, all") != std::string::npos);
    CHECK(unknown.find("did you mean held?") != std::string::npos);
    CHECK(message("loads: [{grains: [al], acceleration: [0, 1]}]\n").find("did you mean all?") !=
          std::string::npos);
    CHECK(message("prepare: {loads: [{grains: [9], acceleration: [0, 1]}]}\n").find("a number from 0 to 2") !=
          std::string::npos);
    const std::string number = message("", "3e-3,6e-3,7th\n");
    CHECK(number.find("g.csv:2: column 3 (group): got '7th'") != std::string::npos);
    CHECK(message("", "3e-3,6e-3,all\n").find("the name of a group") != std::string::npos);
}
