// Where grains are packed: a box, each axis of which is closed, open or periodic, or a circle.
#pragma once

#include <array>

namespace quern {

/// closed: grains stay inside; open: their centres do; periodic: the two edges are one.
enum class EdgeRule { closed, open, periodic };

struct Region {
    bool circle = false;
    std::array<double, 2> low{}, high{};  ///< of a circle: its bounding box [m]
    std::array<EdgeRule, 2> rule{};
    std::array<double, 2> centre{};
    double radius = 0.0;

    double length(int axis) const { return high[axis] - low[axis]; }
    double area() const;  ///< [m^2]
    bool periodic(int axis) const { return !circle && rule[axis] == EdgeRule::periodic; }
    bool open(int axis) const { return !circle && rule[axis] == EdgeRule::open; }
};

}  // namespace quern
