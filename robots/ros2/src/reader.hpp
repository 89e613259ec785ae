// A reader of DDS, served by the session's thread.
#pragma once

#include <functional>

#include "qos.hpp"
#include "session_impl.hpp"

namespace spikeloop::ros2 {

class Reader {
 public:
  using Take = std::function<void(const TakenMessage&)>;

  /// @param take called in the session's thread with each message
  /// @throws TransportError when Cyclone DDS refuses it.
  Reader(Session::Impl& session, const RawTopic& topic, const Qos& qos, Take take);
  ~Reader();
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  bool has_writers() const;
  /// In the session's thread: of a reliable reader, that a writer is there.
  void meet(const Writer& writer) const;

 private:
  void take_some();

  Session::Impl& session_;
  const ddsi_sertype* type_;
  Take take_;
  dds_entity_t reader_;
  dds_entity_t arrived_;  ///< a read condition
  Dispatcher::Ticket ticket_ = 0;
};

}  // namespace spikeloop::ros2
