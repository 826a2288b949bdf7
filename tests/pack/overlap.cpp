// Contacts of two grains: depth, direction and place for every pair of forms.
#include <doctest/doctest.h>

#include <cmath>

#include "tests/pack/specs.hpp"

using namespace quern;

namespace {

/// Two grains, the second at (x, y) turned by an angle, in a large box; sizes: those of the shapes.
Contact contact_of(const PackShape& a, const PackShape& b, double x, double y, double angle) {
    PackedGrains g;
    g.region.high = {100.0, 100.0};
    g.outlines = {make_outline(a), make_outline(b)};
    const portable::Direction d = portable::direction(angle);
    g.x = {50.0, 50.0 + x};
    g.y = {50.0, 50.0 + y};
    g.c = {1.0, d.cos};
    g.s = {0.0, d.sin};
    g.outline = {0, 1};
    for (const Outline& outline : g.outlines) g.size.push_back(outline.reference);
    TurnedCorners corners;
    turn_corners(g, 1.0, corners);
    return find_contact(g, 1.0, corners, 0, 1);
}

const PackShape disk = shape_of("d", ShapeKind::disk), box = shape_of("b", ShapeKind::rectangle),
                ellipse = shape_of("e", ShapeKind::ellipse);
constexpr double pi = 3.14159265358979323846;

}  // namespace

TEST_CASE("find_contact: two disks") {
    const Contact contact = contact_of(disk, disk, 1.2, 1.6, 0.0);
    CHECK(contact.n == 0);
    const Contact near = contact_of(disk, disk, 1.14, 1.52, 0.0);
    REQUIRE(near.n == 1);
    CHECK(near.point[0].depth == doctest::Approx(0.1));
    CHECK(near.point[0].nx == doctest::Approx(0.6));
    CHECK(near.point[0].ny == doctest::Approx(0.8));
    CHECK(near.point[0].y == doctest::Approx(0.8));
}

TEST_CASE("find_contact: flat faces touch at both ends of what they share") {
    const Contact contact = contact_of(box, box, 0.5, 0.9, 0.0);  // boxes of 2 by 1
    REQUIRE(contact.n == 2);
    double left = 10.0, right = -10.0;
    for (const ContactPoint& p : contact.point) {
        CHECK(p.depth == doctest::Approx(0.1));
        CHECK(p.ny == doctest::Approx(1.0));
        left = std::min(left, p.x);
        right = std::max(right, p.x);
    }
    CHECK(left == doctest::Approx(-0.5));
    CHECK(right == doctest::Approx(1.0));
}

TEST_CASE("find_contact: a corner on a face") {
    const double half_diagonal = std::sqrt(5.0) / 2.0, turn = -std::atan2(0.5, 1.0) - 0.5 * pi;
    // The corner (1, 0.5) of the upper box points straight down.
    const Contact contact = contact_of(box, box, 0.25, 0.5 + half_diagonal - 0.05, turn);
    REQUIRE(contact.n == 1);
    CHECK(contact.point[0].depth == doctest::Approx(0.05));
    CHECK(contact.point[0].x == doctest::Approx(0.25));
    CHECK(contact.point[0].ny == doctest::Approx(1.0));
}

TEST_CASE("find_contact: a disk on a face, at a corner, and in either order") {
    const Contact face = contact_of(box, disk, 0.3, 1.4, 0.0);
    REQUIRE(face.n == 1);
    CHECK(face.point[0].depth == doctest::Approx(0.1));
    CHECK(face.point[0].x == doctest::Approx(0.3));
    const Contact corner = contact_of(box, disk, 1.0 + 0.54, 0.5 + 0.72, 0.0);
    REQUIRE(corner.n == 1);
    CHECK(corner.point[0].depth == doctest::Approx(0.1));
    CHECK(corner.point[0].nx == doctest::Approx(0.6));
    const Contact back = contact_of(disk, box, -1.0 - 0.54, -0.5 - 0.72, 0.0);
    REQUIRE(back.n == 1);
    CHECK(back.point[0].depth == doctest::Approx(0.1));
    CHECK(back.point[0].nx == doctest::Approx(-0.6));
    CHECK(contact_of(box, disk, 1.0 + 0.66, 0.5 + 0.88, 0.0).n == 0);
}

TEST_CASE("find_contact: depths of polygons are the same from either side") {
    const PackShape polygon = shape_of("p", ShapeKind::polygon);
    int n = 0;
    for (int i = 0; i < 200; ++i) {
        const double x = 1.9 * std::cos(0.7 * i), y = 1.5 * std::sin(0.7 * i), angle = 1.3 * i;
        const Contact there = contact_of(box, polygon, x, y, angle);
        // The second as the first: turned back by its angle.
        const double c = std::cos(-angle), s = std::sin(-angle);
        const Contact back = contact_of(polygon, box, -(c * x - s * y), -(s * x + c * y), -angle);
        REQUIRE(there.n == back.n);
        n += there.n > 0;
        double deepest = 0.0, other = 0.0;
        for (int k = 0; k < there.n; ++k) {
            deepest = std::max(deepest, there.point[k].depth);
            other = std::max(other, back.point[k].depth);
        }
        CHECK(deepest == doctest::Approx(other).epsilon(1e-9));
    }
    CHECK(n > 20);
}

TEST_CASE("find_contact: ellipses do not overlap where their polygons do not") {
    // Side by side along either axis: half axes 2 and 1; the polygon of 64 corners is at most 0.12 % larger.
    CHECK(contact_of(ellipse, ellipse, 0.0, 2.01, 0.0).n == 0);
    CHECK(contact_of(ellipse, ellipse, 0.0, 1.999, 0.0).n > 0);
    CHECK(contact_of(ellipse, ellipse, 4.02, 0.0, 0.0).n == 0);
    CHECK(contact_of(ellipse, ellipse, 3.999, 0.0, 0.0).n > 0);
    CHECK(contact_of(ellipse, ellipse, 3.01, 0.0, 0.5 * pi).n == 0);
    CHECK(contact_of(ellipse, ellipse, 2.999, 0.0, 0.5 * pi).n > 0);
}

TEST_CASE("make_outline: area, centre and reach of every shape") {
    for (const ShapeKind kind : {ShapeKind::disk, ShapeKind::rectangle, ShapeKind::regular_polygon,
                                 ShapeKind::polygon, ShapeKind::ellipse}) {
        CAPTURE(static_cast<int>(kind));
        const Outline outline = make_outline(shape_of("s", kind));
        if (outline.disk) {
            CHECK(outline.reference == 2.0);
            continue;
        }
        double area = 0.0, mx = 0.0;
        for (int i = 0; i < outline.n(); ++i) {
            const int j = (i + 1) % outline.n();
            const double part = 0.5 * (outline.x[i] * outline.y[j] - outline.x[j] * outline.y[i]);
            area += part;
            mx += part * (outline.x[i] + outline.x[j]) / 3.0;
        }
        const double larger = kind == ShapeKind::ellipse ? std::tan(pi / 64) / (pi / 64) : 1.0;
        CHECK(area == doctest::Approx(0.25 * pi * larger).epsilon(1e-12));
        CHECK(std::abs(mx) < 1e-15);
        CHECK(outline.inner < 0.5);
        CHECK(outline.reach > 0.5);
    }
    CHECK(make_outline(box).reference == doctest::Approx(std::sqrt(8.0 / pi)));
    CHECK(make_outline(ellipse).reference == doctest::Approx(2.0 * std::sqrt(2.0)));
}
