#include "src/results/particle_picture.hpp"

#include <fmt/format.h>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkOutlineSource.h>
#include <vtkPointData.h>
#include <vtkPointGaussianMapper.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "src/results/colors.hpp"
#include "src/results/offscreen.hpp"
#include "src/results/painter.hpp"
#include "src/results/ticks.hpp"

namespace quern {

namespace {

using Point = std::array<double, 3>;

constexpr int oversampling = 2;
// Discs of the right area leave gaps between neighbours. Where they are too small to be seen as discs, the
// gaps would show as moire: there the discs are widened until those of a square lattice close up.
constexpr double smallest_disc = 4.0;  // [pixel]
constexpr double gapless = 1.35;       // sqrt(pi / 2) and some for strain
constexpr Rgb ink = {40, 40, 40}, wall = {90, 90, 90}, link_color = {160, 20, 30};

bool has_color_bar(const Field& field) {
    return field.scale != ColorScale::categorical && field.scale != ColorScale::uniform;
}

/// Replaces the Gaussian of the mapper: a disc, and a ball lit from the upper left of the viewer.
constexpr const char* disc_shader =
    "//VTK::Color::Impl\n"
    "if (dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy) > 1.0) discard;\n";
constexpr const char* ball_shader =
    "//VTK::Color::Impl\n"
    "float squared = dot(offsetVCVSOutput.xy, offsetVCVSOutput.xy);\n"
    "if (squared > 1.0) discard;\n"
    "vec3 outward = vec3(offsetVCVSOutput.xy, sqrt(1.0 - squared));\n"
    "float light = 0.45 + 0.55 * max(0.0, dot(outward, normalize(vec3(-0.5, 0.7, 0.8))));\n"
    "ambientColor *= light;\n"
    "diffuseColor *= light;\n";

double dot(const Point& a, const Point& b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// Seen along `out` reversed, `right` and `up` span the picture: the plane itself in 2D, from a corner with z
/// up in 3D.
struct ViewAxes {
    Point right{1, 0, 0}, up{0, 1, 0}, out{0, 0, 1};
};

ViewAxes make_view_axes(int dimension) {
    if (dimension == 2) return {};
    constexpr double azimuth = -60.0 * std::numbers::pi / 180.0, elevation = 22.0 * std::numbers::pi / 180.0;
    const double ca = std::cos(azimuth), sa = std::sin(azimuth), ce = std::cos(elevation),
                 se = std::sin(elevation);
    return {{-sa, ca, 0.0}, {-se * ca, -se * sa, ce}, {ce * ca, ce * sa, se}};
}

/// Where the plot lies in the picture [pixel], and what it shows in the plane of the picture [m].
struct Layout {
    double x = 0, y = 0, width = 0, height = 0;
    double low[2] = {0, 0}, high[2] = {0, 0};
};

Point corner(const std::vector<double>& box, int dimension, int k) {
    Point point{0, 0, 0};
    for (int c = 0; c < dimension; ++c)
        point[static_cast<std::size_t>(c)] = box[static_cast<std::size_t>(c + (k >> c & 1) * dimension)];
    return point;
}

Layout make_layout(const PictureOptions& options, const ViewAxes& axes) {
    Layout layout;
    std::fill_n(layout.low, 2, std::numeric_limits<double>::max());
    std::fill_n(layout.high, 2, std::numeric_limits<double>::lowest());
    for (int k = 0; k < 1 << options.dimension; ++k) {
        const Point at = corner(options.region, options.dimension, k);
        const double seen[2] = {dot(at, axes.right), dot(at, axes.up)};
        for (int c = 0; c < 2; ++c) {
            layout.low[c] = std::min(layout.low[c], seen[c]);
            layout.high[c] = std::max(layout.high[c], seen[c]);
        }
    }
    const double wide = layout.high[0] - layout.low[0], tall = layout.high[1] - layout.low[1];
    const double left = options.dimension == 2 ? 95 : 30, bottom = options.dimension == 2 ? 75 : 70, top = 75;
    const double right = has_color_bar(options.field) ? 150 : 35;
    const double free_width = std::max(50.0, options.width - left - right);
    const double free_height = std::max(50.0, options.height - bottom - top);
    const double pixels_per_metre = std::min(free_width / wide, free_height / tall);
    layout.width = pixels_per_metre * wide;
    layout.height = pixels_per_metre * tall;
    layout.x = left + 0.5 * (free_width - layout.width);
    layout.y = bottom + 0.5 * (free_height - layout.height);
    return layout;
}

}  // namespace

double particle_radius(double volume, int dimension) {
    return dimension == 2 ? std::sqrt(volume / std::numbers::pi)
                          : std::cbrt(0.75 * volume / std::numbers::pi);
}

struct ParticlePicture::Impl {
    explicit Impl(const PictureOptions& with)
        : options(with),
          axes(make_view_axes(with.dimension)),
          layout(make_layout(with, axes)),
          colors(with.field.scale, with.low, with.high),
          window(with.width, with.height, oversampling) {
        add_particles();
        if (!options.domain.empty()) add_domain();
        aim_camera();
        background->SetBackground(1.0, 1.0, 1.0);
        renderer->SetLayer(1);
        window.add(background);
        if (options.dark) {
            const double w = options.width, h = options.height;
            night->SetBackground(0.0, 0.0, 0.0);
            night->SetViewport(layout.x / w, layout.y / h, (layout.x + layout.width) / w,
                               (layout.y + layout.height) / h);
            window.add(night);
        }
        window.add(renderer);
        window.add(make_overlay(oversampling, [this](Painter& painter) {
            paint_links(painter);
            if (options.dimension == 2)
                paint_axes(painter);
            else
                paint_scale_bar(painter), paint_triad(painter);
            if (has_color_bar(options.field)) paint_color_bar(painter);
            paint_title(painter);
        }));
    }

