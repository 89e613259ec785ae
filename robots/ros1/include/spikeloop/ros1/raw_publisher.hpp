// A topic out, message by message as bytes: the only way in which this room sends.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "spikeloop/ros1/session.hpp"

namespace spikeloop::ros1 {

class RawPublisher {
 public:
  /// Sends with TCP_NODELAY. roscpp numbers the messages of a type that begins with a header.
  /// @param queue messages that may wait for roscpp's thread, commands and then a zero; of more,
  /// the oldest are lost; 0: any number
  /// @throws ConfigurationError for an unknown type or an impossible topic.
  RawPublisher(Session& session, const std::string& topic, const std::string& message_type,
               std::uint32_t queue = 10);
  ~RawPublisher();
  RawPublisher(const RawPublisher&) = delete;
  RawPublisher& operator=(const RawPublisher&) = delete;

  /// Copies one whole message. Does not wait: a thread of roscpp sends. Safe to call from any
  /// thread, one at a time.
  void publish(std::span<const std::byte> message);
  bool has_subscribers() const;
  /// Leaves that thread time to hand what was published to the system, which then delivers it even
  /// when this process dies.
  void drain() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace spikeloop::ros1
