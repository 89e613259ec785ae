#include "spikeloop/core/pacer.hpp"
#include "spikeloop/core/code.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>

#include "spikeloop/core/error.hpp"

namespace spikeloop {

TimeNs wall_now() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return TimeNs{now.tv_sec} * kNsPerSecond + now.tv_nsec;
}

namespace {

void sleep_until(TimeNs wall) {
  timespec until{};
  until.tv_sec = wall / kNsPerSecond;
  until.tv_nsec = wall % kNsPerSecond;
  // A signal may end the sleep early: the caller's loop wants to see it, so it is not resumed here.
  clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr);
}

class UnpacedPacer : public Pacer {
 public:
  void start() override { started_ = wall_now(); }
  void wait_until(TimeNs) override { ++report_.ticks; }
  Report report() const override {
    Report report = report_;
    report.wall_time = wall_now() - started_;
    return report;
  }

 protected:
  Report report_;
  TimeNs started_ = 0;
};

class RealtimePacer : public UnpacedPacer {
 public:
  RealtimePacer(double factor, TimeNs tick)
      : factor_(factor),
        wall_tick_(std::max<TimeNs>(1, std::llround(static_cast<double>(tick) / factor))),
        most_catch_up_(std::max<TimeNs>(3 * wall_tick_, 100'000'000)) {}

  void start() override {
    UnpacedPacer::start();
    origin_ = started_;
  }

  void wait_until(TimeNs time) override {
    ++report_.ticks;
    const TimeNs due = origin_ + std::llround(static_cast<double>(time) / factor_);
    TimeNs now = wall_now();
    if (now < due) {
      sleep_until(due);
      now = wall_now();
    }
    const TimeNs lateness = now - due;
    report_.worst_lateness = std::max(report_.worst_lateness, lateness);
    if (lateness > wall_tick_) {
      ++report_.overruns;
    }
    if (lateness > most_catch_up_) {
      origin_ += lateness - most_catch_up_;
    }
  }

 private:
  double factor_;
  TimeNs wall_tick_;
  TimeNs most_catch_up_;
  TimeNs origin_ = 0;
};

}  // namespace

std::unique_ptr<Pacer> make_realtime_pacer(double factor, TimeNs tick) {
  if (!std::isfinite(factor) || factor <= 0) {
    throw ConfigurationError(with_code(
        Code::out_of_bounds,
        "a real-time factor of {} cannot be kept; write a number above 0, 1 is real time", factor));
  }
  return std::make_unique<RealtimePacer>(factor, tick);
}

std::unique_ptr<Pacer> make_unpaced_pacer() {
  return std::make_unique<UnpacedPacer>();
}

}  // namespace spikeloop
