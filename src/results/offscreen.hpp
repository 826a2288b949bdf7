// A window that nobody sees, and its picture as a PNG file.
#pragma once

#include <vtkSmartPointer.h>

#include <memory>
#include <string>

#include "src/results/virtual_display.hpp"

class vtkRenderer;
class vtkRenderWindow;

namespace quern {

/// Everything is drawn `oversampling` times as large and averaged down: smooth edges also where the graphics
/// library offers no multisampling. Sizes given to VTK must therefore be multiplied by oversampling.
class OffscreenWindow {
  public:
    OffscreenWindow(int width, int height, int oversampling);
    ~OffscreenWindow();

    void add(vtkRenderer* renderer);
    int oversampling() const { return oversampling_; }

    /// Draws and writes; creates the directory of the file. Throws OutputError.
    void write_png(const std::string& file);

  private:
    std::unique_ptr<VirtualDisplay> display_;  // outlives the window, which is drawn on it
    vtkSmartPointer<vtkRenderWindow> window_;
    int width_, height_, oversampling_;
};

}  // namespace quern
