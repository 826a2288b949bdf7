#include "src/pack/overlap.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace quern {
namespace {

/// A polygon as it lies, from its own centre.
struct Corners {
    int n;
    const double *x, *y, *nx, *ny;
    int next(int k) const { return k + 1 < n ? k + 1 : 0; }
};

Corners corners_of(const PackedGrains& grains, const TurnedCorners& all, int i) {
    const int first = all.first[i];
    return {grains.outline_of(i).n(), &all.x[first], &all.y[first], &all.nx[first], &all.ny[first]};
}

/// The edge of `a` along whose normal `b`, which lies at (dx, dy), is farthest out; negative: inside.
struct Separation {
    double distance = -std::numeric_limits<double>::max();
    int edge = 0, support = 0;
};

Separation find_separation(const Corners& a, const Corners& b, double dx, double dy) {
    Separation best;
    int support = 0;
    for (int e = 0; e < a.n; ++e) {
        const double nx = a.nx[e], ny = a.ny[e];
        const auto height = [&](int k) { return nx * b.x[k] + ny * b.y[k]; };
        // Normals and the corners that lie deepest against them both run round counter-clockwise.
        if (e == 0)
            for (int k = 1; k < b.n; ++k) support = height(k) < height(support) ? k : support;
        while (height(b.next(support)) < height(support)) support = b.next(support);
        const double distance = height(support) + nx * (dx - a.x[e]) + ny * (dy - a.y[e]);
        if (distance > best.distance) best = {distance, e, support};
        if (distance > 0.0) return best;
    }
    return best;
}

/// `a` gives the face, `b` lies at (dx, dy) against it; `sign`: -1 where `a` is the second grain of the pair.
Contact clip_onto_face(const Corners& a, const Corners& b, double dx, double dy, const Separation& face,
                       double sign) {
    const int e = face.edge, f = a.next(e);
    const double nx = a.nx[e], ny = a.ny[e];
    const int before = face.support == 0 ? b.n - 1 : face.support - 1;
    const bool first =
        nx * b.nx[before] + ny * b.ny[before] < nx * b.nx[face.support] + ny * b.ny[face.support];
    const int k0 = first ? before : face.support, k1 = b.next(k0);
    double x[2] = {b.x[k0] + dx, b.x[k1] + dx}, y[2] = {b.y[k0] + dy, b.y[k1] + dy};
    // Along the face from its first corner.
    const double tx = -ny, ty = nx;
    const double begin = tx * a.x[e] + ty * a.y[e], end = tx * a.x[f] + ty * a.y[f];
    double t[2];
    for (int k = 0; k < 2; ++k) t[k] = tx * x[k] + ty * y[k];
    Contact contact;
    if (std::max(t[0], t[1]) <= begin || std::min(t[0], t[1]) >= end || t[0] == t[1]) {
        const double px = b.x[face.support] + dx, py = b.y[face.support] + dy;
        contact.add({-face.distance, sign * nx, sign * ny, px, py});
        return contact;
    }
    const double ux = (x[1] - x[0]) / (t[1] - t[0]), uy = (y[1] - y[0]) / (t[1] - t[0]);
    const double x0 = x[0], y0 = y[0], t0 = t[0];
    for (int k = 0; k < 2; ++k) {
        const double clipped = std::clamp(t[k], begin, end);
        const double px = x0 + (clipped - t0) * ux, py = y0 + (clipped - t0) * uy;
        const double depth = -(nx * (px - a.x[e]) + ny * (py - a.y[e]));
        if (depth > 0.0) contact.add({depth, sign * nx, sign * ny, px, py});
    }
    return contact;
}

Contact polygon_contact(const Corners& a, const Corners& b, double dx, double dy) {
    const Separation of_a = find_separation(a, b, dx, dy);
    if (of_a.distance >= 0.0) return {};
    const Separation of_b = find_separation(b, a, -dx, -dy);
    if (of_b.distance >= 0.0) return {};
    if (of_a.distance >= of_b.distance) return clip_onto_face(a, b, dx, dy, of_a, 1.0);
    Contact contact = clip_onto_face(b, a, -dx, -dy, of_b, -1.0);
    for (int k = 0; k < contact.n; ++k) {
        contact.point[k].x += dx;
        contact.point[k].y += dy;
    }
    return contact;
}

/// A disk at (dx, dy) from the centre of a polygon; n from the polygon to the disk.
Contact polygon_disk_contact(const Corners& a, double radius, double dx, double dy) {
    int edge = 0;
    double farthest = -std::numeric_limits<double>::max();
    for (int e = 0; e < a.n; ++e) {
        const double distance = a.nx[e] * (dx - a.x[e]) + a.ny[e] * (dy - a.y[e]);
        if (distance > radius) return {};
        if (distance > farthest) farthest = distance, edge = e;
    }
    const double nx = a.nx[edge], ny = a.ny[edge];
    Contact contact;
    const auto face = [&] {
        contact.add({radius - farthest, nx, ny, dx - farthest * nx, dy - farthest * ny});
        return contact;
    };
    if (farthest <= 0.0) return face();
    const int next = a.next(edge);
    const double tx = -ny, ty = nx;
    const double t = tx * dx + ty * dy;
    const bool before = t<tx * a.x[edge] + ty * a.y[edge], behind = t> tx * a.x[next] + ty * a.y[next];
    if (!before && !behind) return face();
    const int k = before ? edge : next;
    const double ex = dx - a.x[k], ey = dy - a.y[k], distance = std::sqrt(ex * ex + ey * ey);
    if (distance < radius) contact.add({radius - distance, ex / distance, ey / distance, a.x[k], a.y[k]});
    return contact;
}

}  // namespace

