#include "src/results/painter.hpp"

#include <vtkBrush.h>
#include <vtkContext2D.h>
#include <vtkContextActor.h>
#include <vtkContextItem.h>
#include <vtkContextScene.h>
#include <vtkNew.h>
#include <vtkObjectFactory.h>
#include <vtkPen.h>
#include <vtkRenderer.h>
#include <vtkStdString.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

namespace quern {

namespace {

class PaintedItem : public vtkContextItem {
  public:
    static PaintedItem* New();
    vtkTypeMacro(PaintedItem, vtkContextItem);

    bool Paint(vtkContext2D* context) override {
        Painter painter(context, oversampling);
        paint(painter);
        return true;
    }

    int oversampling = 1;
    std::function<void(Painter&)> paint;
};

vtkStandardNewMacro(PaintedItem);

/// Full path of the first of these files; empty if the machine has none.
std::string find_font(const char* name) {
    for (const char* directory : {"/usr/share/fonts/truetype/dejavu/", "/usr/share/fonts/dejavu-sans-fonts/",
                                  "/usr/share/fonts/TTF/", "/usr/share/fonts/dejavu/"})
        if (const std::string path = std::string(directory) + name; std::filesystem::exists(path))
            return path;
    return {};
}

float to_float(double value) {
    return static_cast<float>(value);
}

}  // namespace

void set_font(vtkTextProperty* text, bool bold) {
    static const std::string plain_file = find_font("DejaVuSans.ttf"),
                             bold_file = find_font("DejaVuSans-Bold.ttf");
    const std::string& file = bold ? bold_file : plain_file;
    if (file.empty()) {
        text->SetFontFamilyToArial();
        text->SetBold(bold);
    } else {
        text->SetFontFamily(VTK_FONT_FILE);
        text->SetFontFile(file.c_str());
    }
}

void Painter::set_pen(double width, Rgb color) {
    context_->GetPen()->SetColor(color[0], color[1], color[2]);
    context_->GetPen()->SetLineType(vtkPen::SOLID_LINE);
    context_->GetPen()->SetWidth(to_float(width * scale_));
}

void Painter::add_line(double x0, double y0, double x1, double y1, double width, Rgb color) {
    set_pen(width, color);
    context_->DrawLine(to_float(x0 * scale_), to_float(y0 * scale_), to_float(x1 * scale_),
                       to_float(y1 * scale_));
}

void Painter::add_solid_curve(const std::vector<double>& points) {
    std::vector<float> scaled(points.size());
    std::transform(points.begin(), points.end(), scaled.begin(),
                   [&](double p) { return to_float(p * scale_); });
    if (points.size() >= 4) context_->DrawPoly(scaled.data(), static_cast<int>(points.size() / 2));
}

void Painter::add_curve(const std::vector<double>& points, double width, Rgb color, bool dashed) {
    set_pen(width, color);
    if (!dashed) return add_solid_curve(points);
    // Cut by arc length: the core profile of OpenGL knows no dashed lines.
    constexpr double period = 11.0, dash = 7.0;  // [pixel]
    double done = 0.0;
    std::vector<double> piece;
    for (std::size_t i = 0; i + 3 < points.size(); i += 2) {
        const double dx = points[i + 2] - points[i], dy = points[i + 3] - points[i + 1],
                     length = std::hypot(dx, dy);
        for (double at = 0.0; at < length;) {
            const double phase = std::fmod(done, period);
            const bool on = phase < dash;
            const double next = std::min(length, at + std::max(1e-6, (on ? dash : period) - phase));
            if (on) {
                if (piece.empty()) piece = {points[i] + dx * at / length, points[i + 1] + dy * at / length};
                piece.insert(piece.end(),
                             {points[i] + dx * next / length, points[i + 1] + dy * next / length});
            } else {
                add_solid_curve(piece);
                piece.clear();
            }
            done += next - at;
            at = next;
        }
    }
    add_solid_curve(piece);
}

void Painter::add_polygon(const std::vector<double>& points, Rgb color) {
    context_->GetPen()->SetLineType(vtkPen::NO_PEN);
    context_->GetBrush()->SetColor(color[0], color[1], color[2]);
    std::vector<float> xs, ys;
    for (std::size_t i = 0; i + 1 < points.size(); i += 2) {
        xs.push_back(to_float(points[i] * scale_));
        ys.push_back(to_float(points[i + 1] * scale_));
    }
    context_->DrawPolygon(xs.data(), ys.data(), static_cast<int>(xs.size()));
}

void Painter::add_marker(double x, double y, double size, Marker shape, Rgb color) {
    context_->GetPen()->SetLineType(vtkPen::NO_PEN);
    context_->GetBrush()->SetColor(color[0], color[1], color[2]);
    const int n = shape == Marker::circle ? 24 : shape == Marker::triangle ? 3 : 4;
    const double first = shape == Marker::square ? 0.25 * std::numbers::pi : 0.5 * std::numbers::pi;
    const double radius = size * scale_ *
                          (shape == Marker::circle     ? 0.5
                           : shape == Marker::triangle ? 0.68
                                                       : 0.62);
    std::vector<float> xs, ys;
    for (int i = 0; i < n; ++i) {
        const double angle = first + 2.0 * std::numbers::pi * i / n;
        xs.push_back(to_float(x * scale_ + radius * std::cos(angle)));
        ys.push_back(to_float(y * scale_ + radius * std::sin(angle)));
    }
    context_->DrawPolygon(xs.data(), ys.data(), n);
}

void Painter::add_frame(double x, double y, double width, double height, double line_width, Rgb color) {
    const double half = 0.5 * line_width;  // corners closed
    add_line(x - half, y, x + width + half, y, line_width, color);
    add_line(x - half, y + height, x + width + half, y + height, line_width, color);
    add_line(x, y, x, y + height, line_width, color);
    add_line(x + width, y, x + width, y + height, line_width, color);
}

void Painter::add_box(double x, double y, double width, double height, Rgb color) {
    context_->GetPen()->SetLineType(vtkPen::NO_PEN);
    context_->GetBrush()->SetColor(color[0], color[1], color[2]);
    context_->DrawRect(to_float(x * scale_), to_float(y * scale_), to_float(width * scale_),
                       to_float(height * scale_));
}

void Painter::set_text_style(const TextStyle& style) {
    vtkTextProperty* text = context_->GetTextProp();
    set_font(text, style.bold);
    text->SetFontSize(style.size * scale_);
    text->SetColor(0.1, 0.1, 0.1);
    text->SetOrientation(style.upright ? 0.0 : 90.0);
    text->SetJustification(static_cast<int>(style.horizontal));
    text->SetVerticalJustification(static_cast<int>(style.vertical));
}

void Painter::add_text(double x, double y, const std::string& text, const TextStyle& style) {
    set_text_style(style);
    context_->DrawString(to_float(x * scale_), to_float(y * scale_), vtkStdString(text));
}

double Painter::text_width(const std::string& text, const TextStyle& style) {
    set_text_style(style);
    float bounds[4] = {};  // x, y, width, height
    context_->ComputeStringBounds(vtkStdString(text), bounds);
    return static_cast<double>(bounds[2]) / scale_;
}

vtkSmartPointer<vtkRenderer> make_overlay(int oversampling, std::function<void(Painter&)> paint) {
    vtkNew<PaintedItem> item;
    item->oversampling = oversampling;
    item->paint = std::move(paint);
    vtkNew<vtkContextActor> actor;
    actor->GetScene()->AddItem(item);
    vtkSmartPointer<vtkRenderer> renderer = vtkSmartPointer<vtkRenderer>::New();
    actor->GetScene()->SetRenderer(renderer);
    renderer->AddActor(actor);
    renderer->SetLayer(2);
    renderer->InteractiveOff();
    return renderer;
}

}  // namespace quern
