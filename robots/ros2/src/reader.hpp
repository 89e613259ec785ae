// A reader of DDS, served by the session's thread.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>

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
  /// In the session's thread: from now on only these.
  void restrict_to(Writers writers) { writers_ = writers; }
  /// As topics::RawSubscriber has it.
  std::uint64_t lost();

 private:
  void take_some();
  bool is_wanted(dds_instance_handle_t writer);
  void count_lost(const TakenMessage& taken);
  std::uint64_t not_come();

  Session::Impl& session_;
  const ddsi_sertype* type_;
  std::atomic<Writers> writers_;
  std::function<void(std::span<const std::byte>)> take_;
  std::mutex mutex_{};
  std::map<dds_instance_handle_t, bool> wanted_{};          ///< by writer
  std::map<dds_instance_handle_t, std::int64_t> newest_{};  ///< number of a message, by writer
  std::uint64_t lost_ = 0;
  std::chrono::steady_clock::time_point come_at_ = std::chrono::steady_clock::now();
  dds_entity_t reader_;
  dds_entity_t arrived_;  ///< a read condition
  Dispatcher::Ticket ticket_ = 0;
};

}  // namespace spikeloop::ros2