    void add_particles() {
        mapper->SetInputData(cloud);
        mapper->SetScalarModeToUsePointData();
        mapper->SetColorModeToDirectScalars();
        mapper->SetScaleArray("radius");
        mapper->SetScaleFactor(1.0);
        mapper->SetTriangleScale(2.0);  // the smallest triangle around a circle of radius 1
        mapper->EmissiveOff();
        mapper->SetSplatShaderCode(options.dimension == 2 ? disc_shader : ball_shader);
        vtkNew<vtkActor> actor;
        actor->SetMapper(mapper);
        actor->ForceOpaqueOn();
        actor->GetProperty()->LightingOff();
        renderer->AddActor(actor);
    }

    void add_domain() {
        const Point low = corner(options.domain, options.dimension, 0);
        const Point high = corner(options.domain, options.dimension, (1 << options.dimension) - 1);
        vtkNew<vtkOutlineSource> outline;
        outline->SetBounds(low[0], high[0], low[1], high[1], low[2], high[2]);
        vtkNew<vtkPolyDataMapper> lines;
        lines->SetInputConnection(outline->GetOutputPort());
        vtkNew<vtkActor> actor;
        actor->SetMapper(lines);
        actor->GetProperty()->LightingOff();
        actor->GetProperty()->SetColor(wall[0] / 255.0, wall[1] / 255.0, wall[2] / 255.0);
        actor->GetProperty()->SetLineWidth(1.5f * oversampling);
        renderer->AddActor(actor);
    }

    void aim_camera() {
        const double w = options.width, h = options.height;
        renderer->SetViewport(layout.x / w, layout.y / h, (layout.x + layout.width) / w,
                              (layout.y + layout.height) / h);
        Point middle{}, eye{};
        double depth = 0.0;
        for (int k = 0; k < 1 << options.dimension; ++k)
            depth = std::max(depth, std::abs(dot(corner(options.region, options.dimension, k), axes.out)));
        depth += layout.high[0] - layout.low[0] + layout.high[1] - layout.low[1];
        for (std::size_t c = 0; c < 3; ++c) {
            middle[c] = 0.5 * (layout.low[0] + layout.high[0]) * axes.right[c] +
                        0.5 * (layout.low[1] + layout.high[1]) * axes.up[c];
            eye[c] = middle[c] + 2.0 * depth * axes.out[c];
        }
        vtkCamera* camera = renderer->GetActiveCamera();
        camera->ParallelProjectionOn();
        camera->SetFocalPoint(middle.data());
        camera->SetPosition(eye.data());
        camera->SetViewUp(axes.up.data());
        camera->SetParallelScale(0.5 * (layout.high[1] - layout.low[1]));
        camera->SetClippingRange(0.1 * depth, 4.0 * depth);
    }

    /// visit(x) for the point in the domain and its copies in the region; just for itself where nothing
    /// repeats.
    template <class Visit>
    void for_each_copy(Point x, Visit&& visit, std::size_t axis = 0) const {
        if (axis == options.periods.size()) {
            visit(x);
            return;
        }
        const double period = options.periods[axis];
        if (period == 0.0) {
            for_each_copy(x, visit, axis + 1);
            return;
        }
        const double low = options.region[axis],
                     high = options.region[axis + static_cast<std::size_t>(options.dimension)];
        for (x[axis] -= period * std::floor((x[axis] - low) / period); x[axis] <= high; x[axis] += period)
            for_each_copy(x, visit, axis + 1);
    }

