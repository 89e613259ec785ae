#include "waiting.hpp"

#include <chrono>

#include "spikeloop/core/pacer.hpp"

namespace spikeloop {
namespace {

constexpr std::chrono::milliseconds kPeriod{20};

/// The launcher is told the truth however the wait ends.
class Phase {
 public:
  explicit Phase(const std::function<void(bool)>& enter) : enter_(enter) { enter_(true); }
  ~Phase() { enter_(false); }
  Phase(const Phase&) = delete;
  Phase& operator=(const Phase&) = delete;

 private:
  const std::function<void(bool)>& enter_;
};

}  // namespace

void Waiting::notify() {
  { const std::lock_guard lock(mutex_); }  // not between the question and the sleep
  come_.notify_one();
}

bool Waiting::until(const std::function<bool()>& done,
                    const std::function<void(TimeNs)>& meanwhile) {
  std::unique_lock lock(mutex_);
  if (done()) {
    return !surroundings_.stop();
  }
  const Phase waits(surroundings_.enter);
  const TimeNs started = wall_now();
  TimeNs asked = started;
  while (!surroundings_.stop()) {
    come_.wait_for(lock, kPeriod);
    if (done()) {
      return !surroundings_.stop();
    }
    const TimeNs now = wall_now();
    if (now - asked >= std::chrono::nanoseconds(kPeriod).count()) {
      asked = now;
      lock.unlock();
      meanwhile(now - started);
      lock.lock();
    }
  }
  return false;
}

}  // namespace spikeloop
