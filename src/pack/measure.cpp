#include "src/pack/measure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "particles/solids.hpp"

namespace quern {
namespace {

using std::numbers::pi;

/// Distance of a grain from an edge of the box, negative where it reaches over it.
double gap_to_side(const PackedGrains& g, const TurnedCorners& corners, int i, int axis, bool upper) {
    const double at = axis == 0 ? g.x[i] : g.y[i];
    double gap = upper ? g.region.high[axis] - at : at - g.region.low[axis];
    const Outline& outline = g.outline_of(i);
    if (outline.disk) return gap - g.reach(i);
    double out = 0.0;
    for (int k = corners.first[i]; k < corners.first[i] + outline.n(); ++k) {
        const double along = axis == 0 ? corners.x[k] : corners.y[k];
        out = std::max(out, upper ? along : -along);
    }
    return gap - out;
}

double gap_to_rim(const PackedGrains& g, const TurnedCorners& corners, int i) {
    const Outline& outline = g.outline_of(i);
    const double dx = g.x[i] - g.region.centre[0], dy = g.y[i] - g.region.centre[1];
    if (outline.disk) return g.region.radius - std::sqrt(dx * dx + dy * dy) - g.reach(i);
    double out = 0.0;
    for (int k = corners.first[i]; k < corners.first[i] + outline.n(); ++k) {
        const double px = dx + corners.x[k], py = dy + corners.y[k];
        out = std::max(out, std::sqrt(px * px + py * py));
    }
    return g.region.radius - out;
}

}  // namespace

double solid_fraction(const PackedGrains& g, double factor) {
    TurnedCorners corners;
    turn_corners(g, factor, corners);
    double sum = 0.0;
    for (int i = 0; i < g.n(); ++i) {
        const Outline& outline = g.outline_of(i);
        const double size = factor * g.size[i], whole = 0.25 * pi * size * size, reach = factor * g.reach(i);
        Vec<2> low, high;
        bool cut = false;
        for (int axis = 0; axis < 2; ++axis) {
            const double at = axis == 0 ? g.x[i] : g.y[i];
            low[axis] = -2.0 * reach;
            high[axis] = 2.0 * reach;
            if (!g.region.open(axis)) continue;
            low[axis] = std::max(low[axis], g.region.low[axis] - at);
            high[axis] = std::min(high[axis], g.region.high[axis] - at);
            cut = cut || low[axis] > -reach || high[axis] < reach;
        }
        if (!cut) {
            sum += whole;
        } else if (outline.disk) {
            sum += Ball<2>(reach).overlap(low, high);
        } else {
            std::vector<Vec<2>> ring;
            for (int k = corners.first[i]; k < corners.first[i] + outline.n(); ++k)
                ring.emplace_back(corners.x[k], corners.y[k]);
            const Polygon polygon(ring);
            sum += whole * polygon.overlap(low, high) / polygon.measure();
        }
    }
    return sum / g.region.area();
}

double deepest_overlap(const PackedGrains& grains) {
    SoftGrains all(grains);
    all.look();
    return all.deepest();
}

double coordination(const PackedGrains& grains) {
    SoftGrains larger(grains);
    larger.set_factor(1.001);
    larger.look();
    return 2.0 * larger.n_contacts() / grains.n();
}

std::vector<std::string> find_groups(const PackedGrains& g, const EdgeGroups& edges) {
    TurnedCorners corners;
    turn_corners(g, 1.0, corners);
    const std::string* names[] = {&edges.x_low, &edges.x_high, &edges.y_low, &edges.y_high};
    std::vector<std::string> groups(static_cast<std::size_t>(g.n()));
    for (int i = 0; i < g.n(); ++i) {
        const double touch = 1e-3 * g.size[i];
        if (g.region.circle) {
            if (gap_to_rim(g, corners, i) < touch) groups[i] = edges.rim;
            continue;
        }
        for (int side = 3; side >= 0; --side) {
            const int axis = side / 2;
            if (names[side]->empty()) continue;
            const double near = g.region.open(axis) ? 0.0 : touch;
            if (gap_to_side(g, corners, i, axis, side % 2 == 1) < near) groups[i] = *names[side];
        }
    }
    return groups;
}

}  // namespace quern