    void set_particles(const Frame& frame, const std::vector<double>& values) {
        vtkNew<vtkPoints> points;
        vtkNew<vtkFloatArray> radius;
        vtkNew<vtkUnsignedCharArray> color;
        vtkNew<vtkCellArray> vertices;
        radius->SetName("radius");
        color->SetName("color");
        color->SetNumberOfComponents(3);
        const auto d = static_cast<std::size_t>(frame.dimension);
        const double pixels_per_metre = layout.width / (layout.high[0] - layout.low[0]);
        for (std::size_t i = 0; i < frame.n(); ++i) {
            const double* x = &frame.position[i * d];
            const double z = d == 3 ? x[2] : 0.0;
            if (!std::isfinite(x[0] + x[1] + z)) continue;
            const double r = particle_radius(frame.volume[i], frame.dimension);
            const bool one_grey = options.field.scale == ColorScale::uniform;
            const bool small = frame.dimension == 2 && (one_grey || r * pixels_per_metre < smallest_disc);
            const Rgb rgb = colors.color(values[i]);
            for_each_copy({x[0], x[1], z}, [&](const Point& at) {
                const vtkIdType id = points->InsertNextPoint(at.data());
                vertices->InsertNextCell(1, &id);
                radius->InsertNextValue(static_cast<float>(small ? gapless * r : r));
                color->InsertNextTypedTuple(rgb.data());
            });
        }
        cloud->Initialize();
        cloud->SetPoints(points);
        cloud->SetVerts(vertices);
        cloud->GetPointData()->AddArray(radius);
        cloud->GetPointData()->SetScalars(color);
        caption = fmt::format("t = {:.4g} s     step {}", frame.time, frame.step);
    }

    void paint_links(Painter& painter) const {
        const double width_of_metre = layout.width / (layout.high[0] - layout.low[0]);
        const auto pixel = [&](const Point& at, int c) {
            const double seen = dot(at, c == 0 ? axes.right : axes.up);
            const double start = c == 0 ? layout.x : layout.y, length = c == 0 ? layout.width : layout.height;
            return start + (seen - layout.low[c]) / (layout.high[c] - layout.low[c]) * length;
        };
        for (const PictureLink& link : options.links) {
            Point middle, half;
            for (std::size_t c = 0; c < 3; ++c) {
                middle[c] = 0.5 * (link.from[c] + link.to[c]);
                half[c] = 0.5 * (link.to[c] - link.from[c]);
            }
            for_each_copy(middle, [&](const Point& at) {
                const double x = pixel(at, 0), y = pixel(at, 1);
                if (x < layout.x || y < layout.y || x > layout.x + layout.width ||
                    y > layout.y + layout.height)
                    return;
                Point from, to;
                for (std::size_t c = 0; c < 3; ++c) {
                    from[c] = at[c] - half[c];
                    to[c] = at[c] + half[c];
                }
                painter.add_line(pixel(from, 0), pixel(from, 1), pixel(to, 0), pixel(to, 1),
                                 std::max(0.5, link.width * width_of_metre), link_color);
            });
        }
    }

    void paint_axes(Painter& painter) const {
        const Layout& l = layout;
        painter.add_frame(l.x, l.y, l.width, l.height, 1.0, ink);
        const double extent = std::max(l.high[0] - l.low[0], l.high[1] - l.low[1]);
        const ScaledUnit unit = make_scaled_unit("m", extent);
        const auto ticks = [&](int c, double pixels, double spacing) {
            return make_ticks(l.low[c] * unit.factor, l.high[c] * unit.factor,
                              std::max(2, static_cast<int>(pixels / spacing)));
        };
        double widest = 0.0;
        for (const Tick& tick : ticks(0, l.width, 90)) {
            const double at = l.x + (tick.value / unit.factor - l.low[0]) / (l.high[0] - l.low[0]) * l.width;
            painter.add_line(at, l.y, at, l.y - 6, 1.0, ink);
            painter.add_text(at, l.y - 10, tick.label, {.size = 14, .vertical = Align::high});
        }
        for (const Tick& tick : ticks(1, l.height, 60)) {
            const double at = l.y + (tick.value / unit.factor - l.low[1]) / (l.high[1] - l.low[1]) * l.height;
            painter.add_line(l.x, at, l.x - 6, at, 1.0, ink);
            const TextStyle style{.size = 14, .horizontal = Align::high};
            painter.add_text(l.x - 10, at, tick.label, style);
            widest = std::max(widest, painter.text_width(tick.label, style));
        }
        painter.add_text(l.x + 0.5 * l.width, l.y - 34, fmt::format("x [{}]", unit.name),
                         {.size = 15, .vertical = Align::high});
        painter.add_text(l.x - 22 - widest, l.y + 0.5 * l.height, fmt::format("y [{}]", unit.name),
                         {.size = 15, .vertical = Align::low, .upright = false});
    }

