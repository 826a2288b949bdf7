// Grains of a packing: plain arrays.
#pragma once

#include <cmath>
#include <vector>

#include "src/pack/outline.hpp"
#include "src/pack/region.hpp"

namespace quern {

struct PackedGrains {
    std::vector<double> x, y;  ///< centres [m]
    std::vector<double> c, s;  ///< cosine and sine of the angle
    std::vector<double> size;  ///< [m]
    std::vector<int> outline;  ///< index into `outlines`
    std::vector<Outline> outlines;
    Region region;

    int n() const { return static_cast<int>(x.size()); }
    const Outline& outline_of(int i) const { return outlines[outline[i]]; }
    double reach(int i) const { return outline_of(i).reach * size[i]; }
};

/// Puts centres that have left through a periodic edge back at the other.
inline void wrap(PackedGrains& g) {
    for (int axis = 0; axis < 2; ++axis) {
        if (!g.region.periodic(axis)) continue;
        const double low = g.region.low[axis], length = g.region.length(axis);
        for (double& at : axis == 0 ? g.x : g.y) at -= length * std::floor((at - low) / length);
    }
}

/// Vector between two grains, through the nearest image.
struct Shift {
    double x, y;
};
inline double nearest_image(double d, double length) {
    return d > 0.5 * length ? d - length : d < -0.5 * length ? d + length : d;
}
inline Shift shift_between(const PackedGrains& g, int i, int j) {
    Shift d{g.x[j] - g.x[i], g.y[j] - g.y[i]};
    if (g.region.periodic(0)) d.x = nearest_image(d.x, g.region.length(0));
    if (g.region.periodic(1)) d.y = nearest_image(d.y, g.region.length(1));
    return d;
}

}  // namespace quern
