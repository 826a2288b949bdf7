// Lines and text over a picture, in pixels of the finished picture from its lower left corner.
#pragma once

#include <vtkSmartPointer.h>

#include <functional>
#include <string>
#include <vector>

#include "src/results/colors.hpp"

class vtkContext2D;
class vtkRenderer;
class vtkTextProperty;

namespace quern {

enum class Align { low, middle, high };  ///< left, centre, right, or bottom, centre, top

enum class Marker { circle, square, triangle, diamond };

struct TextStyle {
    int size = 15;  ///< height of the letters' line [pixel]
    Align horizontal = Align::middle, vertical = Align::middle;
    bool bold = false;
    bool upright = true;  ///< false: reads from bottom to top
};

class Painter {
  public:
    Painter(vtkContext2D* context, int oversampling) : context_(context), scale_(oversampling) {}

    void add_line(double x0, double y0, double x1, double y1, double width, Rgb color);
    void add_frame(double x, double y, double width, double height, double line_width, Rgb color);
    void add_box(double x, double y, double width, double height, Rgb color);
    /// Through points given as x0, y0, x1, y1, ...
    void add_curve(const std::vector<double>& points, double width, Rgb color, bool dashed = false);
    /// A filled polygon without corners inward, through points as above.
    void add_polygon(const std::vector<double>& points, Rgb color);
    void add_marker(double x, double y, double size, Marker shape, Rgb color);
    void add_text(double x, double y, const std::string& text, const TextStyle& style);
    double text_width(const std::string& text, const TextStyle& style);

  private:
    void set_pen(double width, Rgb color);
    void add_solid_curve(const std::vector<double>& points);
    void set_text_style(const TextStyle& style);

    vtkContext2D* context_;
    int scale_;
};

/// DejaVu Sans where the system has it: what Debian's VTK draws for Arial has round brackets for square ones.
void set_font(vtkTextProperty* text, bool bold);

/// A transparent layer above all others, painted anew at every drawing.
vtkSmartPointer<vtkRenderer> make_overlay(int oversampling, std::function<void(Painter&)> paint);

}  // namespace quern
