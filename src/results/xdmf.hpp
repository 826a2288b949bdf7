// results.xdmf: tells ParaView and VisIt what the arrays of results.h5 mean. Holds no numbers itself.
#pragma once

#include <cstddef>
#include <string>

#include "src/results/output_file.hpp"

namespace quern {

/// A temporal collection of point clouds, complete after every frame.
class XdmfFile {
  public:
    XdmfFile(std::string path, int dimension);
    void add(double time, std::size_t n_particles);

  private:
    GrowingXmlFile file_;
    int dimension_;
    std::size_t n_frames_ = 0;
};

}  // namespace quern
