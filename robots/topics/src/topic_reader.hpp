// Reads a topic of one type, for the sources of this module.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "spikeloop/core/time.hpp"
#include "spikeloop/topics/other_types.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::topics {

struct TopicReaderSettings {
  std::string node{};  ///< name for warnings; empty in a .music file
  std::string topic;
  std::string type;  ///< "sensor_msgs/LaserScan"
  std::uint32_t queue = 10;
  bool type_is_a_key = false;       ///< the user can set message_type
  bool reliable = false;            ///< as Subscription::reliable
  std::function<void()> arrived{};  ///< called in the session's thread after every message

  /// True if messages from before the subscription are taken. A robot that is stepped counts its
  /// messages from the start of a run, except for frames that never change (REP 105, tf2).
  bool takes_latched() const { return queue != 0 || topic == "/tf_static" || topic == "tf_static"; }
};

/// Subscribes, passes messages to `take`, and keeps errors until the loop calls check().
class TopicReader {
 public:
  /// Called in the session's thread as soon as a message has arrived, with the time of the
  /// monotonic clock. Returns the warnings to log. An exception ends the run; a ConfigurationError
  /// without a location gets the name of the topic.
  using Take = std::function<std::vector<std::string>(std::span<const std::byte>, TimeNs now)>;

  /// @throws ConfigurationError for an unknown type or an invalid topic.
  TopicReader(Session& session, const TopicReaderSettings& settings, Take take);
  TopicReader(const TopicReader&) = delete;
  TopicReader& operator=(const TopicReader&) = delete;

  /// Called in the loop in every tick. Warns once if no message has arrived, and once if no more
  /// messages arrive, by the wall clock or by the given simulated time.
  /// @throws TransportError if the topic carries only messages of another type or version, or if
  /// the session's node has been shut down; exceptions of `take`.
  void check(std::optional<TimeNs> simulated = std::nullopt);
  /// Throws the errors of check(), without warnings.
  void require_sound() const;
  /// Logs a warning with node and topic.
  void warn(const std::string& text) const;
  bool has_publishers() const { return subscriber_->has_publishers(); }
  std::uint64_t received() const { return received_; }  ///< number of messages passed to `take`
  std::uint64_t wrong_type() const { return other_types_.count(); }
  std::optional<std::uint64_t> lost() const { return subscriber_->lost(); }

 private:
  void receive(std::span<const std::byte> message);
  void report_other_types() const;
  void warn_if_silent(TimeNs now, TimeNs newest_at);
  bool all_messages_incomplete();
  void warn_of_loss();

  Session& session_;
  TopicReaderSettings settings_;
  std::string topic_;  ///< full name
  Take take_;
  std::atomic<std::uint64_t> received_{0};

  mutable std::mutex mutex_;  // never held during a whole tick
  TimeNs newest_at_ = 0;      // 0: no message has arrived
  std::exception_ptr failure_;
  mutable OtherTypes other_types_;

  TimeNs started_ = 0;  // used by the loop only
  TimeNs looked_at_ = 0;
  TimeNs noticed_ = 0;  // newest_at_ at the tick that began at noticed_at_
  TimeNs noticed_at_ = 0;
  /// Counts of the last seconds. A warning needs many messages and a large part of them lost.
  struct Window {
    TimeNs begin = 0;
    std::uint64_t received = 0;  ///< count at `begin`
    std::uint64_t lost = 0;
  };
  Window window_{};
  TimeNs loss_checked_at_ = 0;
  bool warned_of_loss_ = false;
  bool warned_of_no_message_ = false;
  bool warned_of_silence_ = false;
  std::unique_ptr<RawSubscriber> subscriber_;  // last: its callbacks use all other members
};

}  // namespace spikeloop::topics
