// Scenes of small decks that tests step by hand.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "src/sim/observe.hpp"
#include "src/sim/step.hpp"
#include "tests/sim/decks.hpp"

namespace quern::test {

/// The scene of a deck with the velocities of its start.
template <int Dim>
std::unique_ptr<Scene<Dim>> scene_of(const std::string& text,
                                     const std::vector<std::string>& overrides = {}) {
    const TempFolder folder;
    const Deck deck = read_deck(folder.write("deck.yaml", text), overrides);
    std::unique_ptr<Scene<Dim>> scene = make_scene<Dim>(deck);
    set_initial_velocities(deck, *scene);
    return scene;
}

/// What some steps have broken, and the state after them.
struct Outcome {
    std::int64_t newly_broken = 0;
    double fracture = 0.0, elastic = 0.0;  ///< [J; 2D: J/m]
    Frame frame;
};

/// Steps of 0.3 of the stable one, from the start of the clock.
inline Outcome advance(Scene<2>& scene, int steps) {
    StepContext<2> now = make_context(scene, 0.3 * scene.stable_step());
    for (int k = 0; k < steps; ++k) {
        kick(scene, now);
        drift(scene, now);
    }
    Outcome outcome{now.newly_broken, now.ledger.past.fracture, scene.elastic_energy(), {}};
    make_frame(scene, now, outcome.frame);
    return outcome;
}

}  // namespace quern::test
