#include "src/pack/outline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "grid/error.hpp"
#include "src/deck/deck.hpp"
#include "src/pack/portable_math.hpp"

namespace quern {
namespace {

using std::numbers::pi;
using Corners = std::vector<std::array<double, 2>>;

double cross(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c) {
    return (b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]);
}

/// Turns left at every corner, and once round.
bool is_convex(const Corners& corners) {
    const std::size_t n = corners.size();
    double turned = 0.0;
    for (std::size_t i = 0; i < n; ++i) {
        const auto &a = corners[i], &b = corners[(i + 1) % n], &c = corners[(i + 2) % n];
        const double turn = cross(a, b, c);
        if (!(turn > 0.0)) return false;
        turned += portable::angle_of((b[0] - a[0]) * (c[0] - b[0]) + (b[1] - a[1]) * (c[1] - b[1]), turn);
    }
    return turned < 3.0 * pi;
}

Corners corners_of(const ShapeDeck& shape) {
    Corners corners;
    const auto on_circle = [&corners](int n, double rx, double ry, double first) {
        for (int i = 0; i < n; ++i) {
            const portable::Direction d = portable::direction(first + 2.0 * pi * i / n);
            corners.push_back({rx * d.cos, ry * d.sin});
        }
    };
    switch (shape.kind) {
        case ShapeKind::rectangle: {
            const double a = 0.5 * shape.size[0], b = 0.5 * shape.size[1];
            return {{-a, -b}, {a, -b}, {a, b}, {-a, b}};
        }
        case ShapeKind::regular_polygon:
            on_circle(shape.sides, shape.radius, shape.radius, 0.0);
            return corners;
        case ShapeKind::ellipse: {
            // Edges touch the ellipse from outside: where polygons do not overlap, ellipses do not.
            constexpr int n = 64;
            const double larger = 1.0 / portable::direction(pi / n).cos;
            on_circle(n, larger * shape.semi_axes[0], larger * shape.semi_axes[1], pi / n);
            return corners;
        }
        default:
            return shape.vertices;
    }
}

/// Moves the centre of area to the origin and returns the area.
double centre(Corners& corners) {
    const std::array<double, 2> o = corners[0];
    double area = 0.0, mx = 0.0, my = 0.0;
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        const auto &a = corners[i], &b = corners[i + 1];
        const double part = 0.5 * ((a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]));
        area += part;
        mx += part * (a[0] + b[0] - 2.0 * o[0]) / 3.0;
        my += part * (a[1] + b[1] - 2.0 * o[1]) / 3.0;
    }
    for (auto& [x, y] : corners) {
        x -= o[0] + mx / area;
        y -= o[1] + my / area;
    }
    return area;
}

}  // namespace

Outline make_outline(const ShapeDeck& shape) {
    Outline outline;
    outline.name = shape.name;
    if (shape.kind == ShapeKind::disk) {
        outline.reference = 2.0 * shape.radius;
        return outline;
    }
    Corners corners = corners_of(shape);
    if (!is_convex(corners)) {
        Place place = shape.place;
        place.key += ".vertices";
        throw InputError(place.text(), "a polygon that is not convex", "corners that all turn the same way",
                         "packings are made of convex grains");
    }
    const bool ellipse = shape.kind == ShapeKind::ellipse;
    const double polygon_area = centre(corners);
    const double area = ellipse ? pi * shape.semi_axes[0] * shape.semi_axes[1] : polygon_area;
    outline.disk = false;
    outline.reference = std::sqrt(4.0 * area / pi);
    outline.reach = 0.0;
    outline.inner = outline.reference;
    for (auto& [x, y] : corners) {
        outline.x.push_back(x / outline.reference);
        outline.y.push_back(y / outline.reference);
        outline.reach = std::max(outline.reach, std::sqrt(x * x + y * y) / outline.reference);
    }
    for (int e = 0; e < outline.n(); ++e) {
        const int f = e + 1 < outline.n() ? e + 1 : 0;
        const double tx = outline.x[f] - outline.x[e], ty = outline.y[f] - outline.y[e];
        const double length = std::sqrt(tx * tx + ty * ty);
        outline.nx.push_back(ty / length);
        outline.ny.push_back(-tx / length);
        outline.inner =
            std::min(outline.inner, outline.nx.back() * outline.x[e] + outline.ny.back() * outline.y[e]);
    }
    return outline;
}

}  // namespace quern
