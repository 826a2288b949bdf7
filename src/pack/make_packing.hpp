// From what is asked to grains at their places.
#pragma once

#include <functional>

#include "src/pack/grains.hpp"
#include "src/pack/pack_spec.hpp"

namespace quern {

struct Packing {
    PackedGrains grains;  ///< of their final sizes
    double fraction = 0.0, asked = 0.0;
    double size_factor = 1.0;  ///< final sizes over those drawn
    double shrink = 0.0;   ///< part by which all grains were made smaller at the end, to take overlap away
    bool reached = false;  ///< the fraction that was asked for
    int rounds = 0;        ///< of exchanges
};

/// How far it has come: part done, from 0 to 1, area of the whole grains over that of the region, deepest
/// overlap.
using PackProgress = std::function<void(double done, double fraction, double deepest)>;

/// Packs in three stages:
///
/// 1. Growth: grains at random places, a third of their area; 40 steps of growth, overlap relaxed after each.
/// 2. Dense: sizes above the target by 1 % of area and more, as far as overlap allows. A round is three
///    attempts a grain to exchange places with one of like size, where that lowers the energy, and 150 steps
///    of relaxation. Every few rounds the sizes go down to the target; done when no overlap is left.
///    Exchanges find packings denser than any growth: power-law disks 1 to 8 jam at 0.866 without and pass
///    0.90 with.
/// 3. Open edges: the fraction is measured with grains cut at the edges, and sizes follow until it is right.
///
/// The same bits for the same spec on every machine. Throws InputError for grains that do not fit the region,
/// a fraction that the given count cannot make, or too many grains.
Packing make_packing(const PackSpec& spec, const PackProgress& progress = {});

}  // namespace quern
