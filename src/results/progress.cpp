#include "src/results/progress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace quern {

namespace {

constexpr double between_looks = 0.05, between_shows = 0.2;    // [s]
constexpr double least_between_logs = 1.0, between_logs = 30;  // [s]
constexpr double log_fraction = 0.05;
constexpr double memory = 10.0;  // the pace is that of about the last ten seconds [s]
constexpr int largest_stride = 1 << 20;

double system_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

std::string make_duration(double seconds) {
    if (!std::isfinite(seconds) || seconds < 0.0 || seconds > 1e9) return "?";
    const auto whole = static_cast<std::int64_t>(std::llround(seconds));
    const std::int64_t hours = whole / 3600, minutes = whole / 60 % 60;
    if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, whole % 60);
    return fmt::format("{}:{:02}", minutes, whole % 60);
}

Progress::Progress(bool terminal, double t_end, Log log, std::FILE* screen, Clock clock)
    : terminal_(terminal),
      t_end_(t_end),
      log_(std::move(log)),
      screen_(screen),
      clock_(clock ? std::move(clock) : Clock(system_seconds)) {}

void Progress::look_at_clock() {
    const double now = clock_();
    if (!started_) {
        started_ = true;
        t_start_ = time_;
        last_look_ = last_shown_ = last_logged_ = now;
    } else {
        const double seconds = now - last_look_;
        // Many calls between two looks when steps are short, every call when they are long.
        if (seconds < 0.5 * between_looks) stride_ = std::min(2 * stride_, largest_stride);
        if (seconds > 2.0 * between_looks)
            stride_ = std::max(1, static_cast<int>(stride_ * between_looks / seconds));
        forget_past(seconds);
        last_look_ = now;
        if (terminal_ && now - last_shown_ >= between_shows) {
            show();
            last_shown_ = now;
        }
        const double quiet = now - last_logged_;
        if (quiet >= between_logs || (quiet >= least_between_logs && fraction() >= next_logged_fraction_))
            write_log(now);
    }
    last_step_ = step_;
    last_time_ = time_;
    calls_left_ = stride_;
}

void Progress::forget_past(double seconds) {
    const double kept = std::exp(-seconds / memory);
    recent_seconds_ = kept * recent_seconds_ + seconds;
    recent_steps_ = kept * recent_steps_ + static_cast<double>(step_ - last_step_);
    recent_time_ = kept * recent_time_ + (time_ - last_time_);
}

double Progress::fraction() const {
    return t_end_ > t_start_ ? std::clamp((time_ - t_start_) / (t_end_ - t_start_), 0.0, 1.0) : 1.0;
}

std::string Progress::line() const {
    const double pace = recent_seconds_ > 0.0 ? recent_steps_ / recent_seconds_ : 0.0;
    const double left = (t_end_ - time_) * recent_seconds_ / recent_time_;
    return fmt::format("{:5.1f} %  step {}  t {:.4g} s  {:.3g} steps/s  {} left  energy error {:.1e}",
                       100.0 * fraction(), step_, time_, pace, make_duration(std::max(0.0, left)),
                       energy_error_);
}

void Progress::show() {
    fmt::print(screen_, "\r{}\x1b[K", line());
    std::fflush(screen_);
}

void Progress::write_log(double now) {
    if (log_) log_(line());
    last_logged_ = now;
    next_logged_fraction_ = (std::floor(fraction() / log_fraction) + 1.0) * log_fraction;
}

void Progress::finish() {
    if (!started_) return;
    const double now = clock_();
    forget_past(now - last_look_);
    if (terminal_) {
        show();
        fmt::print(screen_, "\n");
    }
    write_log(now);
    started_ = false;
}

}  // namespace quern
