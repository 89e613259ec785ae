#include "ros_transport.hpp"

#include <nlohmann/json.hpp>
#include <utility>

#include "clock_pacer.hpp"
#include "spikeloop/session/open.hpp"
#include "spikeloop/topics/arguments.hpp"
#include "spikeloop/topics/names.hpp"

namespace spikeloop {

using experiment::Sync;

namespace {

/// Of several processes each is a node of its own.
std::string node_name(const experiment::Experiment& experiment, const std::string& process) {
  const std::string name = "spikeloop_" + experiment.name;
  return topics::as_node_name(experiment.layout.processes.size() > 1 ? name + "_" + process : name);
}

}  // namespace

RosTransport::RosTransport(const experiment::Experiment& experiment, const std::string& process,
                           const std::string& ros_arguments, const std::string& folder,
                           WriteFailures& failures, const LoopSurroundings& surroundings)
    : experiment_(experiment),
      session_(session::open({{.node_name = node_name(experiment, process),
                               .unique_name = true,
                               .arguments = topics::read_ros_arguments(ros_arguments)},
                              experiment.dialect})),
      rosout_(*session_),
      waiting_(surroundings),
      folder_(folder),
      failures_(failures) {
  if (experiment.sync == Sync::lockstep) {
    robot_.emplace(*session_, experiment.tick, waiting_);
  }
}

command::CommandClock RosTransport::clock() const {
  using enum command::CommandClock;
  if (robot_) {
    return lockstep;
  }
  return experiment_.sync == Sync::sim_time ? simulated : wall;
}

void RosTransport::arrived() {
  if (robot_) {
    waiting_.notify();
  }
}

/// A robot that is stepped says how many messages it has sent, and all of them count.
void RosTransport::add(const std::string& topic, const topics::TopicSource& sensor) {
  if (robot_) {
    robot_->add_sensor({session_->whole_topic(topic), [&sensor] { return sensor.has_publishers(); },
                        [&sensor] { return sensor.received(); },
                        [&sensor] { sensor.require_sound(); }});
  }
}

void RosTransport::add(const std::string& topic, ros_command::CommandEndpoint& command) {
  commands_.push_back(&command);
  if (robot_) {
    robot_->add_command({session_->whole_topic(topic),
                         [&command] { return command.has_subscribers(); },
                         [&command] { return command.sent(); },
                         {},
                         [&command] { return command.deliver(); }});
    if (const auto* positions = command.positions()) {
      robot_->add_sensor({session_->whole_topic(positions->topic()),
                          [positions] { return positions->has_publishers(); },
                          [positions] { return positions->received(); }, [] {}});
    }
  }
}

/// The experiment's sensors have subscribed: over ROS 1 the first subscription of a process
/// determines the type of a topic.
void RosTransport::endpoints_added() {
  // The simulated robot writes trajectory.csv itself.
  if (!robot_ && !experiment_.robot && !folder_.empty()) {
    odometry_.emplace(*session_, folder_, failures_);
  }
}

std::unique_ptr<Pacer> RosTransport::pacer() {
  return make_clock_pacer(*session_, experiment_.tick, waiting_, [this] {
    for (ros_command::CommandEndpoint* command : commands_) {
      command->sink().alive();
    }
  });
}

void RosTransport::begin(TimeNs time) {
  if (robot_ && time == 0) {
    robot_->begin();
  }
}

void RosTransport::end(TimeNs time) {
  if (robot_) {
    robot_->advance(time);
  }
  if (odometry_) {
    odometry_->tick(time);
  }
}

void RosTransport::finish() {
  if (robot_) {
    robot_->end();
  }
  if (odometry_) {
    odometry_->close();
  }
}

nlohmann::json RosTransport::summary() const {
  return odometry_ ? odometry_->summary() : nlohmann::json::object();
}

}  // namespace spikeloop
