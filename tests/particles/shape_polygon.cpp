#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "particles/polygon.hpp"

using namespace quern;
using std::numbers::pi;

namespace {

const std::vector<Vec<2>> l_shape{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};

/// Parameter of vertex i; uneven: neighbouring edges differ in length.
double parameter(int i, int n, double uneven) {
    const double t = 2 * pi * i / n;
    return t + uneven * std::sin(3 * t);
}

std::vector<Vec<2>> ellipse(double a, double b, int n, double uneven = 0.0) {
    std::vector<Vec<2>> points;
    for (int i = 0; i < n; ++i) {
        const double t = parameter(i, n, uneven);
        points.emplace_back(a * std::cos(t), b * std::sin(t));
    }
    return points;
}

/// Worst relative error of the curvature and worst error of the normal over the vertices of an ellipse.
std::pair<double, double> frame_errors(double a, double b, int n) {
    constexpr double uneven = 0.15;
    const std::vector<VertexFrame> frames = make_vertex_frames(ellipse(a, b, n, uneven));
    double worst_kappa = 0.0, worst_normal = 0.0;
    for (int i = 0; i < n; ++i) {
        const double t = parameter(i, n, uneven);
        const double exact = a * b / std::pow(std::hypot(a * std::sin(t), b * std::cos(t)), 3);
        const Vec<2> normal = Vec<2>(b * std::cos(t), a * std::sin(t)).normalized();
        worst_kappa = std::max(worst_kappa, std::abs(frames[i].kappa / exact - 1.0));
        worst_normal = std::max(worst_normal, (normal - frames[i].normal).norm());
    }
    return {worst_kappa, worst_normal};
}

std::string defect(const std::vector<Vec<2>>& vertices) {
    const std::optional<PolygonDefect> found = find_polygon_defect(vertices);
    return found ? found->got : "";
}

}  // namespace

TEST_CASE("Polygon: area, bounds and distance of a concave outline") {
    const Polygon polygon(l_shape);
    CHECK(polygon.measure() == doctest::Approx(3.0).epsilon(1e-14));
    CHECK(polygon.low() == Vec<2>(0, 0));
    CHECK(polygon.high() == Vec<2>(2, 2));
    CHECK(polygon.distance({0.25, 1.0}) == doctest::Approx(0.25));
    CHECK(polygon.distance({0.8, 0.8}) ==
          doctest::Approx(std::hypot(0.2, 0.2)));  // the reflex vertex is nearest
    CHECK(polygon.distance({1.5, 1.5}) == doctest::Approx(-0.5));
    CHECK(polygon.distance({3.0, 3.0}) == doctest::Approx(-std::hypot(1.0, 2.0)));
    CHECK(polygon.radius_about({0, 0}) == doctest::Approx(std::sqrt(5.0)));
    CHECK(polygon.cornered());
}

TEST_CASE("Polygon: the view has the face normal on faces and the bisector at corners") {
    const Polygon polygon(l_shape);
    const SurfaceView<2> face = polygon.view({1.0, 0.1});
    CHECK((face.normal - Vec<2>(0, -1)).norm() < 1e-15);
    CHECK(face.distance == doctest::Approx(0.1));
    CHECK((face.point - Vec<2>(1.0, 0.0)).norm() < 1e-15);
    CHECK(face.kappa == 0.0);

    const Vec<2> bisector(-std::sqrt(0.5), -std::sqrt(0.5));
    CHECK((polygon.view({0.1, 0.1}).normal - bisector).norm() < 1e-14);  // inside, both faces equally near
    CHECK(polygon.view({0.1, 0.1}).distance == doctest::Approx(0.1));
    CHECK((polygon.view({0.1, 0.12}).normal - bisector).norm() < 1e-14);  // within 1.25 of the nearest
    CHECK(polygon.view({0.1, 0.12}).distance == doctest::Approx(0.11));
    CHECK((polygon.view({0.1, 0.13}).normal - Vec<2>(-1, 0)).norm() < 1e-14);
    CHECK((polygon.view({0.0, 0.0}).normal - bisector).norm() < 1e-14);  // the vertex itself
    CHECK((polygon.view({0.9, 0.9}).normal + bisector).norm() < 1e-14);  // reflex vertex: outward is up right
    // Opposite sides of a thin part are no corner.
    const Polygon strip({{0, 0}, {10, 0}, {10, 1}, {0, 1}});
    CHECK((strip.view({5.0, 0.5}).normal.cwiseAbs() - Vec<2>(0, 1)).norm() < 1e-15);
}

