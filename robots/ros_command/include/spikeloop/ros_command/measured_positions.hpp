// The measured positions that a stop holds.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/command/command_sink.hpp"
#include "spikeloop/messages/field_path.hpp"
#include "spikeloop/topics/other_types.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros_command {

/// Reads sensor_msgs/JointState in the session's thread and passes positions to the sink.
class MeasuredPositions {
 public:
  /// @throws ConfigurationError: an impossible topic.
  MeasuredPositions(topics::Session& session, const command::CommandSettings& settings,
                    command::CommandSink& sink);
  MeasuredPositions(const MeasuredPositions&) = delete;
  MeasuredPositions& operator=(const MeasuredPositions&) = delete;

  const std::string& topic() const { return topic_; }
  bool has_publishers() const { return subscriber_->has_publishers(); }
  /// Messages that were received.
  std::uint64_t received() const { return received_.load(); }
  /// Warns once per publisher of another type. Call in the loop's thread.
  void report_other_types();

 private:
  void take(std::span<const std::byte> message);

  const std::string topic_;
  command::CommandSink& sink_;
  std::vector<std::optional<messages::FieldReader>> readers_;  ///< per component
  std::vector<double> positions_;  ///< of the newest message; NaN: not contained
  std::atomic<std::uint64_t> received_{0};
  std::atomic<bool> warned_{false};
  topics::OtherTypes other_types_;
  std::unique_ptr<topics::RawSubscriber> subscriber_;  ///< last: uses all other members
};

}  // namespace spikeloop::ros_command
