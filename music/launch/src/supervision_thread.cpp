#include "supervision_thread.hpp"

#include <signal.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "spikeloop/core/priority.hpp"
#include "spikeloop/processes/descendants.hpp"

namespace spikeloop::launch {

SupervisionThread::SupervisionThread(const std::string& path)
    : page_(path), turned_(wall_now()), thread_([this] { run(); }) {}

SupervisionThread::~SupervisionThread() {
  ending_.store(true);
  thread_.join();
}

void SupervisionThread::require(std::vector<pid_t> processes) {
  const std::lock_guard lock(mutex_);
  required_ = std::move(processes);
}

void SupervisionThread::run() {
  run_before_others();
  while (!ending_.load()) {
    stopped_.store(find_stopped());
    if (stopped_.load() == 0 && wall_now() - turned_.load() < kLongestHang) {
      page_.beat(wall_now());
    }
    continue_guard();
    std::this_thread::sleep_for(std::chrono::nanoseconds(status::kSupervisionPeriod));
  }
}

pid_t SupervisionThread::find_stopped() {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(required_, is_stopped);
  return found == required_.end() ? 0 : *found;
}

void SupervisionThread::continue_guard() {
  const pid_t guard = guard_.load();
  if (guard > 0 && is_stopped(guard)) {
    kill(guard, SIGCONT);
    continued_.store(true);
  }
}

}  // namespace spikeloop::launch