TEST_CASE("Polygon: the overlap with cells is exact, also where the outline is concave") {
    const Polygon polygon(l_shape);
    CHECK(polygon.overlap({0.5, 0.5}, {1.5, 1.5}) == doctest::Approx(0.75).epsilon(1e-14));
    CHECK(polygon.overlap({1.2, 1.2}, {1.8, 1.8}) == 0.0);
    CHECK(polygon.overlap({-1, -1}, {3, 3}) == doctest::Approx(3.0).epsilon(1e-14));
    // A comb: one cell cuts it into three separate teeth of 0.2 x 0.5.
    const Polygon comb({{0, 0},
                        {1, 0},
                        {1, 1},
                        {0.8, 1},
                        {0.8, 0.2},
                        {0.6, 0.2},
                        {0.6, 1},
                        {0.4, 1},
                        {0.4, 0.2},
                        {0.2, 0.2},
                        {0.2, 1},
                        {0, 1}});
    CHECK(comb.overlap({-1, 0.5}, {2, 2}) == doctest::Approx(0.3).epsilon(1e-14));
}

TEST_CASE("Polygon: many vertices stand for a smooth curve") {
    for (const int n : {13, 64, 500}) {
        const std::vector<VertexFrame> frames = make_vertex_frames(ellipse(2.0, 2.0, n));
        const double step = 2 * pi / n;
        for (int i = 0; i < n; ++i) {
            CHECK(!frames[i].corner);
            // closed form step/(2 sin(step/2)), 1.0098 for n = 13
            CHECK(2.0 * frames[i].kappa == doctest::Approx(step / (2 * std::sin(step / 2))).epsilon(1e-10));
            CHECK((frames[i].normal - Vec<2>(std::cos(step * i), std::sin(step * i))).norm() < 1e-12);
        }
    }
    CHECK(make_vertex_frames(ellipse(1, 1, 12))[0].corner);  // turns by 30 degrees
    CHECK(!Polygon(ellipse(1, 1, 13)).cornered());

    // Away from the vertices normal and curvature are interpolated.
    const Polygon circle(ellipse(1, 1, 48));
    const double angle = 2 * pi / 48 * 0.3;
    const SurfaceView<2> view = circle.view(0.9 * Vec<2>(std::cos(angle), std::sin(angle)));
    // measured 2.6e-3, bound 5e-3 (the edge's own normal: 2.6e-2)
    CHECK((view.normal - Vec<2>(std::cos(angle), std::sin(angle))).norm() < 5e-3);
    CHECK(view.kappa == doctest::Approx(1.0).epsilon(1e-3));
}

TEST_CASE("Polygon: curvature and normal of a sampled ellipse converge") {
    const auto [kappa_coarse, normal_coarse] = frame_errors(2.0, 1.0, 64);
    const auto [kappa_fine, normal_fine] = frame_errors(2.0, 1.0, 128);
    CHECK(kappa_fine < 0.006);                 // measured 0.0029
    CHECK(normal_fine < 0.005);                // measured 0.0025 rad
    CHECK(kappa_coarse / kappa_fine > 3.5);    // measured 3.93
    CHECK(normal_coarse / normal_fine > 3.5);  // measured 3.97
}

TEST_CASE("Polygon: a hole's outline is concave") {
    std::vector<Vec<2>> clockwise = ellipse(1, 1, 40);
    std::reverse(clockwise.begin(), clockwise.end());
    const VertexFrame frame = make_vertex_frames(clockwise)[39];
    CHECK(frame.kappa == doctest::Approx(-1.0).epsilon(2e-3));
    CHECK((frame.normal - Vec<2>(-1, 0)).norm() < 1e-12);
}

TEST_CASE("Polygon: defects are found and named") {
    CHECK(defect(l_shape).empty());
    CHECK(defect({{0, 0}, {1, 0}}) == "2 vertices");
    CHECK(defect({{0, 0}, {0, 1}, {1, 0}}) == "clockwise vertices");
    CHECK(defect({{0, 0}, {1, 0}, {1, 0}, {0, 1}}) == "vertices 2 and 3 at the same point");
    CHECK(defect({{0, 0}, {1, 0}, {0, 1}, {0, 0}}) == "vertices 4 and 1 at the same point");
    CHECK(defect({{0, 0}, {1, 0}, {NAN, 1}}) == "vertex 3 without a finite value");
    // a bow tie, an outline that touches itself at a vertex, an edge that runs back on the one before
    CHECK(defect({{0, 0}, {1, 1}, {1, 0}, {0, 1}}).find("edges 1-2 and 3-4") != std::string::npos);
    CHECK(defect({{0, 0}, {2, 0}, {2, 1}, {1, 0}, {0, 1}}).find("self-intersecting") != std::string::npos);
    CHECK(defect({{0, 0}, {2, 0}, {1, 0}, {1, 1}}).find("self-intersecting") != std::string::npos);
    CHECK(find_polygon_defect({{0, 0}, {0, 1}, {1, 0}})->hint == "reverse the list");
    // the scale of the outline does not matter
    std::vector<Vec<2>> tiny = l_shape;
    for (Vec<2>& x : tiny) x *= 1e-9;
    CHECK(defect(tiny).empty());
}