    void paint_scale_bar(Painter& painter) const {
        const double metres_per_pixel = (layout.high[0] - layout.low[0]) / layout.width;
        const double length = round_down(0.2 * options.width * metres_per_pixel);
        const ScaledUnit unit = make_scaled_unit("m", length);
        const double left = 150, y = 40, right = left + length / metres_per_pixel;
        painter.add_line(left, y, right, y, 2.0, ink);
        for (const double x : {left, right}) painter.add_line(x, y - 6, x, y + 6, 2.0, ink);
        painter.add_text(0.5 * (left + right), y - 9, fmt::format("{:g} {}", length * unit.factor, unit.name),
                         {.size = 14, .vertical = Align::high});
    }

    void paint_triad(Painter& painter) const {
        constexpr double x = 70, y = 50, length = 40;
        constexpr Rgb axis_color[] = {{213, 94, 0}, {0, 158, 115}, {0, 114, 178}};
        for (std::size_t c = 0; c < 3; ++c) {
            const double dx = length * axes.right[c], dy = length * axes.up[c];
            painter.add_line(x, y, x + dx, y + dy, 2.0, axis_color[c]);
            painter.add_text(x + 1.3 * dx, y + 1.3 * dy, std::string(1, "xyz"[c]), {.size = 14});
        }
    }

    void paint_color_bar(Painter& painter) const {
        constexpr int n = 256;
        const double x = layout.x + layout.width + 28, y = layout.y, height = layout.height, width = 20;
        for (int i = 0; i < n; ++i) {
            const double value = colors.low() + (i + 0.5) / n * (colors.high() - colors.low());
            // Each box reaches the top: no seams.
            painter.add_box(x, y + height * i / n, width, height * (n - i) / n, colors.color(value));
        }
        painter.add_frame(x, y, width, height, 1.0, ink);
        const ScaledUnit unit =
            make_scaled_unit(options.field.unit, std::max(std::abs(colors.low()), std::abs(colors.high())));
        double widest = 0.0;
        const int n_ticks = std::max(2, static_cast<int>(height / 60));
        for (const Tick& tick :
             make_ticks(colors.low() * unit.factor, colors.high() * unit.factor, n_ticks)) {
            const double at =
                y + (tick.value / unit.factor - colors.low()) / (colors.high() - colors.low()) * height;
            painter.add_line(x + width, at, x + width + 6, at, 1.0, ink);
            const TextStyle style{.size = 14, .horizontal = Align::low};
            painter.add_text(x + width + 10, at, tick.label, style);
            widest = std::max(widest, painter.text_width(tick.label, style));
        }
        const std::string name =
            unit.name.empty() ? options.field.label : fmt::format("{} [{}]", options.field.label, unit.name);
        painter.add_text(x + width + 18 + widest, y + 0.5 * height, name,
                         {.size = 15, .vertical = Align::high, .upright = false});
    }

    void paint_title(Painter& painter) const {
        const double middle = layout.x + 0.5 * layout.width, top = layout.y + layout.height;
        painter.add_text(middle, top + 10, caption, {.size = 14, .vertical = Align::low});
        TextStyle style{.size = 18, .vertical = Align::low, .bold = true};
        const double room = 2.0 * std::min(middle, options.width - middle) - 10.0;
        while (style.size > 10 && painter.text_width(options.title, style) > room) --style.size;
        painter.add_text(middle, top + 34, options.title, style);
    }

    PictureOptions options;
    ViewAxes axes;
    Layout layout;
    ColorMap colors;
    OffscreenWindow window;
    // White everywhere; black where the plot is; the plot, which clips what it does not show.
    vtkNew<vtkRenderer> background, night, renderer;
    vtkNew<vtkPointGaussianMapper> mapper;
    vtkNew<vtkPolyData> cloud;
    std::string caption;
};

ParticlePicture::ParticlePicture(const PictureOptions& options) : impl_(std::make_unique<Impl>(options)) {}
ParticlePicture::~ParticlePicture() = default;

void ParticlePicture::write_png(const Frame& frame, const std::vector<double>& values,
                                const std::string& file) {
    impl_->set_particles(frame, values);
    impl_->window.write_png(file);
}

}  // namespace quern
