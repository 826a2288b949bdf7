#include "src/results/stop_signals.hpp"

#include <csignal>

namespace quern {

namespace {

volatile std::sig_atomic_t requested = 0;
void request_stop(int) {
    requested = 1;
}

}  // namespace

StopSignals::StopSignals() {
    requested = 0;
    previous_int_ = std::signal(SIGINT, request_stop);
    previous_term_ = std::signal(SIGTERM, request_stop);
}

StopSignals::~StopSignals() {
    std::signal(SIGINT, previous_int_);
    std::signal(SIGTERM, previous_term_);
}

bool stop_requested() {
    return requested != 0;
}

}  // namespace quern
