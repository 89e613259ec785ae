// What carries messages between the graph and the robot.
#pragma once

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/core/pacer.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/robot/episodes.hpp"
#include "spikeloop/ros_command/command_endpoint.hpp"
#include "spikeloop/topics/session.hpp"
#include "spikeloop/topics/topic_source.hpp"

namespace spikeloop::fused {

class Transport {
 public:
  Transport() = default;
  Transport(const Transport&) = delete;
  Transport& operator=(const Transport&) = delete;
  virtual ~Transport() = default;

  /// In which the topic of a sensor or a command is. Asked once for each.
  virtual topics::Session& session(const experiment::Node& node) = 0;
  /// A topic as others see it.
  virtual std::string whole_topic(const std::string& topic) const { return topic; }
  /// Whose time the endpoints go by.
  virtual command::CommandClock clock() const { return command::CommandClock::lockstep; }
  /// A message of a sensor has come. Called in a thread of its session.
  virtual void arrived() {}
  /// Told of every endpoint, before the loop begins; they live as long as it runs.
  virtual void add(const std::string& /*topic*/, const topics::TopicSource& /*sensor*/) {}
  virtual void add(const std::string& /*topic*/, ros_command::CommandEndpoint& /*command*/) {}
  /// Called once, after all calls of add().
  virtual void endpoints_added() {}

  /// The robot's clock, with sync: sim_time; as all that waits here, it comes back when the run is
  /// to stop.
  virtual std::unique_ptr<Pacer> pacer() { return nullptr; }
  /// The clock shows `time`: before the graph steps. May wait for the robot.
  virtual void begin(TimeNs /*time*/) {}
  /// The graph has stepped to `time`.
  virtual void end(TimeNs /*time*/) {}
  /// Of a robot in this process that has a task.
  virtual const robot::Episodes* episodes() const { return nullptr; }
  /// Nothing more comes; files are closed.
  virtual void finish() {}
  /// collisions, distance_m, ... of a robot that it knows.
  virtual nlohmann::json summary() const { return nlohmann::json::object(); }
};

}  // namespace spikeloop::fused
