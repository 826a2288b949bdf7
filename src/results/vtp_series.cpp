#include "src/results/vtp_series.hpp"

#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkXMLPolyDataWriter.h>

#include <algorithm>
#include <filesystem>

#include "grid/error.hpp"

namespace quern {

namespace {

/// An array of `n_out` components from one of `n_in`, padded with zeros.
template <class Array, class T>
void add_array(vtkPolyData* cloud, const char* name, const std::vector<T>& values, int n_in, int n_out) {
    vtkNew<Array> array;
    array->SetName(name);
    array->SetNumberOfComponents(n_out);
    array->SetNumberOfTuples(static_cast<vtkIdType>(values.size()) / n_in);
    for (std::size_t i = 0; i < values.size(); ++i)
        array->SetComponent(static_cast<vtkIdType>(i) / n_in, static_cast<int>(i) % n_in, values[i]);
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
        for (int c = n_in; c < n_out; ++c) array->SetComponent(i, c, 0.0);
    cloud->GetPointData()->AddArray(array);
}

/// VTK's order of a symmetric tensor: xx, yy, zz, xy, yz, xz.
std::vector<float> make_vtk_stress(const Frame& frame) {
    if (frame.dimension == 3) return frame.stress;
    std::vector<float> stress(6 * frame.n(), 0.0);
    for (std::size_t i = 0; i < frame.n(); ++i) {
        const float* s = &frame.stress[4 * i];
        std::copy_n(std::initializer_list<float>{s[0], s[1], s[3], s[2]}.begin(), 4, &stress[6 * i]);
    }
    return stress;
}

constexpr const char* head =
    "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\">\n <Collection>\n";
constexpr const char* tail = " </Collection>\n</VTKFile>\n";

std::string frame_name(std::size_t number) {
    return fmt::format("frame_{:05}.vtp", number);
}

/// Those of an earlier run, or of what a run did behind its checkpoint.
void remove_frames_from(const std::string& directory, std::size_t first) {
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(directory, error)) {
        const std::string name = entry.path().filename().string();
        const std::string from = frame_name(first);
        const bool behind = name.size() > from.size() || (name.size() == from.size() && name >= from);
        if (name.starts_with("frame_") && name.ends_with(".vtp") && behind)
            std::filesystem::remove(entry.path(), error);
    }
}

}  // namespace

VtpSeries::VtpSeries(std::string directory)
    : directory_(std::move(directory)), collection_(directory_ + "/results.pvd", head, tail) {
    create_directory(directory_ + "/frames");
    remove_frames_from(directory_ + "/frames", 0);
}

VtpSeries::VtpSeries(std::string directory, const ResultPosition& position)
    : directory_(std::move(directory)),
      collection_(directory_ + "/results.pvd", position.pvd_bytes, tail),
      n_frames_(static_cast<std::size_t>(position.n_frames)) {
    remove_frames_from(directory_ + "/frames", n_frames_);
}

void VtpSeries::add(const Frame& frame) {
    const auto n = static_cast<vtkIdType>(frame.n());
    const auto d = static_cast<std::size_t>(frame.dimension);
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(n);
    vtkNew<vtkCellArray> vertices;
    vtkNew<vtkIntArray> grain;
    grain->SetName("grain");
    grain->SetNumberOfTuples(n);
    for (vtkIdType i = 0; i < n; ++i) {
        const double* x = &frame.position[static_cast<std::size_t>(i) * d];
        points->SetPoint(i, x[0], x[1], d == 3 ? x[2] : 0.0);
        vertices->InsertNextCell(1, &i);
        grain->SetValue(i, frame.grain[static_cast<std::size_t>(i)]);
    }
    vtkNew<vtkPolyData> cloud;
    cloud->SetPoints(points);
    cloud->SetVerts(vertices);
    cloud->GetPointData()->AddArray(grain);
    add_array<vtkFloatArray>(cloud, "velocity", frame.velocity, frame.dimension, 3);
    add_array<vtkFloatArray>(cloud, "stress", make_vtk_stress(frame), 6, 6);
    add_array<vtkFloatArray>(cloud, "damage", frame.damage, 1, 1);
    if (!frame.damage_z.empty()) add_array<vtkFloatArray>(cloud, "damage_z", frame.damage_z, 1, 1);
    if (!frame.fragment.empty()) add_array<vtkIntArray>(cloud, "fragment", frame.fragment, 1, 1);
    if (!frame.plastic_strain.empty())
        add_array<vtkFloatArray>(cloud, "plastic_strain", frame.plastic_strain, 1, 1);
    add_array<vtkDoubleArray>(cloud, "volume", frame.volume, 1, 1);

    vtkNew<vtkXMLPolyDataWriter> writer;
    writer->SetInputData(cloud);
    writer->SetCompressorTypeToZLib();
    writer->WriteToOutputStringOn();
    const std::string name = "frames/" + frame_name(n_frames_++);
    if (writer->Write() == 0)
        throw OutputError(fmt::format("{}/{}: VTK cannot make the file", directory_, name));
    write_whole_file(fmt::format("{}/{}", directory_, name), writer->GetOutputString());
    collection_.add(fmt::format("  <DataSet timestep=\"{}\" file=\"{}\"/>\n", frame.time, name));
}

}  // namespace quern
