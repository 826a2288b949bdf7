#include <doctest/doctest.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGReader.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <stdexcept>

#include "grid/error.hpp"
#include "src/results/colors.hpp"
#include "src/results/render.hpp"
#include "tests/results/samples.hpp"

using namespace quern;

namespace {

/// Pixels of a colour in a picture, within `reach` of each channel.
struct Picture {
    explicit Picture(const std::string& file) {
        reader->SetFileName(file.c_str());
        reader->Update();
        reader->GetOutput()->GetDimensions(size);
    }
    int count(Rgb color, int reach = 10) const {
        const auto* p = static_cast<const unsigned char*>(reader->GetOutput()->GetScalarPointer());
        int n = 0;
        for (int i = 0; i < size[0] * size[1]; ++i, p += 3)
            n += std::abs(p[0] - color[0]) <= reach && std::abs(p[1] - color[1]) <= reach &&
                 std::abs(p[2] - color[2]) <= reach;
        return n;
    }
    vtkNew<vtkPNGReader> reader;
    int size[3] = {};
};

ChartLine make_line(int color, double slope, int n = 50) {
    ChartLine line;
    line.label = "line";
    line.color = color;
    for (int i = 0; i < n; ++i) {
        line.x.push_back(i);
        line.y.push_back(slope * i);
    }
    return line;
}

}  // namespace

TEST_CASE("Charts: a grid has the size of its charts and the colours of its lines") {
    const ScratchDirectory scratch;
    Chart first, second;
    first.lines = {make_line(0, 1.0)};
    second.lines = {make_line(1, 1.0), make_line(2, -1.0)};
    draw_charts({first, second, first}, 2, scratch.path("charts.png"));
    const Picture picture(scratch.path("charts.png"));
    CHECK(picture.size[0] == 2 * 560);
    CHECK(picture.size[1] == 2 * 420);
    CHECK(picture.count(cycle_color(0)) > 400);
    CHECK(picture.count(cycle_color(1)) > 200);
    CHECK(picture.count(cycle_color(2)) > 200);
    CHECK(picture.count(cycle_color(3)) == 0);
}

TEST_CASE("Charts: a dashed line has about two thirds of the ink, markers add to it") {
    const ScratchDirectory scratch;
    const auto ink = [&](auto&& change) {
        Chart chart;
        chart.legend = false;
        chart.lines = {make_line(0, 1.0)};
        change(chart.lines[0]);
        draw_charts({chart}, 1, scratch.path("chart.png"));
        return static_cast<double>(Picture(scratch.path("chart.png")).count(cycle_color(0), 60));
    };
    const double solid = ink([](ChartLine&) {});
    CHECK(ink([](ChartLine& line) { line.dashed = true; }) / solid ==
          doctest::Approx(7.0 / 11.0).epsilon(0.15));
    CHECK(ink([](ChartLine& line) { line.markers = true; }) > 1.5 * solid);
    CHECK(ink([](ChartLine& line) { line.line = false; }) > 0.0);
}

TEST_CASE("Charts: numbers that cannot be shown are left out") {
    const ScratchDirectory scratch;
    Chart chart;
    chart.log_x = chart.log_y = true;
    chart.lines = {make_line(0, 1.0)};
    chart.lines[0].y[3] = std::numeric_limits<double>::quiet_NaN();
    chart.lines[0].y[4] = -1.0;
    chart.lines[0].y[5] = std::numeric_limits<double>::infinity();
    Chart empty;
    empty.lines = {ChartLine{}};
    Chart constant;
    constant.lines = {make_line(0, 0.0)};
    draw_charts({chart, empty, constant, Chart{}}, 2, scratch.path("charts.png"));
    CHECK(Picture(scratch.path("charts.png")).count(cycle_color(0)) > 400);
}

TEST_CASE("Charts: the legend hides no data") {
    const ScratchDirectory scratch;
    // Points all over the plot: drawn with and without a legend they must leave the same ink.
    const auto ink = [&](bool legend) {
        Chart chart;
        chart.legend = legend;
        ChartLine line = make_line(1, 0.0, 400);
        line.label = "a rather long label of a line";
        line.line = false;
        for (int i = 0; i < 400; ++i) {
            line.x[static_cast<std::size_t>(i)] = i % 20;
            line.y[static_cast<std::size_t>(i)] = i / 20;
        }
        chart.lines = {line};
        draw_charts({chart}, 1, scratch.path("chart.png"));
        return Picture(scratch.path("chart.png")).count(cycle_color(1));
    };
    const int without = ink(false), with = ink(true);
    CHECK(with == doctest::Approx(without).epsilon(0.02));
}

TEST_CASE("Charts: bars stand upon each other, over the names of their places") {
    const ScratchDirectory scratch;
    Chart chart;
    chart.legend = false;
    chart.categories = {"one", "another"};
    ChartLine lower, upper;
    lower.x = upper.x = {0, 1};
    lower.y = {1, 2};
    upper.y = {2, 1};
    lower.bar = upper.bar = true;
    lower.color = 0;
    upper.color = 1;
    chart.lines = {lower, upper};
    draw_charts({chart}, 1, scratch.path("bars.png"));
    const Picture picture(scratch.path("bars.png"));
    // The parts have the same areas: 1 + 2 and 2 + 1; a bar is 0.6 of the distance of two.
    const int first = picture.count(cycle_color(0)), second = picture.count(cycle_color(1));
    CHECK(first > 20000);
    CHECK(second == doctest::Approx(first).epsilon(0.02));
    // The axis ends at the highest bar: at 2 instead of 3.
    chart.lines = {lower};
    draw_charts({chart}, 1, scratch.path("bars.png"));
    CHECK(Picture(scratch.path("bars.png")).count(cycle_color(0)) ==
          doctest::Approx(1.5 * first).epsilon(0.03));
}

TEST_CASE("Charts: unequal lengths and failing files are errors") {
    const ScratchDirectory scratch;
    Chart chart;
    chart.lines = {make_line(0, 1.0)};
    chart.lines[0].x.pop_back();
    CHECK_THROWS_AS(draw_charts({chart}, 1, scratch.path("chart.png")), std::invalid_argument);
    CHECK_THROWS_AS(draw_charts({}, 1, scratch.path("chart.png")), std::invalid_argument);
    std::ofstream(scratch.path("file")) << "in the way";
    CHECK_THROWS_AS(draw_charts({Chart{}}, 1, scratch.path("file/chart.png")), OutputError);
}
