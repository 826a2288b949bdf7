// results.h5: particles over time, written frame by frame and read back.
//
//   /time [F]  /step [F]  /position [F, n, d]  /velocity [F, n, d]  /damage [F, n]  /stress [F, n, 4 | 6]
//   /grain [n]  /volume [n]  and, where grains can break, /damage_z [F, n] and /fragment [F, n];
//   where they can yield, /plastic_strain [F, n]
//
//   /observed/NAME [R, C]  /observed/NAME_end [F]   tables: rows of frame k are those from NAME_end[k - 1] up
//                                                   to NAME_end[k]; attribute `columns`: their names
//
// F frames, n particles, d = 2 or 3. One chunk holds one frame of at most 4194304 particles. /damage,
// /damage_z, /fragment, /plastic_strain, /grain and /volume are shuffled and deflated. /position, /velocity
// and /stress are left plain: their last digits are noise, of which deflate takes off a quarter or less at a
// twentieth of the speed of the disk. /time grows last, after a flush: a frame that a killed run has not
// finished is not counted.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "src/results/records.hpp"

namespace quern {

class FrameFileWriter {
  public:
    /// domain: lower then upper corner [m], 2 * dimension numbers, or empty where there is none. periods: of
    /// each axis [m], 0: it does not repeat; or empty.
    FrameFileWriter(const std::string& path, int dimension, const std::string& title,
                    const std::vector<double>& domain, const std::vector<TableLayout>& tables = {},
                    const std::vector<double>& periods = {});
    /// Goes on behind the first n_frames of a file; what follows them is cut off. Throws InputError if the
    /// file cannot be read or has fewer.
    FrameFileWriter(const std::string& path, int dimension, std::int64_t n_frames,
                    const std::vector<TableLayout>& tables = {});
    ~FrameFileWriter();

    /// Appends and flushes. Frames must agree in dimension and number of particles; grain and volume are
    /// those of the first. `tables`: rows of each layout. Throws OutputError with the system's reason.
    void add(const Frame& frame, const std::vector<TableRows>& tables = {});
    void close();
    std::int64_t n_frames() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

class FrameFileReader {
  public:
    /// Throws InputError where the file is missing, is not HDF5, or lacks what a run writes.
    explicit FrameFileReader(const std::string& path);
    ~FrameFileReader();

    int dimension() const;
    std::size_t n_frames() const;
    std::size_t n_particles() const;
    const std::string& title() const;
    const std::vector<double>& domain() const;   ///< lower, upper corner [m]; empty where unknown
    const std::vector<double>& periods() const;  ///< of each axis [m], 0: none; empty: none at all
    Frame read(std::size_t frame) const;         ///< frame < n_frames()

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace quern
