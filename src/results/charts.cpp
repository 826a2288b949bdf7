#include <fmt/format.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "src/results/offscreen.hpp"
#include "src/results/painter.hpp"
#include "src/results/render.hpp"
#include "src/results/ticks.hpp"

namespace quern {

namespace {

constexpr int chart_width = 560, chart_height = 420;  // [pixel]
constexpr int oversampling = 2;
constexpr Rgb ink = {40, 40, 40}, grid_color = {228, 228, 228}, legend_edge = {200, 200, 200},
              white = {255, 255, 255};
constexpr double line_width = 1.8, marker_size = 8.0;
constexpr double bar_width = 0.6;  // of the distance of two

struct Rect {
    double x = 0, y = 0, width = 0, height = 0;
};

/// One axis: data (or their logarithms) between low and high map to pixels.
struct Axis {
    bool log = false;
    double low = 0, high = 1;
    double start = 0, length = 1;  ///< [pixel]

    bool accepts(double value) const { return std::isfinite(value) && (!log || value > 0.0); }
    double scaled(double value) const { return log ? std::log10(value) : value; }
    double pixel(double scaled_value) const { return start + (scaled_value - low) / (high - low) * length; }
    std::vector<Tick> ticks(double spacing) const {
        const int n = std::max(2, static_cast<int>(length / spacing));
        if (!log) return make_ticks(low, high, n);
        // Less than a decade: hardly a power of ten in it, so plain numbers at their logarithms.
        if (high - low >= 1.0) return make_log_ticks(low, high, n);
        std::vector<Tick> ticks = make_ticks(std::pow(10.0, low), std::pow(10.0, high), n);
        for (Tick& tick : ticks) tick.value = std::log10(tick.value);
        return ticks;
    }
};

/// Points of a line that its chart can show, scaled; the pixels follow from the axes.
using Points = std::vector<std::array<double, 2>>;

Points make_points(const ChartLine& line, const Axis& x, const Axis& y) {
    Points points;
    for (std::size_t i = 0; i < line.x.size(); ++i)
        if (x.accepts(line.x[i]) && y.accepts(line.y[i]))
            points.push_back({x.scaled(line.x[i]), y.scaled(line.y[i])});
    return points;
}

/// Covers the points, and from `low` to `high` where these are given.
void set_range(Axis& axis, const std::vector<Points>& lines, std::size_t c,
               double low = std::numeric_limits<double>::max(),
               double high = std::numeric_limits<double>::lowest()) {
    for (const Points& points : lines)
        for (const auto& point : points) {
            low = std::min(low, point[c]);
            high = std::max(high, point[c]);
        }
    if (low > high) low = 0.0, high = 1.0;
    // Noise of the last digit is no range.
    const double least = axis.log ? 0.1 : std::max(1e-12 * std::max(std::abs(low), std::abs(high)), 1e-300);
    const double size = high - low > least ? high - low : axis.log || low == 0.0 ? 1.0 : 0.2 * std::abs(low);
    const double middle = 0.5 * (low + high), reach = 0.5 * size * 1.08;
    axis.low = middle - reach;
    axis.high = middle + reach;
}

class ChartPainter {
  public:
    ChartPainter(const Chart& chart, const Rect& place, Painter& painter)
        : chart_(chart), place_(place), painter_(painter), x_{.log = chart.log_x}, y_{.log = chart.log_y} {
        for (const ChartLine& line : chart.lines) {
            lines_.push_back(make_points(line, x_, y_));
            feet_.emplace_back();
            if (line.bar) stack(lines_.back(), feet_.back());
        }
        if (chart.categories.empty())
            set_range(x_, lines_, 0);
        else
            set_range(x_, {}, 0, -0.5, static_cast<double>(chart.categories.size()) - 0.5);
        if (tops_.empty())
            set_range(y_, lines_, 1);
        else
            set_range(y_, lines_, 1, 0.0, 0.0);
    }

    void paint() {
        lay_out();
        const Rect legend = place_legend();
        paint_axes();
        for (std::size_t i = 0; i < lines_.size(); ++i) paint_line(i);
        painter_.add_frame(plot_.x, plot_.y, plot_.width, plot_.height, 1.0, ink);
        if (legend.width > 0.0) paint_legend(legend);
    }

  private:
    static constexpr TextStyle tick_style{.size = 12}, name_style{.size = 13};
    static constexpr TextStyle legend_style{.size = 12, .horizontal = Align::low};
    static constexpr double row_height = 18, sample_width = 28, legend_padding = 8;

    /// Lifts a part of the bars upon those before it.
    void stack(Points& points, std::vector<double>& feet) {
        for (auto& point : points) {
            double& top = tops_[point[0]];
            feet.push_back(top);
            top += point[1];
            point[1] = top;
        }
    }

    Rect bar_box(std::size_t line, std::size_t i) const {
        const double x = x_.pixel(lines_[line][i][0]), width = bar_width * x_.length / (x_.high - x_.low);
        const double foot = y_.pixel(feet_[line][i]), top = y_.pixel(lines_[line][i][1]);
        return {x - 0.5 * width, std::min(foot, top), width, std::abs(top - foot)};
    }

