#include "src/results/background_writer.hpp"

#include <chrono>
#include <utility>

namespace quern {

BackgroundWriter::BackgroundWriter(std::function<void(const Packet&)> write)
    : write_(std::move(write)), thread_([this] { work(); }) {}

BackgroundWriter::~BackgroundWriter() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

void BackgroundWriter::hand_over(Packet& packet) {
    const auto lock = lock_when_idle();
    std::swap(packet, packet_);
    full_ = true;
    changed_.notify_all();
}

void BackgroundWriter::wait() {
    lock_when_idle();
}

double BackgroundWriter::busy_seconds() const {
    const std::lock_guard lock(mutex_);
    return busy_seconds_;
}

std::unique_lock<std::mutex> BackgroundWriter::lock_when_idle() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !full_; });
    if (error_) std::rethrow_exception(error_);
    return lock;
}

void BackgroundWriter::work() {
    std::unique_lock lock(mutex_);
    for (;;) {
        changed_.wait(lock, [this] { return full_ || ending_; });
        if (!full_) return;
        lock.unlock();
        const auto start = std::chrono::steady_clock::now();
        std::exception_ptr error;
        try {
            write_(packet_);
        } catch (...) {
            error = std::current_exception();
        }
        const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
        lock.lock();
        busy_seconds_ += spent.count();
        error_ = error;
        full_ = false;
        changed_.notify_all();
    }
}

}  // namespace quern
