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

/// int_0^1 w(r) r^power dr, power >= 1; no unit. The Gaussian goes down two powers at a time, by parts.
inline double influence_moment(Influence kind, int power) {
    const double p = power;
    switch (kind) {
        case Influence::constant:
            return 1.0 / (p + 1.0);
        case Influence::inverse:
            return 1.0 / p;
        case Influence::conical:
            return 1.0 / (p + 1.0) - 1.0 / (p + 2.0);
        case Influence::gaussian:
            if (power == 0) return 0.25 * std::sqrt(std::numbers::pi) * std::erf(2.0);
            return ((power == 1 ? 1.0 : (p - 1.0) * influence_moment(kind, power - 2)) - std::exp(-4.0)) /
                   8.0;
    }
    return 0.0;
}

/// Weighted volume of the full continuous family,
///
///     m = int_ball w xi^2 dV = S horizon^(n+2) int_0^1 w(r) r^(n+1) dr      [m^4 | m^5]
///
/// with n = Dim and S = 2 pi | 4 pi: what the sum over bonds tends to as the nodes get denser.
template <int Dim>
double weighted_ball_volume(Influence kind, double horizon) {
    return (Dim == 2 ? 2.0 : 4.0) * std::numbers::pi * std::pow(horizon, Dim + 2) *
           influence_moment(kind, Dim + 1);
}

}  // namespace quern
