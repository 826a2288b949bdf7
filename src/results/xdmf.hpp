// results.xdmf: tells ParaView and VisIt what the arrays of results.h5 mean. Holds no numbers itself.
#pragma once

#include <cstddef>
#include <string>

#include "src/results/output_file.hpp"
#include "src/results/records.hpp"

namespace quern {

/// A temporal collection of point clouds, complete after every frame.
class XdmfFile {
  public:
    XdmfFile(std::string path, int dimension);
    /// Goes on behind the frames at `position`.
    XdmfFile(std::string path, int dimension, const ResultPosition& position);
    std::int64_t bytes() const { return file_.bytes(); }
    void add(double time, std::size_t n_particles, bool breakable, bool plastic);

  private:
    GrowingXmlFile file_;
    int dimension_;
    std::size_t n_frames_ = 0;
};

}  // namespace quern