    void lay_out() {
        const double below = 58, above = chart_.title.empty() ? 18 : 42;
        plot_ = {place_.x, place_.y + below, 0, chart_height - below - above};
        y_.start = plot_.y;
        y_.length = plot_.height;
        for (const Tick& tick : y_.ticks(45))
            widest_ = std::max(widest_, painter_.text_width(tick.label, tick_style));
        plot_.x += 44 + widest_;
        plot_.width = place_.x + chart_width - 24 - plot_.x;
        x_.start = plot_.x;
        x_.length = plot_.width;
    }

    /// True for a line drawn with markers; all of them, or enough to tell the line by.
    std::size_t marker_stride(std::size_t i) const {
        return chart_.lines[i].line ? std::max<std::size_t>(1, lines_[i].size() / 25) : 1;
    }
    static Marker shape_of(int color) { return static_cast<Marker>(static_cast<unsigned>(color) % 4); }

    Rect legend_size() {
        n_rows_ = 0;
        label_width_ = 0.0;
        for (const ChartLine& line : chart_.lines) {
            if (line.label.empty()) continue;
            ++n_rows_;
            label_width_ = std::max(label_width_, painter_.text_width(line.label, legend_style));
        }
        if (!chart_.legend || n_rows_ == 0) return {};
        const double column = sample_width + 8 + label_width_;
        n_columns_ = n_rows_ > 4 && 2 * column + 3 * legend_padding < plot_.width ? 2 : 1;
        n_rows_ = (n_rows_ + n_columns_ - 1) / n_columns_;
        return {0, 0, n_columns_ * (column + legend_padding) + legend_padding,
                n_rows_ * row_height + legend_padding};
    }

    /// How many pixels of lines lie under a box.
    std::size_t n_hidden(const Rect& box) const {
        const auto inside = [&](double px, double py) {
            return px > box.x - 5 && px < box.x + box.width + 5 && py > box.y - 5 &&
                   py < box.y + box.height + 5;
        };
        std::size_t n = 0;
        for (std::size_t l = 0; l < lines_.size(); ++l)
            for (std::size_t i = 0; i < lines_[l].size(); ++i) {
                if (chart_.lines[l].bar) {
                    const Rect bar = bar_box(l, i);
                    n += bar.x < box.x + box.width && box.x < bar.x + bar.width &&
                         bar.y < box.y + box.height && box.y < bar.y + bar.height;
                    continue;
                }
                const double x1 = x_.pixel(lines_[l][i][0]), y1 = y_.pixel(lines_[l][i][1]);
                n += inside(x1, y1);
                if (i == 0 || !chart_.lines[l].line) continue;
                const double x0 = x_.pixel(lines_[l][i - 1][0]), y0 = y_.pixel(lines_[l][i - 1][1]);
                const int n_steps = static_cast<int>(std::hypot(x1 - x0, y1 - y0) / 4.0);
                for (int k = 1; k < n_steps; ++k)
                    n += inside(x0 + (x1 - x0) * k / n_steps, y0 + (y1 - y0) * k / n_steps);
            }
        return n;
    }

    /// Where it hides nothing; if there is no such place, room is made above the data.
    Rect place_legend() {
        Rect box = legend_size();
        if (box.width <= 0.0) return box;
        constexpr double gap = 8;
        const double left = plot_.x + gap, right = plot_.x + plot_.width - box.width - gap;
        const double bottom = plot_.y + gap, top = plot_.y + plot_.height - box.height - gap;
        for (const double y : {top, bottom, 0.5 * (bottom + top)})
            for (const double x : {right, left, 0.5 * (left + right)}) {
                box.x = x;
                box.y = y;
                if (n_hidden(box) == 0) return box;
            }
        const double part = std::min(0.6, (box.height + gap) / plot_.height);
        y_.high = y_.low + (y_.high - y_.low) / (1.0 - part);
        box.x = right;
        box.y = top;
        return box;
    }

    std::vector<Tick> x_ticks() const {
        if (chart_.categories.empty()) return x_.ticks(70);
        std::vector<Tick> ticks;
        for (const std::string& name : chart_.categories)
            ticks.push_back({static_cast<double>(ticks.size()), name});
        return ticks;
    }

    /// Letters as large as lets the names stand side by side.
    int category_size() {
        const double room = 0.95 * x_.length / static_cast<double>(chart_.categories.size());
        int size = tick_style.size;
        for (const std::string& name : chart_.categories)
            while (size > 7 && painter_.text_width(name, {.size = size}) > room) --size;
        return size;
    }

