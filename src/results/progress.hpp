// How far a run has come, for the one who waits.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>

namespace quern {

/// Shows percent done, step, simulated time, pace, time left and energy error: on a terminal one line that is
/// rewritten at most five times a second, in the log a plain line at every 5 % but not within a second of the
/// last, and at least every 30 s. The clock is read every few calls only, so that short steps do not suffer.
class Progress {
  public:
    using Log = std::function<void(const std::string&)>;
    using Clock = std::function<double()>;  ///< seconds from any start

    /// terminal: rewrite a line on `screen`; t_end: simulated time at which 100 % are done [s]; log may be
    /// empty; clock: empty for the system's.
    Progress(bool terminal, double t_end, Log log, std::FILE* screen = stderr, Clock clock = {});

    void update(std::int64_t step, double time, double energy_error) {
        step_ = step;
        time_ = time;
        energy_error_ = energy_error;
        if (--calls_left_ <= 0) look_at_clock();
    }

    /// Shows the last state and leaves the line of the terminal.
    void finish();

  private:
    void look_at_clock();
    void forget_past(double seconds);
    void show();
    void write_log(double now);
    std::string line() const;
    double fraction() const;

    bool terminal_;
    double t_end_;
    Log log_;
    std::FILE* screen_;
    Clock clock_;

    std::int64_t step_ = 0;
    double time_ = 0.0, energy_error_ = 0.0;

    int calls_left_ = 0, stride_ = 1;
    bool started_ = false;
    double t_start_ = 0.0, last_look_ = 0.0, last_shown_ = 0.0, last_logged_ = 0.0;
    double next_logged_fraction_ = 0.05;
    std::int64_t last_step_ = 0;
    double last_time_ = 0.0;
    double recent_seconds_ = 0.0, recent_steps_ = 0.0, recent_time_ = 0.0;  ///< with fading memory
};

/// "0:07", "12:34" or "3:25:45".
std::string make_duration(double seconds);

}  // namespace quern
