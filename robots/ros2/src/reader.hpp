// A reader of DDS, served by the session's thread.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>

#include "qos.hpp"
#include "session_impl.hpp"

namespace spikeloop::ros2 {

/// Whose messages a reader gives on.
enum class Writers { any, best_effort };

class Reader {
 public:
  /// @param take called in the session's thread with each message, once; perhaps a second time with
  /// one whose writer ended when it came
  /// @throws TransportError when Cyclone DDS refuses it.
  Reader(Session::Impl& session, const RawTopic& topic, const Qos& qos, Writers writers,
         std::function<void(std::span<const std::byte>)> take);
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  bool has_writers() const;
  /// In the session's thread: of a reliable reader, that a writer is there.
  void meet(const Writer& writer) const;
  /// As topics::RawSubscriber has it.
  std::uint64_t lost() const { return lost_; }

 private:
  void take_some();
  bool is_wanted(dds_instance_handle_t writer);
  void count_lost(const TakenMessage& taken);

  Session::Impl& session_;
  const ddsi_sertype* type_;
  Writers writers_;
  std::function<void(std::span<const std::byte>)> take_;
  std::map<dds_instance_handle_t, bool> wanted_{};          ///< by writer
  std::map<dds_instance_handle_t, std::int64_t> newest_{};  ///< number of a message, by writer
  std::atomic<std::uint64_t> lost_{0};
  dds_entity_t reader_;
  dds_entity_t arrived_;  ///< a read condition
  Dispatcher::Ticket ticket_ = 0;
};

}  // namespace spikeloop::ros2
