#include "src/results/offscreen.hpp"

#include <fmt/format.h>
#include <vtkAutoInit.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPNGWriter.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <filesystem>

#include "grid/error.hpp"
#include "src/results/output_file.hpp"

// Here and not in CMake, so that whoever links this library draws with it.
VTK_MODULE_INIT(vtkRenderingOpenGL2)
VTK_MODULE_INIT(vtkRenderingFreeType)
VTK_MODULE_INIT(vtkRenderingContextOpenGL2)

namespace quern {

namespace {

/// Mean over squares of s x s pixels.
void average_down(const unsigned char* in, vtkImageData* to, int s) {
    int size[3];
    to->GetDimensions(size);
    auto* out = static_cast<unsigned char*>(to->GetScalarPointer());
    const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(3) * s * size[0];
    for (int y = 0; y < size[1]; ++y)
        for (int x = 0; x < size[0]; ++x)
            for (int c = 0; c < 3; ++c) {
                int sum = 0;
                for (int j = 0; j < s; ++j)
                    for (int i = 0; i < s; ++i) sum += in[(s * y + j) * row + 3 * (s * x + i) + c];
                *out++ = static_cast<unsigned char>((sum + s * s / 2) / (s * s));
            }
}

}  // namespace

OffscreenWindow::OffscreenWindow(int width, int height, int oversampling)
    : window_(vtkSmartPointer<vtkRenderWindow>::New()),
      width_(width),
      height_(height),
      oversampling_(oversampling) {
    // VTK built for EGL or OSMesa needs no X server.
    if (window_->IsA("vtkXOpenGLRenderWindow")) display_ = std::make_unique<VirtualDisplay>();
    window_->OffScreenRenderingOn();
    window_->SetShowWindow(false);
    window_->SetMultiSamples(0);
    window_->SetDPI(72);  // font sizes in pixels
    window_->SetSize(width * oversampling, height * oversampling);
}

OffscreenWindow::~OffscreenWindow() {
    window_->Finalize();
}

void OffscreenWindow::add(vtkRenderer* renderer) {
    window_->AddRenderer(renderer);
    window_->SetNumberOfLayers(std::max(window_->GetNumberOfLayers(), renderer->GetLayer() + 1));
}

void OffscreenWindow::write_png(const std::string& file) {
    window_->Render();
    const int wide = width_ * oversampling_, tall = height_ * oversampling_;
    vtkNew<vtkUnsignedCharArray> pixels;
    window_->GetPixelData(0, 0, wide - 1, tall - 1, 0, pixels);
    if (pixels->GetNumberOfValues() != 3 * static_cast<vtkIdType>(wide) * tall)
        throw OutputError(fmt::format("{}: no picture of {} x {} pixels from OpenGL", file, wide, tall));
    vtkNew<vtkImageData> image;
    image->SetDimensions(width_, height_, 1);
    image->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    average_down(pixels->GetPointer(0), image, oversampling_);

    vtkNew<vtkPNGWriter> writer;
    writer->SetInputData(image);
    writer->WriteToMemoryOn();
    writer->Write();
    vtkUnsignedCharArray* bytes = writer->GetResult();
    if (!bytes) throw OutputError(file + ": VTK cannot make the picture");
    const std::string directory = std::filesystem::path(file).parent_path();
    if (!directory.empty()) create_directory(directory);
    write_whole_file(file, {reinterpret_cast<const char*>(bytes->GetPointer(0)),
                            static_cast<std::size_t>(bytes->GetNumberOfValues())});
}

}  // namespace quern
