// A reader of DDS, served by the session's thread.
#pragma once

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

 private:
  void take_some();
  bool is_wanted(dds_instance_handle_t writer);

  Session::Impl& session_;
  Writers writers_;
  std::function<void(std::span<const std::byte>)> take_;
  std::map<dds_instance_handle_t, bool> wanted_{};  ///< by writer
  dds_entity_t reader_;
  dds_entity_t arrived_;  ///< a read condition
  Dispatcher::Ticket ticket_ = 0;
};

}  // namespace spikeloop::ros2
