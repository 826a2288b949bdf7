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

#include <filesystem>

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

void Painter::add_line(double x0, double y0, double x1, double y1, double width, Rgb color) {
    context_->GetPen()->SetColor(color[0], color[1], color[2]);
    context_->GetPen()->SetLineType(vtkPen::SOLID_LINE);
    context_->GetPen()->SetWidth(to_float(width * scale_));
    context_->DrawLine(to_float(x0 * scale_), to_float(y0 * scale_), to_float(x1 * scale_),
                       to_float(y1 * scale_));
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
