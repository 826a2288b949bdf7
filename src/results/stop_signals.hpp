// Ctrl-C and SIGTERM as a question that loops ask.
#pragma once

namespace quern {

/// While it lives, SIGINT and SIGTERM only ask to stop: loops end after the work at hand.
class StopSignals {
  public:
    StopSignals();
    ~StopSignals();  ///< gives the signals back
    StopSignals(const StopSignals&) = delete;
    StopSignals& operator=(const StopSignals&) = delete;

  private:
    void (*previous_int_)(int);
    void (*previous_term_)(int);
};

/// True once a signal has come, until the next StopSignals.
bool stop_requested();

}  // namespace quern
