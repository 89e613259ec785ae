// spikeloop-robot --step: the loop belongs to the experiment.
#include <fmt/format.h>

#include "report.hpp"
#include "ros_link.hpp"
#include "run.hpp"
#include "spikeloop/core/error.hpp"
#include "spikeloop/robot/files.hpp"
#include "spikeloop/robot/stepped_robot.hpp"
#include "spikeloop/status/deadline.hpp"
#include "spikeloop/topics/rosout.hpp"
#include "step_link.hpp"

namespace spikeloop::robot {
namespace {

using stepping::Request;

class SteppedRun {
 public:
  SteppedRun(const RunOptions& options, topics::Session& session, const std::atomic<bool>& stop)
      : run_options_(options),
        options_(options.robot()),
        robot_(std::in_place, options_),
        link_(options, session, robot_->topics(), robot_->command_topic()),
        stop_(stop) {}

  void run() {
    while (const auto request = link_.next(stop_)) {
      take(*request);
    }
    if (!link_.alive()) {
      throw TransportError(
          fmt::format("ROS has shut this node down after {}; does another node have the name '{}'?",
                      format_time(robot_->time()), run_options_.node_name));
    }
  }

  SteppedRobot& robot() { return *robot_; }
  const StepLink& link() const { return link_; }

 private:
  void take(const Request& request) {
    switch (request.kind) {
      case Request::Kind::begin:
        begin(request);
        return;
      case Request::Kind::step:
        step(request);
        return;
      case Request::Kind::end:
        robot_->finish();
    }
  }

  void begin(const Request& request) {
    if (request.run != 0 && request.run == run_) {  // the answer has been lost
      link_.answer(robot_->time());
      return;
    }
    run_ = request.run;
    if (begun_) {  // once more from the start, and not onto the same film
      options_.spectators.film.reset();
      robot_.reset();  // one window at a time
      robot_.emplace(options_);
    }
    begun_ = true;
    link_.begin(request.sensors);
    answer();
  }

  void step(const Request& request) {
    if (!begun_ || request.to <= robot_->time()) {
      link_.refuse(fmt::format(
          "it was told to advance to {}, and {}", format_time(request.to),
          begun_ ? fmt::format("stands at {}", format_time(robot_->time())) : "not to begin"));
      return;
    }
    std::string problem;
    const auto command = link_.take_command(request.sent, stop_, problem);
    if (!problem.empty()) {
      link_.refuse(problem);
      return;
    }
    if (command) {
      robot_->command(*command);
    }
    robot_->advance(request.to);
    run_options_.check_files();
    answer();
  }

  void answer() {
    const TimeNs now = robot_->time();
    robot_->publish(
        now, [this](std::size_t sensor) { return link_.wanted(sensor); },
        [this](std::size_t sensor, auto message) { link_.publish(sensor, message); });
    link_.publish_clock(now);
    link_.answer(now);
  }

  const RunOptions& run_options_;
  RobotOptions options_;
  std::optional<SteppedRobot> robot_;
  StepLink link_;
  const std::atomic<bool>& stop_;
  bool begun_ = false;
  std::uint64_t run_ = 0;
};

void report(const SteppedRobot& robot, const StepLink& link, const status::Sender& status) {
  status.report(counters_of(robot.robot(), link.commands(), link.scans()), robot.summary());
  fmt::print("stepped to {}: {}commands {}\n", format_time(robot.time()), drive_text(robot.robot()),
             link.commands());
}

}  // namespace

void run_stepped(const RunOptions& options, const topics::RosArguments& arguments,
                 const status::Sender& status, const std::atomic<bool>& stop) {
  auto session = open_session(options, arguments, stop);
  if (session == nullptr) {
    return;
  }
  topics::Rosout rosout(*session);
  SteppedRun loop(options, *session, stop);
  status.started();
  status.first_tick();
  rosout.during([&] { loop.run(); });
  loop.robot().finish();
  report(loop.robot(), loop.link(), status);
  options.check_files();  // finish() writes the last rows
  status::end_in_time(0);
}

}  // namespace spikeloop::robot
