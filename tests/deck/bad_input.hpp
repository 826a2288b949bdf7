// Bad decks and the parts of the message that each must give.
#pragma once

#include <doctest/doctest.h>

#include <span>
#include <string>
#include <vector>

#include "grid/error.hpp"
#include "tests/deck/deck_files.hpp"

namespace quern {

struct BadInput {
    std::string what;
    const char* from;  ///< in plain_deck; "": `to` is added at the end
    const char* to;
    std::vector<std::string> parts;  ///< of the message
};

/// What reading a deck says; "no error" if it is read.
inline std::string message_of(const std::string& text, const std::vector<std::string>& overrides = {}) {
    try {
        read_text(text, overrides);
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

/// Each changes plain_deck so that reading it fails with one line that holds all parts.
inline void check_messages(std::span<const BadInput> inputs) {
    REQUIRE_NOTHROW(read_text(plain_deck));
    for (const BadInput& bad : inputs) {
        CAPTURE(bad.what);
        const std::string from = bad.from;
        const std::string deck = from.empty() ? plain_deck + bad.to : replaced(plain_deck, from, bad.to);
        const std::string message = message_of(deck);
        CAPTURE(message);
        if (bad.parts.empty()) CHECK(message == "no error");
        for (const std::string& part : bad.parts) {
            CAPTURE(part);
            CHECK(message.find(part) != std::string::npos);
        }
        CHECK(message.find('\n') == std::string::npos);
    }
}

}  // namespace quern
