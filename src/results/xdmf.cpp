#include "src/results/xdmf.hpp"

#include <fmt/format.h>

#include <vector>

namespace quern {

namespace {

constexpr const char* head =
    "<?xml version=\"1.0\"?>\n"
    "<Xdmf Version=\"3.0\">\n"
    " <Domain>\n"
    "  <Grid Name=\"particles\" GridType=\"Collection\" CollectionType=\"Temporal\">\n";
constexpr const char* tail = "  </Grid>\n </Domain>\n</Xdmf>\n";

/// One frame of a dataset [F, n, c] of numbers of `bytes`, components [first, first + n_components).
std::string frame_of(const char* dataset, int bytes, std::size_t frame, std::size_t n, int c, int first,
                     int n_components) {
    return fmt::format(
        "<DataItem ItemType=\"HyperSlab\" Dimensions=\"{1} {5}\">"
        "<DataItem Dimensions=\"3 3\" Format=\"XML\">{0} 0 {4} 1 1 1 1 {1} {5}</DataItem>"
        "<DataItem Dimensions=\"{2} {1} {3}\" NumberType=\"Float\" Precision=\"{7}\" Format=\"HDF\">"
        "results.h5:/{6}</DataItem></DataItem>",
        frame, n, frame + 1, c, first, n_components, dataset, bytes);
}

std::string attribute(const std::string& name, const char* type, const std::string& data) {
    return fmt::format("    <Attribute Name=\"{}\" AttributeType=\"{}\" Center=\"Node\">{}</Attribute>\n",
                       name, type, data);
}

/// One frame of a dataset [F, n] of numbers of four bytes.
std::string scalar_of(const char* dataset, const char* type, std::size_t frame, std::size_t n) {
    return fmt::format(
        "<DataItem ItemType=\"HyperSlab\" Dimensions=\"{0}\">"
        "<DataItem Dimensions=\"3 2\" Format=\"XML\">{1} 0 1 1 1 {0}</DataItem>"
        "<DataItem Dimensions=\"{2} {0}\" NumberType=\"{4}\" Precision=\"4\" Format=\"HDF\">"
        "results.h5:/{3}</DataItem></DataItem>",
        n, frame, frame + 1, dataset, type);
}

}  // namespace

XdmfFile::XdmfFile(std::string path, int dimension)
    : file_(std::move(path), head, tail), dimension_(dimension) {}

XdmfFile::XdmfFile(std::string path, int dimension, const ResultPosition& position)
    : file_(std::move(path), position.xdmf_bytes, tail),
      dimension_(dimension),
      n_frames_(static_cast<std::size_t>(position.n_frames)) {}

void XdmfFile::add(double time, std::size_t n, bool breakable, bool plastic) {
    const std::size_t f = n_frames_++;
    const int d = dimension_;
    const std::vector<const char*> axes = {"xx", "yy", d == 2 ? "xy" : "zz", d == 2 ? "zz" : "xy",
                                           "yz", "xz"};

    std::string grid = fmt::format(
        "   <Grid Name=\"frame {0}\" GridType=\"Uniform\">\n"
        "    <Time Value=\"{1}\"/>\n"
        "    <Topology TopologyType=\"Polyvertex\" NumberOfElements=\"{2}\" NodesPerElement=\"1\"/>\n"
        "    <Geometry GeometryType=\"{3}\">{4}</Geometry>\n",
        f, time, n, d == 2 ? "XY" : "XYZ", frame_of("position", 8, f, n, d, 0, d));
    if (d == 3) grid += attribute("velocity", "Vector", frame_of("velocity", 4, f, n, d, 0, d));
    // ParaView's reader takes every vector for three components: in the plane, two scalars.
    for (int k = 0; d == 2 && k < d; ++k)
        grid +=
            attribute(k == 0 ? "velocity_x" : "velocity_y", "Scalar", frame_of("velocity", 4, f, n, d, k, 1));
    const int n_stress = d == 2 ? 4 : 6;
    for (int k = 0; k < n_stress; ++k)
        grid += attribute(fmt::format("stress_{}", axes[static_cast<std::size_t>(k)]), "Scalar",
                          frame_of("stress", 4, f, n, n_stress, k, 1));
    grid += attribute("damage", "Scalar", scalar_of("damage", "Float", f, n));
    if (breakable) {
        grid += attribute("damage_z", "Scalar", scalar_of("damage_z", "Float", f, n));
        grid += attribute("fragment", "Scalar", scalar_of("fragment", "Int", f, n));
    }
    if (plastic) grid += attribute("plastic_strain", "Scalar", scalar_of("plastic_strain", "Float", f, n));
    grid += attribute("grain", "Scalar",
                      fmt::format("<DataItem Dimensions=\"{}\" NumberType=\"Int\" Precision=\"4\" "
                                  "Format=\"HDF\">results.h5:/grain</DataItem>",
                                  n));
    grid += attribute("volume", "Scalar",
                      fmt::format("<DataItem Dimensions=\"{}\" NumberType=\"Float\" Precision=\"8\" "
                                  "Format=\"HDF\">results.h5:/volume</DataItem>",
                                  n));
    file_.add(grid + "   </Grid>\n");
}

}  // namespace quern
