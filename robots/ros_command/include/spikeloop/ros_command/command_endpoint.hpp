// A topic of commands, and everything that stops the robot: the sink's own watch, the guard, the
// end of the process.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/guard/link.hpp"
#include "spikeloop/status/signals.hpp"
#include "spikeloop/status/supervision.hpp"
#include "spikeloop/topics/publisher.hpp"
#include "spikeloop/topics/session.hpp"
#include "spikeloop/topics/topic_source.hpp"

namespace spikeloop::ros_command {

class CommandTopics;
class Diagnostics;
class MeasuredPositions;

struct Address {
  std::string process;  ///< how the guard calls this one
  std::string topic;
  std::string message_type;
  std::vector<std::string> fields;  ///< as topics::Publisher has them
};

/// On a local session the robot is stepped by the loop itself: there is no guard, and the end of
/// the process ends the robot, too.
class CommandEndpoint {
 public:
  /// Advertises the topic, and makes the guard advertise it, so that subscribers are connected to
  /// both before the robot is driven: until the guard has met somebody who hears us, steps are let
  /// pass, for 3 s at most. @throws ConfigurationError as topics::Publisher.
  CommandEndpoint(topics::Session& session, const Address& address,
                  const command::CommandSettings& settings, topics::Keep keep = {});
  ~CommandEndpoint();
  CommandEndpoint(const CommandEndpoint&) = delete;
  CommandEndpoint& operator=(const CommandEndpoint&) = delete;

  /// What a graph sends to; a command::CommandSink.
  Sink& graph_sink() { return sink_; }
  /// As CommandSink.
  void on_latency(command::TakeLatency take) { sink_.on_latency(std::move(take)); }
  /// Zero, the last thing that leaves.
  void stop(command::StopReason reason);
  /// As CommandSink's; `stood_at_end` says why the robot stood before the run's end stopped it,
  /// when it did for want of data.
  nlohmann::json summary() const;
  void alive() { sink_.alive(); }
  /// As CommandChannel.
  void allow_no_value() { sink_.allow_no_value(); }
  /// As CommandSink.
  void press_stop(bool pressed) { sink_.press_stop(pressed); }
  /// What the robot is doing. Safe to call from any thread.
  command::Condition condition() const;
  const std::string& node() const { return address_.process; }

  /// Whether somebody hears us, and the guard. To be called from the loop's thread.
  bool has_subscribers() { return publisher_.has_subscribers() && may_begin(); }
  /// As topics::RawPublisher::deliver.
  bool deliver() const { return publisher_.deliver(); }
  /// Messages that have left, zeros included.
  std::uint64_t sent() const { return count_; }
  /// Topic of the measured positions that a stop holds; empty if there is none.
  std::string positions_topic() const;
  bool positions_have_publisher() const;
  /// Messages of this topic that were received.
  std::uint64_t positions_received() const;

 private:
  bool begin_tick(TimeNs end);
  void end_tick();
  void publish(std::span<const double> values);
  void finish();
  void keep_sent();
  command::CommandSink::Transport transport();
  TimeNs beat(TimeNs now);
  std::optional<command::StopReason> lost_supervision(TimeNs now) const;
  void leave_to_guard_if_dead();
  bool may_begin();
  bool drives_unguarded() const;
  void update_guard();
  void mind_subscribers();
  std::optional<topics::Partner> subscriber_of_other_type() const;
  TimeNs report(TimeNs now);

  topics::Session& session_;
  const Address address_;
  const std::string type_;   ///< whole name of the commands' type
  TimeNs driven_since_ = 0;  ///< wall time of the first command; 0: none yet
  TimeNs looked_at_ = 0;     ///< wall time of the last look at the subscribers
  bool told_misfit_ = false;
  bool told_type_ = false;
  bool told_none_ = false;
  TimeNs met_at_ = 0;  ///< wall time at which somebody was seen to hear us; 0: not yet
  std::atomic<bool> waits_for_guard_;
  topics::Publisher publisher_;
  topics::Keep keep_;
  TimeNs ended_ = 0;  ///< of the newest tick
  std::mutex sending_;
  std::vector<std::vector<std::byte>> sent_;  ///< since the tick before, for `keep_`
  std::atomic<std::uint64_t> count_{0};
  std::string stood_at_end_;
  const TimeNs watchdog_;
  const bool guard_required_;
  const bool holds_;  ///< the stop command depends on the last positions
  std::unique_ptr<status::SupervisedRobot> supervised_;  ///< null on a local session
  std::unique_ptr<guard::Link> guard_;                   ///< null on a local session
  std::unique_ptr<Diagnostics> diagnostics_;             ///< null for a robot that is stepped
  command::CommandSink sink_;
  std::unique_ptr<CommandTopics> topics_;         ///< end before what they bring goes to
  std::unique_ptr<MeasuredPositions> positions_;  ///< null if a stop holds no measured position
  std::unique_ptr<status::TerminationHook> on_termination_;
  std::unique_ptr<status::StopHook> on_stop_;  ///< null for a robot that is stepped
};

}  // namespace spikeloop::ros_command
