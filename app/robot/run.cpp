#include "run.hpp"

#include "report.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "ros_link.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/robot/files.hpp"
#include "spikeloop/robot/stepped_robot.hpp"
#include "spikeloop/status/deadline.hpp"
#include "spikeloop/topics/rosout.hpp"

namespace spikeloop::robot {
namespace {

constexpr TimeNs kTick = 1'000'000;
constexpr TimeNs kProgressPeriod = 250'000'000;  // wall time

/// Since 1970: what a clock on the wall shows.
TimeNs wall_time() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

class Loop {
 public:
  Loop(const RunOptions& options, const status::Sender& status, SteppedRobot& robot,
       topics::Session& session)
      : options_(options),
        status_(status),
        robot_(robot),
        ros_(options, session, robot.topics(), robot.command_topic()),
        pacer_(make_realtime_pacer(options.real_time_factor, kTick)),
        clock_period_(whole_ticks(1 / options.clock_rate_hz)) {}

  void run(const std::atomic<bool>& stop) {
    const TimeNs end = options_.duration_s > 0 ? from_seconds(options_.duration_s)
                                               : std::numeric_limits<TimeNs>::max();
    if (options_.real_time_factor == 1) {
      begin_ = wall_time();
      robot_.begin_stamps(begin_);
    }
    pacer_->start();
    status_.first_tick();
    for (TimeNs t = 0; t < end && !stop; t += kTick) {
      pacer_->wait_until(t);
      publish(t);
      if (const auto command = ros_.take_command()) {
        robot_.act(*command);
      }
      robot_.advance(t + kTick);
      options_.check_files();
      report_progress();
      if (!ros_.alive()) {
        finish();
        throw TransportError(fmt::format(
            "ROS has shut this node down after {}; does another node have the name '{}'?",
            format_time(robot_.time()), options_.node_name));
      }
    }
    publish(robot_.time());
    finish();
    options_.check_files();  // finish() writes the last rows
  }

 private:
  static TimeNs whole_ticks(double seconds) {
    return std::max<TimeNs>(1, std::llround(seconds * 1e9 / static_cast<double>(kTick))) * kTick;
  }

  // Everything that is due at `t`, which no subscriber has to hear about at 0, but what never
  // changes: ROS takes a stamp of zero for none.
  void publish(TimeNs t) {
    robot_.publish(
        t,
        [&](std::size_t sensor) {
          if (t == 0 && !robot_.topics()[sensor].latched()) return false;
          if (sensor == 0) ++scans_;
          return ros_.wanted(sensor);
        },
        [this](std::size_t sensor, auto message) { ros_.publish(sensor, message); });
    if (t == 0) return;
    if (t % clock_period_ == 0) ros_.publish_clock(begin_ + t);  // after what is of that time
  }

  void report_progress() {
    const TimeNs now = wall_now();
    if (now - reported_ < kProgressPeriod) return;
    reported_ = now;
    const auto report = pacer_->report();
    auto shown = nlohmann::json::object();
    if (const vehicle::Vehicle* const vehicle = robot_.robot().vehicle()) {
      shown["collisions"] = vehicle->statistics().collisions;
    }
    status_.progress({robot_.time(), report.wall_time, report.overruns}, shown);
  }

  void finish() {
    robot_.finish();
    const auto clock = pacer_->report();
    auto counters = counters_of(robot_.robot(), ros_.commands(), scans_);
    counters["overruns"] = clock.overruns;
    status_.report(counters, robot_.summary());
    fmt::print("{} simulated in {:.1f} s: {}commands {}, overruns {}\n", format_time(robot_.time()),
               to_seconds(clock.wall_time), drive_text(robot_.robot()), ros_.commands(),
               clock.overruns);
  }

  const RunOptions& options_;
  const status::Sender& status_;
  SteppedRobot& robot_;
  RosLink ros_;
  std::unique_ptr<Pacer> pacer_;
  TimeNs clock_period_;
  TimeNs begin_ = 0;  ///< stamp of simulated time 0
  std::uint64_t scans_ = 0;
  TimeNs reported_ = 0;
};

}  // namespace

void run(const RunOptions& options, const topics::RosArguments& arguments,
         const status::Sender& status, const std::atomic<bool>& stop) {
  SteppedRobot robot(options.robot());
  auto session = open_session(options, arguments, stop);
  if (session == nullptr) return;
  topics::Rosout rosout(*session);
  Loop loop(options, status, robot, *session);
  status.started();
  rosout.during([&] { loop.run(stop); });
  status::end_in_time(0);
}

}  // namespace spikeloop::robot