    void paint_axes() {
        const double left = plot_.x, bottom = plot_.y, right = left + plot_.width,
                     top = bottom + plot_.height;
        const int size = chart_.categories.empty() ? tick_style.size : category_size();
        for (const Tick& tick : x_ticks()) {
            const double at = x_.pixel(tick.value);
            if (chart_.categories.empty()) painter_.add_line(at, bottom, at, top, 1.0, grid_color);
            painter_.add_line(at, bottom, at, bottom - 5, 1.0, ink);
            painter_.add_text(at, bottom - 9, tick.label, {.size = size, .vertical = Align::high});
        }
        for (const Tick& tick : y_.ticks(45)) {
            const double at = y_.pixel(tick.value);
            painter_.add_line(left, at, right, at, 1.0, grid_color);
            painter_.add_line(left, at, left - 5, at, 1.0, ink);
            painter_.add_text(left - 9, at, tick.label, {.size = tick_style.size, .horizontal = Align::high});
        }
        painter_.add_text(0.5 * (left + right), bottom - 30, chart_.x_label,
                          {.size = name_style.size, .vertical = Align::high});
        painter_.add_text(left - 18 - widest_, 0.5 * (bottom + top), chart_.y_label,
                          {.size = name_style.size, .vertical = Align::low, .upright = false});
        TextStyle title{.size = 15, .vertical = Align::low, .bold = true};
        while (title.size > 9 && painter_.text_width(chart_.title, title) > chart_width - 20) --title.size;
        const double half = 0.5 * painter_.text_width(chart_.title, title);
        const double middle = std::clamp(0.5 * (left + right), place_.x + half,
                                         std::max(place_.x + half, place_.x + chart_width - 8 - half));
        painter_.add_text(middle, top + 12, chart_.title, title);
    }

    void paint_line(std::size_t i) {
        const ChartLine& line = chart_.lines[i];
        const Rgb color = cycle_color(line.color);
        for (std::size_t k = 0; line.bar && k < lines_[i].size(); ++k) {
            const Rect box = bar_box(i, k);
            painter_.add_box(box.x, box.y, box.width, box.height, color);
        }
        if (line.bar) return;
        std::vector<double> pixels;
        for (const auto& point : lines_[i])
            pixels.insert(pixels.end(), {x_.pixel(point[0]), y_.pixel(point[1])});
        if (line.line) painter_.add_curve(pixels, line_width, color, line.dashed);
        if (line.markers || !line.line)
            for (std::size_t k = 0; k < lines_[i].size(); k += marker_stride(i))
                painter_.add_marker(pixels[2 * k], pixels[2 * k + 1], marker_size, shape_of(line.color),
                                    color);
    }

    void paint_legend(const Rect& box) {
        painter_.add_box(box.x, box.y, box.width, box.height, white);
        painter_.add_frame(box.x, box.y, box.width, box.height, 1.0, legend_edge);
        int k = 0;
        for (const ChartLine& line : chart_.lines) {
            if (line.label.empty()) continue;
            const int column = k / n_rows_, row = k % n_rows_;
            ++k;
            const double x =
                box.x + legend_padding + column * (sample_width + 8 + label_width_ + legend_padding);
            const double y = box.y + box.height - 0.5 * legend_padding - (row + 0.5) * row_height;
            const Rgb color = cycle_color(line.color);
            if (line.bar)
                painter_.add_box(x, y - 5, sample_width, 10, color);
            else if (line.line)
                painter_.add_curve({x, y, x + sample_width, y}, line_width, color, line.dashed);
            if (!line.bar && (line.markers || !line.line))
                painter_.add_marker(x + 0.5 * sample_width, y, marker_size, shape_of(line.color), color);
            painter_.add_text(x + sample_width + 8, y, line.label, legend_style);
        }
    }

    const Chart& chart_;
    Rect place_, plot_;
    Painter& painter_;
    Axis x_, y_;
    std::vector<Points> lines_;              // of bars: their upper ends
    std::vector<std::vector<double>> feet_;  // of bars: their lower ends
    std::map<double, double> tops_;          // of all bars, by x
    double widest_ = 0.0, label_width_ = 0.0;
    int n_rows_ = 0, n_columns_ = 1;
};

}  // namespace

void draw_charts(const std::vector<Chart>& charts, int columns, const std::string& file) {
    if (charts.empty() || columns < 1) throw std::invalid_argument("draw_charts: no charts or no columns");
    for (const Chart& chart : charts)
        for (const ChartLine& line : chart.lines)
            if (line.x.size() != line.y.size())
                throw std::invalid_argument(fmt::format("draw_charts: line '{}' of '{}' has {} x and {} y",
                                                        line.label, chart.title, line.x.size(),
                                                        line.y.size()));
    const int n = static_cast<int>(charts.size());
    columns = std::min(columns, n);
    const int rows = (n + columns - 1) / columns;
    OffscreenWindow window(columns * chart_width, rows * chart_height, oversampling);
    vtkNew<vtkRenderer> background;
    background->SetBackground(1.0, 1.0, 1.0);
    window.add(background);
    window.add(make_overlay(oversampling, [&](Painter& painter) {
        for (int k = 0; k < n; ++k) {
            const Rect place{static_cast<double>(k % columns * chart_width),
                             static_cast<double>((rows - 1 - k / columns) * chart_height), chart_width,
                             chart_height};
            ChartPainter(charts[static_cast<std::size_t>(k)], place, painter).paint();
        }
    }));
    window.write_png(file);
}

}  // namespace quern
