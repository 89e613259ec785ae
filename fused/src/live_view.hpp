// What a process shows to the live view while it runs, and what it does that the view asks for.
#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "shown_weights.hpp"
#include "spikeloop/core/endpoint.hpp"
#include "spikeloop/experiment/experiment.hpp"
#include "spikeloop/fused/run.hpp"
#include "spikeloop/live/feed.hpp"
#include "spikeloop/ros_command/command_endpoint.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::fused {

class Changes;
class ShownOutput;
class ShownTopic;

class LiveView {
 public:
  /// @param folder as live::Feed
  LiveView(const std::string& folder, const experiment::Experiment& experiment,
           const std::string& process);
  ~LiveView();
  LiveView(const LiveView&) = delete;
  LiveView& operator=(const LiveView&) = delete;

  // Before the loop begins.

  /// Of an output, "encoder.out"; topic "/encoder/out".
  std::unique_ptr<Sink> sink(const std::string& end, PortKind kind, std::uint32_t width);
  /// Of the topic of a sensor or command.
  topics::Keep messages(const experiment::Node& node);
  /// Of a number that no port has; topic "/wheels/latency".
  std::function<void(TimeNs time, double value)> value(const std::string& topic);
  /// Whose conditions are told.
  void take_commands(std::vector<ros_command::CommandEndpoint*> commands) {
    commands_ = std::move(commands);
  }
  /// Whose weights are shown while they are learned.
  void take_graph(const Graph& graph) { weights_.emplace(feed_, graph); }
  const live::Feed& feed() const { return feed_; }

  // By the loop.

  /// Waits while the run is paused, or is faster than asked for, unless `events.stop`. Then
  /// parameters have the values that the view asks for.
  void before_tick(TimeNs time, Changes& changes, const RunEvents& events);
  /// A parameter has another value, though the view did not ask for it.
  void show(const experiment::Change& change);
  /// Every tick. @param now wall time
  void after_tick(const Progress& progress, TimeNs now);
  /// The run is over; its commands end.
  void finish(const Progress& progress);

 private:
  void flush();
  void tell(const Progress& progress, bool ended);
  void wait(TimeNs time, const RunEvents& events);
  void add_parameters(const std::string& process);
  void keep_to_speed(TimeNs time, const RunEvents& events);

  live::Feed feed_;
  const std::string process_;
  const experiment::Experiment& experiment_;
  const bool pausable_;
  std::vector<std::shared_ptr<ShownOutput>> outputs_;
  std::vector<std::shared_ptr<ShownTopic>> topics_;
  std::vector<ros_command::CommandEndpoint*> commands_;
  std::uint32_t status_ = 0;                    // its channel
  std::vector<experiment::Change> parameters_;  // by their numbers, at the begin
  nlohmann::json changeable_ = nlohmann::json::array();
  TimeNs next_flush_ = 0;
  TimeNs next_status_ = 0;
  std::optional<ShownWeights> weights_;
  TimeNs next_weights_ = 0;
  Progress progress_{};
  std::uint64_t steps_ = 0;  // that were made while the run was paused
  double speed_ = 0;
  TimeNs speed_since_wall_ = 0;
  TimeNs speed_since_ = 0;
};

/// STOP of the live view. It has a thread of its own: a tick may take long.
class StopButton {
 public:
  StopButton(const live::Feed& feed, std::vector<ros_command::CommandEndpoint*> commands);
  ~StopButton();
  StopButton(const StopButton&) = delete;
  StopButton& operator=(const StopButton&) = delete;

 private:
  void look();
  void watch();

  const live::Feed& feed_;
  const std::vector<ros_command::CommandEndpoint*> commands_;
  bool pressed_ = false;
  std::atomic<bool> done_{false};
  std::thread thread_;
};

}  // namespace spikeloop::fused
