// Overlap of two grains, and of a grain with the edges of the region.
#pragma once

#include <vector>

#include "src/pack/grains.hpp"

namespace quern {

/// Corners and edge normals of all grains as they lie, from their centres; no entries for disks.
struct TurnedCorners {
    std::vector<int> first;  ///< of grain i
    std::vector<double> x, y, nx, ny;
};
/// `factor`: of all sizes.
void turn_corners(const PackedGrains& grains, double factor, TurnedCorners& corners);

/// One point of a contact.
struct ContactPoint {
    double depth;   ///< > 0 [m]
    double nx, ny;  ///< direction in which the second grain is pushed
    double x, y;    ///< from the centre of the first grain [m]
};

/// Points of a contact: at most two between grains, one a corner beyond an edge.
struct Contact {
    int n = 0;
    ContactPoint point[2];
    void add(const ContactPoint& p) { point[n++] = p; }
};

/// Two disks: depth d = R1 + R2 - |x2 - x1|.
///
/// Two convex polygons, by separating axes: of all edges' normals that of the least depth; the edge of the
/// other grain that lies against it is cut to its length, and both ends of what is left are points of the
/// contact where they are inside. Two points, so that flat faces turn onto each other.
///
/// Disk and polygon: nearest point of the polygon to the centre of the disk.
Contact find_contact(const PackedGrains& grains, double factor, const TurnedCorners& corners, int i, int j);

/// Calls f(depth, nx, ny, x, y) for every point of a grain that is where it must not be; n: into the region,
/// (x, y): from the centre of the grain. Open edges: the centre nearer to the edge than `margin`.
template <class F>
void for_each_edge_contact(const PackedGrains& g, double factor, double margin, const TurnedCorners& corners,
                           int i, F f);

}  // namespace quern

#include "src/pack/edge_contact.hpp"
