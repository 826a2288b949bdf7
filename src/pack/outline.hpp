// The form of a grain, without its size: a disk or a convex polygon.
#pragma once

#include <string>
#include <vector>

namespace quern {

struct ShapeDeck;

/// Area pi/4, centre of area at the origin: its size, the diameter of the disk of equal area, is 1. (An
/// ellipse has this area; its corners enclose a little more.)
struct Outline {
    std::string name;
    bool disk = true;
    std::vector<double> x, y;    ///< corners counter-clockwise; none for a disk
    std::vector<double> nx, ny;  ///< outward normals; edge i runs from corner i to the next
    double reach = 0.5;          ///< largest distance of a point from the centre
    double inner = 0.5;          ///< distance of the nearest edge from the centre
    double reference = 1.0;      ///< size of the shape as the deck gives it [m]
    int n() const { return static_cast<int>(x.size()); }
};

/// A shape of the deck; ellipses become polygons of 64 corners that touch them from outside, area larger by
/// 0.08 %. Throws InputError for a polygon that is not convex.
Outline make_outline(const ShapeDeck& shape);

}  // namespace quern
