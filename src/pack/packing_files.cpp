#include "src/pack/packing_files.hpp"

#include <fmt/format.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "src/pack/overlap.hpp"
#include "src/pack/portable_math.hpp"
#include "src/results/json.hpp"
#include "src/results/offscreen.hpp"
#include "src/results/painter.hpp"

namespace quern {
namespace {

bool has_groups(const EdgeGroups& e) {
    return !(e.x_low + e.x_high + e.y_low + e.y_high + e.rim).empty();
}

/// Names of groups in the order of edges, each once.
std::vector<std::string> group_names(const EdgeGroups& e) {
    std::vector<std::string> names;
    for (const std::string* name : {&e.x_low, &e.x_high, &e.y_low, &e.y_high, &e.rim})
        if (!name->empty() && std::find(names.begin(), names.end(), *name) == names.end())
            names.push_back(*name);
    return names;
}

/// Region and its surroundings to pixels.
struct View {
    double scale = 1.0, x0 = 0.0, y0 = 0.0;
    int width = 0, height = 0;

    View(const Region& region, double overhang) {
        constexpr double size = 900.0, border = 12.0;
        double margin[2];
        for (int axis = 0; axis < 2; ++axis) margin[axis] = region.open(axis) ? overhang : 0.0;
        const double w = region.length(0) + 2.0 * margin[0], h = region.length(1) + 2.0 * margin[1];
        scale = size / std::max(w, h);
        width = static_cast<int>(std::ceil(scale * w + 2.0 * border));
        height = static_cast<int>(std::ceil(scale * h + 2.0 * border));
        x0 = border - scale * (region.low[0] - margin[0]);
        y0 = border - scale * (region.low[1] - margin[1]);
    }
    double x(double at) const { return x0 + scale * at; }
    double y(double at) const { return y0 + scale * at; }
};

class PackingPainter {
  public:
    PackingPainter(const PackedGrains& grains, const View& view, Painter& painter)
        : g_(grains), view_(view), painter_(painter) {
        turn_corners(g_, 1.0, corners_);
    }

    void add_grain(int i, Rgb color) {
        const Region& region = g_.region;
        const int nx = region.periodic(0) ? 1 : 0, ny = region.periodic(1) ? 1 : 0;
        for (int a = -nx; a <= nx; ++a)
            for (int b = -ny; b <= ny; ++b) {
                const double x = g_.x[i] + a * region.length(0), y = g_.y[i] + b * region.length(1);
                const double reach = g_.reach(i);
                const bool seen = (!nx || (x + reach > region.low[0] && x - reach < region.high[0])) &&
                                  (!ny || (y + reach > region.low[1] && y - reach < region.high[1]));
                if (seen) add_image(i, x, y, color);
            }
    }

  private:
    void add_image(int i, double x, double y, Rgb color) {
        std::vector<double> points;
        const Outline& outline = g_.outline_of(i);
        constexpr int n_round = 48;
        for (int k = 0; k < (outline.disk ? n_round : outline.n()); ++k) {
            const portable::Direction d = portable::direction(2.0 * std::numbers::pi * k / n_round);
            const int at = corners_.first[i] + k;
            const double dx = outline.disk ? g_.reach(i) * d.cos : corners_.x[at];
            const double dy = outline.disk ? g_.reach(i) * d.sin : corners_.y[at];
            points.insert(points.end(), {view_.x(x + dx), view_.y(y + dy)});
        }
        painter_.add_polygon(points, color);
    }

