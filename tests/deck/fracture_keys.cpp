// Keys of materials that break by energy.
#include <doctest/doctest.h>

#include "grid/error.hpp"
#include "tests/deck/deck_files.hpp"

using namespace quern;

namespace {

std::string with(const std::string& keys) {
    std::string text = plain_deck;
    const std::string line = "    density: 2440";
    return text.replace(text.find(line), line.size(), keys + line);
}

std::string message_of(const std::string& keys) {
    try {
        read_text(with(keys));
    } catch (const InputError& error) {
        return error.what();
    }
    return "read";
}

bool says(const std::string& message, const std::string& part) {
    return message.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("Breaking by energy: read, and a stretch where nothing is said") {
    CHECK(read_text(with("    fracture_energy: 5\n    breaks_by: energy\n")).materials[0].breaks_by ==
          BreaksBy::energy);
    CHECK(read_text(with("    fracture_energy: 5\n")).materials[0].breaks_by == BreaksBy::stretch);
}

TEST_CASE("Breaking by energy: refused without an energy, and with the published stretch") {
    const std::string none = message_of("    breaks_by: energy\n");
    CHECK(says(none, "deck.yaml:10: materials.glass.breaks_by"));
    CHECK(says(none, "energy without fracture_energy"));
    const std::string peridem =
        message_of("    model: peridem\n    fracture_energy: 5\n    breaks_by: energy\n");
    CHECK(says(peridem, "deck.yaml:12: materials.glass.breaks_by"));
    CHECK(says(peridem, "critical_stretch_formula: energy_balance"));
    CHECK(says(message_of("    breaks_by: enrgy\n"), "did you mean energy?"));
}
