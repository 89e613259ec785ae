// The writers of a topic that a subscription reads, and which of their messages have arrived.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <vector>

#include "graph.hpp"
#include "raw_type.hpp"
#include "spikeloop/topics/session.hpp"

namespace spikeloop::ros2 {

/// What a reader requests of its writers, from the least on.
enum class Level : std::uint8_t { best_effort, reliable, latched };

/// Assigns a level to every writer. Messages of a writer are accepted from the reader of its level,
/// and from any other reader until that reader has brought its first: a program may publish its
/// only message, and end, as soon as one reader is connected. A latched reader brings such
/// messages, too. Thread-safe.
class Sources {
 public:
  explicit Sources(const topics::Subscription& subscription);

  /// Records that a writer of the topic's type exists or has left. Levels of other writers may
  /// change, too: late messages are requested only while every writer offers them.
  void update(const Writer& writer, bool alive);
  /// Levels of the writers that exist; none twice.
  std::vector<Level> levels() const;
  std::optional<Level> level_of(dds_instance_handle_t writer) const;
  /// True if there are writers, past or present, and all of them are latched.
  bool all_latched() const;

  /// @param level of the reader that has brought the message
  /// @return false if the message has been accepted before, or another reader brings it
  bool accept(Level level, dds_instance_handle_t writer, std::int64_t number);
  /// As topics::RawSubscriber::lost().
  std::uint64_t lost(const ddsi_sertype* type);

 private:
  struct Source {
    dds_guid_t guid{};
    bool known = false;  ///< discovery has reported it
    bool alive = false;
    bool reliable = false;
    bool latched = false;
    bool settled = false;        ///< the reader of its level has brought a message
    std::int64_t newest = 0;     ///< number of the newest accepted message; 0: none
    std::int64_t announced = 0;  ///< number of the newest message at our first look
  };

  bool requests_late_messages() const;
  Level level(const Source& source) const;
  void forget_some();

  bool every_message_;
  bool reliable_;
  bool late_;  ///< the subscription wants what was published before
  mutable std::mutex mutex_;
  std::map<dds_instance_handle_t, Source> sources_{};
  bool late_now_ = false;  ///< every writer offers it
  std::uint64_t lost_ = 0;
  std::chrono::steady_clock::time_point come_at_ = std::chrono::steady_clock::now();
};

}  // namespace spikeloop::ros2
