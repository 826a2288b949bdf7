// Writes what a run leaves behind: HDF5 with XDMF, CSV, JSON, VTK.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "src/results/background_writer.hpp"
#include "src/results/records.hpp"

namespace quern {

struct WriterOptions {
    std::string directory;  ///< created, with its parents
    int dimension = 2;
    bool vtp = false;
    bool fragments = false;                ///< grains can break: fragments.csv
    std::vector<TableLayout> tables = {};  ///< that grow with the frames
    std::string title = {};                ///< of the pictures
    std::vector<double> domain = {};       ///< lower, then upper corner [m], 2 * dimension; empty: none
    std::vector<double> periods = {};      ///< of each axis [m], 0: it does not repeat; empty: none does
    std::optional<ResultPosition> resumed = {};  ///< goes on from here with the files of the directory
};

/// Names of the columns of history.csv, grains.csv, reactions.csv and fragments.csv, in their order.
std::vector<std::string> history_columns(int dimension);
std::vector<std::string> grain_columns(int dimension);
std::vector<std::string> reaction_columns(int dimension);
std::vector<std::string> fragment_columns(int dimension);

/// Files of one run. Rows and frames are written on a thread of their own, in the order in which they were
/// added; an add waits only while the frame before is still being written. Any failure to write throws
/// OutputError naming the file and the system's reason: of rows and frames by a later add, by flush() or by
/// finish().
class ResultWriter {
  public:
    explicit ResultWriter(const WriterOptions& options);
    ~ResultWriter();  ///< writes what was added; errors are lost, so finish() first
    ResultWriter(const ResultWriter&) = delete;
    ResultWriter& operator=(const ResultWriter&) = delete;

    void write_text(const std::string& file_name, const std::string& text);  ///< e.g. deck.resolved.yaml
    void log(const std::string& line);                                       ///< run.log, flushed

    /// results.h5, results.xdmf, frames/frame_00000.vtp; `tables`: rows of WriterOptions::tables at its time.
    /// Gives back an older frame, for its memory.
    Frame add_frame(Frame frame, std::vector<TableRows> tables = {});
    void add_history(const HistoryRow& row);    ///< history.csv
    void add_grain(const GrainRow& row);        ///< grains.csv
    void add_reaction(const ReactionRow& row);  ///< reactions.csv
    void add_fragment(const FragmentRow& row);  ///< fragments.csv
    void flush();                               ///< until all that was added is on disk
    ResultPosition position();                  ///< flushes
    void finish(const Summary& summary);        ///< summary.json; flushes and closes all, ends the thread

    double busy_seconds() const;  ///< what the thread has spent writing; finish() not yet called [s]

  private:
    void hand_over();
    void hand_over_if_long();

    struct Files;
    std::unique_ptr<Files> files_;
    Packet packet_;  // being filled
    std::unique_ptr<BackgroundWriter> background_;
};

}  // namespace quern