    const PackedGrains& g_;
    const View& view_;
    Painter& painter_;
    TurnedCorners corners_;
};

constexpr Rgb white{255, 255, 255}, ink{40, 40, 40}, plain{196, 200, 206};

}  // namespace

std::string packing_csv(const PackSpec& spec, const Packing& packing, const PackingReport& report) {
    const PackedGrains& g = packing.grains;
    const bool disks =
        std::all_of(g.outlines.begin(), g.outlines.end(), [](const Outline& o) { return o.disk; });
    const bool shapes = !spec.shapes.empty(), groups = has_groups(spec.edges);
    std::string text =
        fmt::format("# {} grains, solid fraction {:.6f}, seed {}\n", g.n(), packing.fraction, spec.seed);
    text += disks ? "x,y,radius" : "x,y,scale,angle";
    text += fmt::format("{}{}\n", shapes ? ",shape" : "", groups ? ",group" : "");
    for (int i = 0; i < g.n(); ++i) {
        text += fmt::format("{:.10g},{:.10g}", g.x[i], g.y[i]);
        if (disks)
            text += fmt::format(",{:.10g}", 0.5 * g.size[i]);
        else
            text += fmt::format(",{:.10g},{:.10g}", g.size[i] / g.outline_of(i).reference,
                                portable::angle_of(g.c[i], g.s[i]));
        if (shapes) text += "," + g.outline_of(i).name;
        if (groups) text += "," + report.groups[i];
        text += "\n";
    }
    return text;
}

std::string packing_json(const PackSpec& spec, const Packing& packing, const PackingReport& report) {
    const PackedGrains& g = packing.grains;
    double mean = 0.0, mean_square = 0.0;
    for (const double size : g.size) {
        mean += size / g.n();
        mean_square += size * size / g.n();
    }
    const auto [least, largest] = std::minmax_element(g.size.begin(), g.size.end());
    std::string text = "{\n";
    const auto add = [&text](const char* key, const std::string& value, bool last = false) {
        text += fmt::format("  {}: {}{}\n", json_string(key), value, last ? "" : ",");
    };
    add("title", json_string(spec.title));
    add("spec", json_string(spec.file));
    add("seed", std::to_string(spec.seed));
    add("n_grains", std::to_string(g.n()));
    add("solid_fraction", json_number(packing.fraction));
    add("solid_fraction_asked", json_number(packing.asked));
    add("reached", packing.reached ? "true" : "false");
    add("size_mean", json_number(mean));
    add("size_rms", json_number(std::sqrt(mean_square)));
    add("size_min", json_number(*least));
    add("size_max", json_number(*largest));
    add("size_factor", json_number(packing.size_factor));
    add("final_shrink", json_number(packing.shrink));
    add("deepest_overlap", json_number(report.deepest));
    add("coordination_number", json_number(report.coordination));
    add("rounds", std::to_string(packing.rounds));
    std::string groups;
    for (const std::string& name : group_names(spec.edges)) {
        const auto n = std::count(report.groups.begin(), report.groups.end(), name);
        groups += fmt::format("{}{}: {}", groups.empty() ? "" : ", ", json_string(name), n);
    }
    add("groups", "{" + groups + "}", true);
    return text + "}\n";
}

void draw_packing(const PackSpec& spec, const Packing& packing, const PackingReport& report,
                  const std::string& file) {
    constexpr int oversampling = 3;
    const PackedGrains& g = packing.grains;
    double overhang = 0.0;
    for (int i = 0; i < g.n(); ++i) overhang = std::max(overhang, g.reach(i));
    const View view(spec.region, overhang);
    const std::vector<std::string> names = group_names(spec.edges);
    const ColorMap distinct(ColorScale::categorical, 0.0, 1.0);
    OffscreenWindow window(view.width, view.height, oversampling);
    vtkNew<vtkRenderer> background;
    background->SetBackground(1.0, 1.0, 1.0);
    window.add(background);
    window.add(make_overlay(oversampling, [&](Painter& painter) {
        PackingPainter grains(g, view, painter);
        for (int i = 0; i < g.n(); ++i) {
            const auto group = std::find(names.begin(), names.end(), report.groups[i]);
            const Rgb color = names.empty()          ? distinct.color(i)
                              : group == names.end() ? plain
                                                     : cycle_color(static_cast<int>(group - names.begin()));
            grains.add_grain(i, color);
        }
        const double w = view.width, h = view.height, border = 10.0;
        for (const double x : {0.0, w - border}) painter.add_box(x, 0.0, border, h, white);
        for (const double y : {0.0, h - border}) painter.add_box(0.0, y, w, border, white);
        const Region& r = spec.region;
        if (!r.circle)
            return painter.add_frame(view.x(r.low[0]), view.y(r.low[1]), view.scale * r.length(0),
                                     view.scale * r.length(1), 1.5, ink);
        std::vector<double> rim;
        for (int k = 0; k <= 180; ++k) {
            const portable::Direction d = portable::direction(2.0 * std::numbers::pi * k / 180);
            rim.insert(rim.end(),
                       {view.x(r.centre[0] + r.radius * d.cos), view.y(r.centre[1] + r.radius * d.sin)});
        }
        painter.add_curve(rim, 1.5, ink);
    }));
    window.write_png(file);
}

}  // namespace quern
