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

/// Everything a deck can hold, in 3D.
inline const std::string full_deck = R"(title: 'All of it: "${word}" at ${theta}'
dimension: 3
params:
  theta: 60 deg
  word: seed
  half: ${mu/2}      # used before it is given
  mu: 0.3
  speed: ${100*half} mm/us
  ramp: min(t/1e-3, 1)
time: {end: 2 min, step: 0.5 us, safety: 0.7}
gravity: [${9.8*sin(theta)}, 0, ${-9.8*cos(theta)}]
materials:
  glass: {density: 2.44 g/cm^3, young_modulus: 72 GPa, poisson_ratio: 0.25, model: bond_based,
          horizon_ratio: 3, influence: gaussian, calibration: none, surface_correction: volume,
          bond_damping: 2 us, critical_stretch: 0.1 %, strength: {weibull_modulus: 8, seed: 3}}
  "odd name, really": {density: 1 t/m^3, bulk_modulus: 1 GPa, young_modulus: 2 GPa}
shapes:
  ball: {type: sphere, filling: rings, radius: 1 cm, spacing: 1 mm}
  brick: {type: box, size: [1 cm, 2 cm, 3 cm], spacing: 2 mm}
grid: {origin: [-1, -1, -1], extent: [2, 2.05, 2], spacing: 0.1, periodic: [x]}
walls:
  - {side: y+, friction: ${mu}, velocity: [0, '-${speed}*${ramp}', 0]}
  - {name: slope, point: [0, -0.9, 0], normal: [0, 3, 4]}
contact:
  rule: ${word}
  coupling: flip
  friction: ${half}
  pairs:
    - {between: [glass, "odd name, really"], friction: 0.5}
  interior_weight: 10 %
  max_sweeps: ${2*5}
  tolerance: 1e-4
  tile: false
  curvature: false
  rotation: false
  gap_test: false
  exact_mass: false
damping: {mass: 3 Hz}
loads:
  - {grains: [1], region: 'if(x > 0, 1, 0)', force_density: [0, 1 kN/m^3, sin(2*pi*t)]}
  - {acceleration: [x*y*z*t, 0, 0]}
constraints:
  - {grains: all, region: z < -0.5, velocity: [free, 0.1 mm/us, ~]}
prepare: {duration: 0.1, gravity: [0, 0, -1], mass_damping: 5, friction: 0}
output: {interval: 1 s, history_interval: 10 ms, track: [0, 1], vtp: true}
grains:
  - {shape: ball, material: glass, position: [0, 1 cm, 20 mm], angle: [0, 0, 90 deg], spin: [60 rpm, 0, 0]}
  - {shape: brick, material: "odd name, really", position: [0, 0.5, 0], velocity: [1 km/h, 0, 0], scale: 1.5}
cracks:
  - {shape: brick, frame: shape, from: [0, 0, 0], to: [1 cm, 0, 0], edge: [0, 1 cm, 0]}
no_fail: [{grains: [1], region: 'x + y < 0'}]
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
