// Writes what a run leaves behind: HDF5 with XDMF, CSV, JSON, VTK.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "src/results/records.hpp"

namespace quern {

struct WriterOptions {
    std::string directory;  ///< created, with its parents
    int dimension = 2;
    bool vtp = false;
    std::string title = {};           ///< of the pictures
    std::vector<double> domain = {};  ///< lower, then upper corner [m], 2 * dimension; empty: none
};

/// Files of one run. Any failure to write throws OutputError naming the file and the system's reason.
class ResultWriter {
  public:
    explicit ResultWriter(const WriterOptions& options);
    ~ResultWriter();
    ResultWriter(const ResultWriter&) = delete;
    ResultWriter& operator=(const ResultWriter&) = delete;

    void write_text(const std::string& file_name, const std::string& text);  ///< e.g. deck.resolved.yaml
    void log(const std::string& line);                                       ///< run.log, flushed
    void add_frame(const Frame& frame);       ///< results.h5, results.xdmf, frames/frame_00000.vtp
    void add_history(const HistoryRow& row);  ///< history.csv
    void add_grain(const GrainRow& row);      ///< grains.csv
    void finish(const Summary& summary);      ///< summary.json; flushes and closes all

  private:
    struct Files;
    std::unique_ptr<Files> files_;
};

}  // namespace quern
