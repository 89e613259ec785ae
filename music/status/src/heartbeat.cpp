#include "spikeloop/status/heartbeat.hpp"

namespace spikeloop::status {
namespace {

constexpr std::chrono::milliseconds kPeriod{500};

}  // namespace

Heartbeat::Heartbeat(const Sender& sender) : sender_(sender) {
  if (sender_.connected()) {
    thread_ = std::thread([this] { run(); });
  }
}

Heartbeat::~Heartbeat() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void Heartbeat::run() {
  std::unique_lock lock(mutex_);
  do {
    sender_.alive(phase_.load(std::memory_order_relaxed),
                  simulated_.load(std::memory_order_relaxed));
  } while (!wake_.wait_for(lock, kPeriod, [this] { return ended_; }));
}

}  // namespace spikeloop::status
