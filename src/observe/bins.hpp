// Means over slices of a box along an axis.
//
// A particle stands for a square (cube) of its own volume, s = V^(1/d) wide, with its edges along the axes.
// It gives every slice the part of itself that lies in it:
//
//     solid fraction  sum w_pk V_p / V_k         mean of q   sum w_pk V_p q_p / sum w_pk V_p
//
//     w_pk length of [x_p - s/2, x_p + s/2] in slice k over s, V_k volume of the slice, V_p of the particle
//     in the reference [m^3; 2D: m^2]
//
// Sums over all slices are exact. One slice is off by what the particles at its two faces are not squares:
// tests/observe measures it. Along a periodic axis what sticks out comes in on the other side; else it counts
// for nothing. Our own; means by volume as in Babic, Int. J. Eng. Sci. 35 (1997) 523, with a box for weight.
#pragma once

#include <vector>

namespace quern {

/// Equal slices of [from, to].
struct Slices {
    double from = 0.0, to = 1.0;  ///< [m]
    int n = 1;
    bool periodic = false;  ///< with the period to - from
    double width() const { return (to - from) / n; }
};

/// A slice and the part of a particle in it.
struct SlicePart {
    int slice = 0;
    double part = 0.0;
};

/// Parts of [x - size/2, x + size/2] over `size`; `parts` is cleared first.
void split(const Slices& slices, double x, double size, std::vector<SlicePart>& parts);

}  // namespace quern
