// The robot's side of docs/stepping.md: it moves when an experiment says so.
#pragma once

#include <atomic>
#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "options.hpp"
#include "spikeloop/robot/command_topic.hpp"
#include "spikeloop/robot/messages.hpp"
#include "spikeloop/robot/sensors.hpp"
#include "spikeloop/stepping/protocol.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::robot {

class StepLink {
 public:
  using Bytes = std::vector<std::byte>;

  StepLink(const RunOptions& options, topics::Session& session,
           const std::vector<SensorTopic>& sensors, const CommandTopic& command);

  /// The next request; nothing when `stop` is true or ROS has shut the node down. Refuses what it
  /// cannot read.
  std::optional<stepping::Request> next(const std::atomic<bool>& stop);
  /// Counts begin with 0, but with 1 what a run before has published for all. `sensors` are the
  /// topics that the experiment takes.
  void begin(const std::vector<std::string>& sensors);
  /// Waits until so many commands have come, then gives the newest of those not given yet.
  /// @param problem what is wrong with their number
  std::optional<Bytes> take_command(const stepping::Counts& sent, const std::atomic<bool>& stop,
                                    std::string& problem);
  /// Whether the experiment takes a sensor, or somebody else listens to it.
  bool wanted(std::size_t sensor) const;
  void publish(std::size_t sensor, std::span<const std::byte> message);
  void publish_clock(TimeNs time);
  void answer(TimeNs time);
  void refuse(const std::string& problem);

  std::uint64_t commands() const { return commands_; }
  std::uint64_t scans() const { return sensors_.front().count; }
  bool alive() const { return session_.alive(); }

 private:
  struct Topic {
    std::string name;
    std::unique_ptr<topics::RawPublisher> publisher;
    bool latched = false;  // its one message reaches everybody, whenever they come
    bool sent = false;
    bool taken = false;  // by the experiment
    std::uint64_t count = 0;
  };

  /// @return false after a minute, or when the robot is to stop
  template <typename Done>
  bool wait(const std::atomic<bool>& stop, Done&& done);
  void take(std::span<const std::byte> command);
  void take_request(std::span<const std::byte> message);

  topics::Session& session_;
  std::vector<Topic> sensors_;
  ClockMessage clock_message_;
  std::unique_ptr<topics::RawPublisher> clock_;
  std::unique_ptr<topics::RawPublisher> answers_;
  std::string command_topic_;
  std::mutex mutex_;
  std::condition_variable come_;
  std::deque<std::string> requests_;
  std::optional<Bytes> newest_;
  std::atomic<std::uint64_t> commands_{0};
  // The last: what callbacks use is there before them.
  std::unique_ptr<topics::RawSubscriber> command_subscriber_;
  std::unique_ptr<topics::RawSubscriber> request_subscriber_;
};

}  // namespace spikeloop::robot
