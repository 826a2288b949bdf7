// The thread that writes what a run hands over.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

#include "src/results/records.hpp"

namespace quern {

/// What is handed over at once: rows, then at most one frame.
struct Packet {
    std::vector<HistoryRow> history;
    std::vector<GrainRow> grains;
    std::vector<ReactionRow> reactions;
    std::vector<FragmentRow> fragments;
    std::vector<TableRows> tables;  ///< of the frame, one a layout
    Frame frame;
    bool has_frame = false;
};

/// Writes packets in order on a thread of its own. Two packets exist: the caller fills one while the other is
/// written; who hands over before that is done waits. After a failure nothing more is written.
class BackgroundWriter {
  public:
    explicit BackgroundWriter(std::function<void(const Packet&)> write);
    ~BackgroundWriter();  ///< writes what was handed over; errors are lost, so wait() first
    BackgroundWriter(const BackgroundWriter&) = delete;
    BackgroundWriter& operator=(const BackgroundWriter&) = delete;

    /// Exchanges `packet` for the one written before, whose memory can be used again. Throws what the writing
    /// of an earlier packet has thrown, every time anew.
    void hand_over(Packet& packet);

    /// Until all is written. Throws as hand_over.
    void wait();

    double busy_seconds() const;  ///< spent writing so far [s]

  private:
    void work();
    std::unique_lock<std::mutex> lock_when_idle();

    const std::function<void(const Packet&)> write_;
    mutable std::mutex mutex_;  // of all that follows, packet_ only while it is not full
    std::condition_variable changed_;
    Packet packet_;
    bool full_ = false, ending_ = false;
    std::exception_ptr error_;
    double busy_seconds_ = 0.0;
    std::thread thread_;  // last: it uses the others
};

}  // namespace quern
