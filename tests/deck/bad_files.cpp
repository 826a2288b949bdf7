// Decks and grain files that cannot be read at all, and what the message says of them.
#include <doctest/doctest.h>

#include "grid/error.hpp"
#include "tests/deck/deck_files.hpp"

using namespace quern;

TEST_CASE("Deck: a file that is no deck is named") {
    const TempFolder folder;
    const auto message = [](const std::string& file) {
        try {
            read_deck(file);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    const std::string missing = folder.write("x", "") + ".yaml";
    CHECK(message(missing).find(missing + ": got no such file") == 0);
    CHECK(message(folder.write("empty.yaml", "")).find("expected a deck") != std::string::npos);
    CHECK(message(folder.write("list.yaml", "- 1\n- 2\n")).find("got a list") != std::string::npos);
    CHECK(message(std::filesystem::temp_directory_path().string()).find("got a folder") != std::string::npos);
}

TEST_CASE("Deck: each bad cell of a grain file is named by line and column") {
    struct BadFile {
        std::string text;
        std::vector<std::string> parts;
    };
    const BadFile files[] = {
        {"x,y,radios\n", {"grains.csv:1", "unknown column 'radios'", "did you mean radius?"}},
        {"x,y,z\n", {"grains.csv:1", "unknown column 'z'"}},
        {"x,scale\n", {"grains.csv:1", "no column y"}},
        {"x,y,x\n", {"grains.csv:1", "column x a second time"}},
        {"x,y,scale,radius\n", {"grains.csv:1", "scale and radius"}},
        {"x,y\n", {"grains.csv", "no rows"}},
        {"", {"grains.csv", "no rows"}},
        {"x,y\n1e-3,2e-3\n1e-3,two\n", {"grains.csv:3: column 2 (y)", "'two'", "a number in SI units"}},
        {"x,y\n1e-3,\n", {"grains.csv:2: column 2 (y)", "''", "a number"}},
        {"x,y\n1 mm,2\n", {"grains.csv:2: column 1 (x)", "'1 mm'", "SI"}},
        {"x,y\n1e-3\n", {"grains.csv:2", "1 cells", "2 cells"}},
        {"# a comment\n\nx,y\n1e-3,2e-3,3\n", {"grains.csv:4", "3 cells"}},
        {"x,y,radius\n1e-3,2e-3,-1\n", {"grains.csv:2: column 3 (radius)", "> 0"}},
        {"x,y,material\n1e-3,2e-3,glas\n", {"grains.csv:2: material", "did you mean glass?"}},
        {"x,y,shape\n1e-3,2e-3,\n", {"grains.csv:2: column 3 (shape)", "nothing", "a name"}},
        {"x,y\n1,2e-3\n", {"grains.csv:2: position", "grain 0", "inside the grid box"}},
    };
    for (const BadFile& bad : files) {
        CAPTURE(bad.text);
        const TempFolder folder;
        folder.write("grains.csv", bad.text);
        std::string message = "no error";
        try {
            read_deck(folder.write("deck.yaml",
                                   replaced(plain_deck, "position: [2 mm, 2 mm]", "file: grains.csv")));
        } catch (const InputError& error) {
            message = error.what();
        }
        CAPTURE(message);
        for (const std::string& part : bad.parts) CHECK(message.find(part) != std::string::npos);
    }
}
