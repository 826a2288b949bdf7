// How much a bond counts by its length, and the integrals of that over a full family.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "particles/material.hpp"

namespace quern {

/// w(r), r = xi/horizon in (0, 1]; no unit. The cone ends at zero: a bond at the horizon does not count.
inline double influence(Influence kind, double r) {
    switch (kind) {
        case Influence::constant:
            return 1.0;
        case Influence::inverse:
            return 1.0 / r;
        case Influence::conical:
            return std::max(0.0, 1.0 - r);
        case Influence::gaussian:
            return std::exp(-4.0 * r * r);
    }
    return 0.0;
}

/// Volume of the full family, the ball of radius `horizon` [m^2 | m^3].
template <int Dim>
double ball_volume(double horizon) {
    return (Dim == 2 ? std::numbers::pi : 4.0 / 3.0 * std::numbers::pi) * std::pow(horizon, Dim);
}

/// Weighted volume of the full continuous family,
///
///     m = int_ball w xi^2 dV = S horizon^(n+2) int_0^1 w(r) r^(n+1) dr      [m^4 | m^5]
///
/// with n = Dim and S = 2 pi | 4 pi: what the sum over bonds tends to as the nodes get denser.
template <int Dim>
double weighted_ball_volume(Influence kind, double horizon) {
    constexpr double n = Dim;
    const double e4 = std::exp(-4.0);
    double radial = 0.0;
    switch (kind) {
        case Influence::constant:
            radial = 1.0 / (n + 2.0);
            break;
        case Influence::inverse:
            radial = 1.0 / (n + 1.0);
            break;
        case Influence::conical:
            radial = 1.0 / (n + 2.0) - 1.0 / (n + 3.0);
            break;
        case Influence::gaussian:
            radial = Dim == 2 ? (1.0 - 5.0 * e4) / 32.0
                              : 3.0 * std::sqrt(std::numbers::pi) * std::erf(2.0) / 256.0 - e4 * 11.0 / 64.0;
            break;
    }
    return (Dim == 2 ? 2.0 : 4.0) * std::numbers::pi * std::pow(horizon, Dim + 2) * radial;
}

}  // namespace quern
