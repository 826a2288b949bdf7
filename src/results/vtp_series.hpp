// frames/frame_00000.vtp and results.pvd: the same frames as VTK files, for readers that know no HDF5.
#pragma once

#include <string>

#include "src/results/output_file.hpp"
#include "src/results/records.hpp"

namespace quern {

class VtpSeries {
  public:
    explicit VtpSeries(std::string directory);  ///< of the run; makes frames/ inside
    void add(const Frame& frame);

  private:
    std::string directory_;
    GrowingXmlFile collection_;
    std::size_t n_frames_ = 0;
};

}  // namespace quern
