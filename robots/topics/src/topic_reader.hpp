// A topic of one type in: what the sources of this module share.
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
  std::string node{};  ///< its name in an experiment, for warnings; empty in a .music file
  std::string topic;
  std::string type;  ///< "sensor_msgs/LaserScan"
  std::uint32_t queue = 10;
  bool type_is_a_key = false;       ///< message_type can be written
  bool reliable = false;            ///< as Subscription has it
  std::function<void()> arrived{};  ///< in the session's thread, after every message

  /// Whether messages from before the subscription are taken. A robot that is stepped counts its
  /// messages from the start of a run, except for frames that never change (REP 105, tf2).
  bool takes_latched() const { return queue != 0 || topic == "/tf_static" || topic == "tf_static"; }
};

/// Subscribes and hands messages on; remembers what is wrong until the loop asks.
class TopicReader {
 public:
  /// Called in the session's thread the moment a message has arrived, with the time of the
  /// monotonic clock. Returns the warnings to log. What it throws ends the run; a
  /// ConfigurationError without a location gets the name of the topic.
  using Take = std::function<std::vector<std::string>(std::span<const std::byte>, TimeNs now)>;

  /// @throws ConfigurationError for an unknown type or an impossible topic.
  TopicReader(Session& session, const TopicReaderSettings& settings, Take take);
  TopicReader(const TopicReader&) = delete;
  TopicReader& operator=(const TopicReader&) = delete;

  /// In the loop, every tick. Says once that nothing comes, and once that nothing comes any more,
  /// by the wall clock, or by the simulated time that is given.
  /// @throws TransportError when the topic has brought messages of another type or version and none
  /// of the right one, or the session's node has been shut down; what `take` threw.
  void check(std::optional<TimeNs> simulated = std::nullopt);
  /// The same without a word of silence.
  void require_sound() const;
  /// Logs a warning with node and topic.
  void warn(const std::string& text) const;
  bool has_publishers() const { return subscriber_->has_publishers(); }
  std::uint64_t received() const { return received_; }  ///< messages that `take` took
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
  std::string topic_;  ///< its whole name
  Take take_;
  std::atomic<std::uint64_t> received_{0};

  mutable std::mutex mutex_;  // held for a moment, never across a tick
  TimeNs newest_at_ = 0;      // 0: none has come
  std::exception_ptr failure_;
  mutable OtherTypes other_types_;

  TimeNs started_ = 0;  // used by the loop only
  TimeNs looked_at_ = 0;
  TimeNs noticed_ = 0;  // newest_at_ at the tick that began at noticed_at_
  TimeNs noticed_at_ = 0;
  /// Messages of the last seconds: a warning needs a large part of many.
  struct Window {
    TimeNs begin = 0;
    std::uint64_t received = 0;  ///< at its begin
    std::uint64_t lost = 0;
  };
  Window window_{};
  TimeNs loss_checked_at_ = 0;
  bool warned_of_loss_ = false;
  bool told_nothing_came_ = false;
  bool told_nothing_comes_ = false;
  std::unique_ptr<RawSubscriber> subscriber_;  // last: what its callbacks use is there before it
};

}  // namespace spikeloop::topics
