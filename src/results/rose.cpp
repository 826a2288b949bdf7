#include "src/results/rose.hpp"

#include <fmt/format.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "src/results/offscreen.hpp"
#include "src/results/painter.hpp"

namespace quern {

namespace {

constexpr int size = 560, oversampling = 2, n_petals = 36;  // [pixel]
constexpr Rgb ink = {40, 40, 40}, faint = {190, 190, 190}, petal_color = {86, 180, 233},
              fit_color = {213, 94, 0};
constexpr double two_pi = 2.0 * std::numbers::pi;

}  // namespace

std::vector<double> petals(const std::vector<double>& angles, int n) {
    std::vector<double> density(static_cast<std::size_t>(n), 0.0);
    const double width = two_pi / n, each = 0.5 / (static_cast<double>(angles.size()) * width);
    for (const double angle : angles)
        for (const double both : {angle, angle + std::numbers::pi}) {
            const double turns = both / two_pi - std::floor(both / two_pi);
            density[static_cast<std::size_t>(turns * n + 0.5) % density.size()] += each;
        }
    return density;
}

void draw_rose(const Rose& rose, const std::string& file) {
    const std::vector<double> density = petals(rose.angles, n_petals);
    const double even = 1.0 / two_pi;
    double longest = even * (1.0 + 2.0 * std::abs(rose.difference));
    for (const double d : density) longest = std::max(longest, d);
    OffscreenWindow window(size, size, oversampling);
    vtkNew<vtkRenderer> background;
    background->SetBackground(1.0, 1.0, 1.0);
    window.add(background);
    window.add(make_overlay(oversampling, [&](Painter& painter) {
        const double x = 0.5 * size, y = 0.5 * size - 20, scale = (0.5 * size - 60) / longest;
        const auto curve = [&](auto&& radius) {
            std::vector<double> points;
            for (int k = 0; k <= 180; ++k) {
                const double angle = two_pi * k / 180, r = scale * radius(angle);
                points.insert(points.end(), {x + r * std::cos(angle), y + r * std::sin(angle)});
            }
            return points;
        };
        for (int k = 0; k < n_petals; ++k) {
            std::vector<double> wedge = {x, y};
            for (const double part : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
                const double angle = two_pi * (k + part) / n_petals;
                const double r = scale * density[static_cast<std::size_t>(k)];
                wedge.insert(wedge.end(), {x + r * std::cos(angle), y + r * std::sin(angle)});
            }
            painter.add_polygon(wedge, petal_color);
        }
        const double reach = scale * longest + 10;
        painter.add_line(x - reach, y, x + reach, y, 1.0, faint);
        painter.add_line(x, y - reach, x, y + reach, 1.0, faint);
        painter.add_curve(curve([&](double) { return even; }), 1.0, ink);
        painter.add_curve(curve([&](double angle) {
                              return even *
                                     (1.0 + 2.0 * rose.difference * std::cos(2.0 * (angle - rose.along)));
                          }),
                          2.0, fit_color, true);
        painter.add_text(x + reach + 8, y, "x", {.size = 14});
        painter.add_text(x, y + reach + 10, "y", {.size = 14});
        painter.add_text(x, size - 22, rose.title, {.size = 15, .bold = true});
        painter.add_text(x, 16,
                         fmt::format("{} contacts, R1 - R2 = {:.3g} along {:.0f} deg", rose.angles.size(),
                                     rose.difference, rose.along * 180.0 / std::numbers::pi),
                         {.size = 13});
    }));
    window.write_png(file);
}

}  // namespace quern
