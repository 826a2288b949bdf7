// Decks on disk for the tests: a valid one, and variants of it.
#pragma once

#include <fmt/format.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "src/deck/read_deck.hpp"

namespace quern {

/// A folder that vanishes with its files.
class TempFolder {
  public:
    TempFolder() : path_(make_path()) {}
    ~TempFolder() { std::filesystem::remove_all(path_); }
    TempFolder(const TempFolder&) = delete;
    TempFolder& operator=(const TempFolder&) = delete;

    std::string write(const std::string& name, const std::string& text) const {
        const std::string file = (path_ / name).string();
        std::ofstream(file) << text;
        return file;
    }

  private:
    static std::filesystem::path make_path() {
        std::string pattern = (std::filesystem::temp_directory_path() / "quern_deck_XXXXXX").string();
        if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
        return pattern;
    }
    std::filesystem::path path_;
};

/// A valid deck in 2D; its lines are counted by the tests of messages.
inline const std::string plain_deck = R"(title: Two disks
dimension: 2
params: {speed: 2 m/s, mu: 0.3, word: pair, unused: 1}
time:
  end: 1 ms
  step: auto
gravity: [0, -9.8]
materials:
  glass:
    density: 2440 kg/m^3
    bulk_modulus: 40 GPa
    shear_modulus: 24 GPa
shapes:
  disk:
    type: disk
    filling: rings
    radius: 1 mm
    spacing: 0.1 mm
grid:
  origin: [0, 0]
  extent: [10 mm, 8 mm]
  spacing: 0.2 mm
  periodic: []
walls:
  - {side: y-, friction: 0.3}
contact:
  rule: pair
  friction: 0.1
  pairs: [{between: [glass, glass], friction: 0.2}]
grains:
  - {shape: disk, material: glass, position: [2 mm, 2 mm]}
  - {shape: disk, material: glass, position: [5 mm, 2 mm]}
output:
  interval: 10 us
)";

/// `text` with one occurrence of `from` replaced; an error if there is none.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    if (at == std::string::npos) throw std::logic_error("not in the deck: " + from);
    return text.replace(at, from.size(), to);
}

inline Deck read_text(const std::string& text, const std::vector<std::string>& overrides = {}) {
    const TempFolder folder;
    return read_deck(folder.write("deck.yaml", text), overrides);
}

}  // namespace quern
