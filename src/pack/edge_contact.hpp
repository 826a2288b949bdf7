// Body of for_each_edge_contact(): included by overlap.hpp only.
#pragma once

#include <cmath>

namespace quern {

template <class F>
void for_each_edge_contact(const PackedGrains& g, double factor, double margin, const TurnedCorners& corners,
                           int i, F f) {
    const Region& region = g.region;
    const Outline& outline = g.outline_of(i);
    const double reach = factor * g.reach(i);
    if (region.circle) {
        const double dx = g.x[i] - region.centre[0], dy = g.y[i] - region.centre[1];
        const double r = std::sqrt(dx * dx + dy * dy);
        if (r + reach <= region.radius) return;
        if (outline.disk) {
            const double nx = r > 0.0 ? -dx / r : 1.0, ny = r > 0.0 ? -dy / r : 0.0;
            return f(r + reach - region.radius, nx, ny, -nx * reach, -ny * reach);
        }
        for (int k = corners.first[i]; k < corners.first[i] + outline.n(); ++k) {
            const double px = dx + corners.x[k], py = dy + corners.y[k];
            const double far = std::sqrt(px * px + py * py);
            if (far > region.radius) f(far - region.radius, -px / far, -py / far, corners.x[k], corners.y[k]);
        }
        return;
    }
    for (int axis = 0; axis < 2; ++axis) {
        if (region.rule[axis] == EdgeRule::periodic) continue;
        const bool open = region.rule[axis] == EdgeRule::open;
        const double at = axis == 0 ? g.x[i] : g.y[i];
        for (int upper = 0; upper < 2; ++upper) {
            const double n = upper ? -1.0 : 1.0;
            const double inside = upper ? region.high[axis] - at : at - region.low[axis];
            const double nx = axis == 0 ? n : 0.0, ny = axis == 0 ? 0.0 : n;
            if (open) {
                if (inside < margin) f(margin - inside, nx, ny, 0.0, 0.0);
                continue;
            }
            if (inside >= reach) continue;
            if (outline.disk) {
                f(reach - inside, nx, ny, -nx * reach, -ny * reach);
                continue;
            }
            for (int k = corners.first[i]; k < corners.first[i] + outline.n(); ++k) {
                const double depth = -n * (axis == 0 ? corners.x[k] : corners.y[k]) - inside;
                if (depth > 0.0) f(depth, nx, ny, corners.x[k], corners.y[k]);
            }
        }
    }
}

}  // namespace quern
