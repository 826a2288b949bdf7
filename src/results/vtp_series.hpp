// frames/frame_00000.vtp and results.pvd: the same frames as VTK files, for readers that know no HDF5.
#pragma once

#include <string>

#include "src/results/output_file.hpp"
#include "src/results/records.hpp"

namespace quern {

class VtpSeries {
  public:
    explicit VtpSeries(std::string directory);  ///< of the run; makes frames/ inside
    /// Goes on behind the frames at `position`.
    VtpSeries(std::string directory, const ResultPosition& position);
    void add(const Frame& frame);
    std::int64_t bytes() const { return collection_.bytes(); }  ///< of results.pvd

  private:
    std::string directory_;
    GrowingXmlFile collection_;
    std::size_t n_frames_ = 0;
};

}  // namespace quern