void turn_corners(const PackedGrains& grains, double factor, TurnedCorners& corners) {
    corners.first.resize(static_cast<std::size_t>(grains.n()));
    int n = 0;
    for (int i = 0; i < grains.n(); ++i) {
        corners.first[i] = n;
        n += grains.outline_of(i).n();
    }
    for (std::vector<double>* v : {&corners.x, &corners.y, &corners.nx, &corners.ny})
        v->resize(static_cast<std::size_t>(n));
    for (int i = 0; i < grains.n(); ++i) {
        const Outline& o = grains.outline_of(i);
        const double c = grains.c[i], s = grains.s[i], size = factor * grains.size[i];
        for (int k = 0, to = corners.first[i]; k < o.n(); ++k, ++to) {
            corners.x[to] = size * (c * o.x[k] - s * o.y[k]);
            corners.y[to] = size * (s * o.x[k] + c * o.y[k]);
            corners.nx[to] = c * o.nx[k] - s * o.ny[k];
            corners.ny[to] = s * o.nx[k] + c * o.ny[k];
        }
    }
}

Contact find_contact(const PackedGrains& grains, double factor, const TurnedCorners& corners, int i, int j) {
    const Shift d = shift_between(grains, i, j);
    const double together = factor * (grains.reach(i) + grains.reach(j)), dd = d.x * d.x + d.y * d.y;
    Contact contact;
    if (dd >= together * together) return contact;
    const bool disk_i = grains.outline_of(i).disk, disk_j = grains.outline_of(j).disk;
    if (disk_i && disk_j) {
        const double distance = std::sqrt(dd), r = factor * grains.reach(i);
        const double nx = distance > 0.0 ? d.x / distance : 1.0, ny = distance > 0.0 ? d.y / distance : 0.0;
        contact.add({together - distance, nx, ny, r * nx, r * ny});
        return contact;
    }
    if (!disk_i && !disk_j)
        return polygon_contact(corners_of(grains, corners, i), corners_of(grains, corners, j), d.x, d.y);
    if (disk_j)
        return polygon_disk_contact(corners_of(grains, corners, i), factor * grains.reach(j), d.x, d.y);
    contact = polygon_disk_contact(corners_of(grains, corners, j), factor * grains.reach(i), -d.x, -d.y);
    for (int k = 0; k < contact.n; ++k) {
        ContactPoint& p = contact.point[k];
        p = {p.depth, -p.nx, -p.ny, p.x + d.x, p.y + d.y};
    }
    return contact;
}

}  // namespace quern
